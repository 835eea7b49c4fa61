// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/open_named_recording.h"

#include <algorithm>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

bool is_live_recording(const std::string& name) {
  return name == "-" || is_camera_name(name) || is_stream(name);
}

std::filesystem::path file_of_recording(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path = name == "-"            ? fs::canonical("/proc/self/fd/0", error)
                        : is_camera_name(name) ? path_of_camera(name)
                                               : fs::path(name);
  return fs::is_regular_file(path, error) || fs::is_directory(path, error) ? path : fs::path();
}

Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name, const CameraSetup& setup) {
  if (is_camera_name(name)) return open_camera_bytes(name, setup);
  if (name == "-") return open_camera_bytes("camera://pipe", setup);
  if (!is_stream(name)) {
    return Error{
        ErrorCode::kInvalidValue,
        "this is not a live input; give a camera (camera://NAME), tcp://ADDRESS:PORT, replay:FILE, a named pipe "
        "or -",
        name};
  }
  E2LF_ASSIGN_OR_RETURN(const CameraPlugin pipes, find_camera_plugin("pipe", name));
  E2LF_ASSIGN_OR_RETURN(CameraPtr camera, pipes.open(name));
  return start_camera_source(std::move(camera), name, setup);
}

Result<ReaderPtr> open_named_recording(const std::string& name, const OpenOptions& options) {
  struct stat input {};
  const bool is_pipe =
      name == "-" && ::fstat(STDIN_FILENO, &input) == 0 && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode));
  if (is_pipe || (name != "-" && is_live_recording(name))) {
    E2LF_ASSIGN_OR_RETURN(SourcePtr source, open_live_bytes(name, options.camera));
    return open_recording(std::move(source), options);
  }
  if (has_settings(options.camera)) {
    return Error{ErrorCode::kInvalidValue, "camera settings do not apply to a file; leave them out", name};
  }
  return open_recording(std::filesystem::path(name), options);
}

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
