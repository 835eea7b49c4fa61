// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/output_rules.h"

#include <algorithm>
#include <fstream>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/open/open_named_recording.h"

namespace e2lf::recordings {
namespace fs = std::filesystem;
namespace {

/// Returns another recording in the folder whose triggers are also in this file, or an empty path.
fs::path other_owner(const fs::path& triggers, const fs::path& recording) {
  std::error_code error;
  if (triggers.filename().string().find("_trigger") == std::string::npos) return {};
  for (fs::directory_iterator entry(recording.parent_path(), error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->path() == recording || !entry->is_regular_file(ignored)) continue;
    const auto codec = codec_to_write(entry->path(), "");
    if (codec && (*codec)->side_file != nullptr && (*codec)->side_file(entry->path()) == triggers) return entry->path();
  }
  return {};
}

bool is_our_trigger_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return false;
  const auto codec = codec_to_write(path, "");
  if (codec && (*codec)->is_side_file != nullptr) return (*codec)->is_side_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  return line == "p,id,t";
}

}  // namespace

OutputRules output_rules(const std::vector<fs::path>& inputs, bool overwrite) {
  OutputRules rules;
  rules.overwrite = overwrite;
  rules.is_live = !inputs.empty() && file_of_recording(inputs.front().string()).empty();
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const fs::path file = file_of_recording(input.string());
    rules.inputs.push_back(file.empty() ? input : file);
    std::error_code error;
    if (!fs::is_regular_file(file, error)) continue;
    rules.read_beside.push_back(record_path_beside(file));
    const auto codec = codec_to_write(file, "");
    if (codec && (*codec)->side_file != nullptr) rules.read_beside.push_back((*codec)->side_file(file));
  }
  return rules;
}

OutputRules recording_output_rules(const std::vector<fs::path>& inputs, bool overwrite, const Codec& codec) {
  OutputRules rules = output_rules(inputs, overwrite);
  rules.streams = codec.create != nullptr;
  rules.side = {codec.side_file, other_owner, is_our_trigger_file};
  return rules;
}

Recover recover_recording(const Codec& codec) {
  return [recover = codec.recover](const fs::path& partial, const fs::path& kept) -> std::string {
    std::error_code error;
    const auto bytes = fs::file_size(partial, error);
    if (error || bytes == 0) return {};
    if (recover != nullptr && !recover(partial)) {
      log_warning(cat(kept.string(), ": not kept, because what an interrupted run had written cannot be read; ",
                      "record to .raw, which can be read up to where it ends"));
      return {};
    }
    fs::rename(partial, kept, error);
    return error ? "" : cat(bytes, " bytes");
  };
}

}  // namespace e2lf::recordings
