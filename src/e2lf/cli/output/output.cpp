// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/output.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

using SideFile = fs::path (*)(const fs::path&);

constexpr char kLive[] = "e2lf.live";  ///< marks a workspace whose content cannot be created again

Error exists(const fs::path& path, const std::string& what) {
  return {ErrorCode::kExists, what, path.string()};
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool is_standard_output(const fs::path& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

/// Returns the name of a recording without the prefix that replays it at its own speed.
std::string without_replay(const fs::path& input) {
  constexpr std::string_view kReplay = "replay:";
  const std::string name = input.string();
  return name.starts_with(kReplay) ? name.substr(kReplay.size()) : name;
}

/// Returns the file or folder behind the name of an input, or an empty path if there is none (a socket, a camera).
fs::path file_of_input(const fs::path& named) {
  std::string name = without_replay(named);
  if (name == "-") name = "/proc/self/fd/0";
  std::error_code error;
  const fs::path path = fs::canonical(name, error);
  const bool is_file = !error && (fs::is_regular_file(path, error) || fs::is_directory(path, error));
  return is_file ? path : fs::path();
}

/// Returns whether `inner` is `outer` or lies in it, comparing files rather than the spelling of names.
bool is_within(fs::path inner, const fs::path& outer) {
  for (;;) {
    std::error_code error;
    if (inner == outer || fs::equivalent(inner, outer, error)) return true;
    const fs::path parent = inner.parent_path();
    if (parent == inner || parent.empty()) return false;
    inner = parent;
  }
}

/// Resolves the links in a name. A link to nothing is refused, because the output would not be written to its target.
Result<fs::path> resolve(const fs::path& named) {
  const fs::path path = named.has_filename() ? named : named.parent_path();
  std::error_code error;
  if (path.empty()) return Error{ErrorCode::kInvalidValue, "the output has no name; give one", "--output"};
  if (fs::is_symlink(fs::symlink_status(path, error)) && !fs::exists(path, error)) {
    return exists(path, "the output is a link whose target does not exist; remove it or choose another output");
  }
  fs::path resolved = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : resolved;
}

/// Returns another recording in the folder whose triggers are also in this file, or an empty path.
fs::path other_owner(const fs::path& triggers, const fs::path& target) {
  std::error_code error;
  for (fs::directory_iterator entry(target.parent_path(), error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->path() == target || !entry->is_regular_file(ignored)) continue;
    const auto codec = recordings::codec_to_write(entry->path(), "");
    if (codec && (*codec)->side_file != nullptr && (*codec)->side_file(entry->path()) == triggers) return entry->path();
  }
  return {};
}

/// Returns whether e2lf wrote a file of triggers, judging by its first bytes.
bool is_our_trigger_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return false;
  const auto codec = recordings::codec_to_write(path, "");
  if (codec && (*codec)->is_side_file != nullptr) return (*codec)->is_side_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  return line == "p,id,t";
}

/// Fails if a name is that of the record or the triggers of another existing file, as which the output would be read.
Result<void> check_not_a_side_file(const fs::path& path) {
  const std::string name = path.filename().string(), record_end = record_path_beside("").string();
  const auto belongs = [&path](const char* what, const fs::path& owner) {
    return exists(path, cat("this is the name of the ", what, " of ", owner.filename().string(),
                            ", and would be read as such; choose another output"));
  };
  std::error_code error;
  if (name.ends_with(record_end) && name.size() > record_end.size()) {
    const fs::path owner = path.parent_path() / name.substr(0, name.size() - record_end.size());
    if (fs::is_regular_file(owner, error)) return belongs("record", owner);
  }
  if (name == "run.json" && is_our_record(path)) return belongs("record", path.parent_path());
  if (name.find("_trigger") == std::string::npos) return {};
  const fs::path owner = other_owner(path, path);
  return owner.empty() ? Result<void>() : belongs("triggers", owner);
}

/// Appends the files that a verb reads beside an input: its record and its triggers.
void append_side_files(const fs::path& input, std::vector<fs::path>& files) {
  const std::string name = without_replay(input);
  std::error_code error;
  if (!fs::is_regular_file(name, error)) return;
  files.push_back(record_path_beside(name));
  const auto codec = recordings::codec_to_write(name, "");
  if (codec && (*codec)->side_file != nullptr) files.push_back((*codec)->side_file(name));
}

bool is_same_content(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::file_size(a, error) != fs::file_size(b, error) || error) return false;
  std::ifstream of_a(a, std::ios::binary), of_b(b, std::ios::binary);
  return std::equal(std::istreambuf_iterator<char>(of_a), {}, std::istreambuf_iterator<char>(of_b));
}

Error foreign_side(const fs::path& side, const fs::path& target, bool is_ours) {
  const std::string name = target.filename().string();
  return exists(side, !is_ours ? cat("this file would belong to ", name,
                                     ", but e2lf did not write it, so it is not replaced; move it away or choose "
                                     "another output")
                               : cat("this file would belong to ", name,
                                     "; move it away, give --overwrite or choose another output"));
}

Error shared_triggers(const fs::path& triggers, const fs::path& target, const fs::path& owner) {
  return exists(triggers,
                cat("these triggers belong to ", owner.filename().string(), ", and would be read as those of ",
                    target.filename().string(), " too; choose another output"));
}

/// Returns "events-interrupted-1.npz" or the next unused name, including that of the triggers.
fs::path free_name(const fs::path& target, SideFile side_file) {
  for (int number = 1;; ++number) {
    fs::path name = target;
    name.replace_filename(cat(target.stem().string(), "-interrupted-", number, target.extension().string()));
    if (!is_there(name) && (side_file == nullptr || !is_there(side_file(name)))) return name;
  }
}

/// Returns the unfinished file in a workspace that would have had this name, or an empty path.
fs::path part_of(const fs::path& workspace, const std::string& name) {
  std::error_code error;
  for (fs::directory_iterator entry(workspace, error), end; !error && entry != end; entry.increment(error)) {
    const std::string found = entry->path().filename().string();
    const bool is_record = found.starts_with(record_path_beside(name).string());
    if (found == name || (found.starts_with(name + ".") && !is_record)) return entry->path();
  }
  return {};
}

/// Returns a function that saves the finished part of a target and its triggers after a killed run, if it cannot be
/// created again.
Workspace::OnDead keeper(const fs::path& target, SideFile side_file, const Recover& recover) {
  if (!recover) return {};
  return [target, side_file, recover](const fs::path& workspace) {
    std::error_code error;
    const std::string name = target.filename().string();
    const fs::path partial = part_of(workspace, name);
    if (partial.empty() || !fs::exists(workspace / kLive, error)) return;
    const fs::path kept = free_name(target, side_file);
    const std::string what = recover(partial, kept);
    if (what.empty()) return;
    std::string names = kept.string();
    if (side_file != nullptr) {
      const fs::path triggers = part_of(workspace, side_file(target).filename().string());
      if (!triggers.empty()) fs::rename(triggers, side_file(kept), error);
      if (!triggers.empty() && !error) names += cat(" and ", side_file(kept).filename().string());
    }
    log_warning(cat("an interrupted run had written ", what, " of ", name, "; they are kept in ", names));
  };
}

Result<void> move_into_place(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return {};
  return Error{ErrorCode::kIo,
               cat("cannot move the file to its place (", std::strerror(errno), "); check the disk and the path"),
               to.string()};
}

/// Fails if a folder would be created under the name of a file, since the user expects this file.
Result<void> check_folder_name(const fs::path& path) {
  constexpr std::string_view kFiles[] = {".avi",  ".csv",  ".dat",  ".gif",  ".h5",  ".hdf5",        ".html",
                                         ".jpeg", ".jpg",  ".json", ".mat",  ".mp4", ".npy",         ".npz",
                                         ".onnx", ".pfm",  ".ply",  ".png",  ".raw", ".safetensors", ".svg",
                                         ".tif",  ".tiff", ".txt",  ".webm", ".zip"};
  const std::string extension = path.extension().string();
  if (is_there(path) || std::find(std::begin(kFiles), std::end(kFiles), extension) == std::end(kFiles)) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("the output is a folder, and a name that ends in ", extension, " is that of a file; give a folder"),
               path.string()};
}

Result<void> check_ending(const fs::path& path, const std::string& ending) {
  if (ending.empty() || path.extension() == ending) return {};
  return Error{ErrorCode::kInvalidValue, cat("this output is written as ", ending, "; give it such a name"),
               path.string()};
}

}  // namespace

Result<void> check_apart(const fs::path& output, const std::vector<fs::path>& inputs) {
  E2LF_ASSIGN_OR_RETURN(const fs::path resolved, resolve(output));
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const fs::path file = file_of_input(input);
    if (file.empty()) continue;
    const bool output_within = is_within(resolved, file), input_within = is_within(file, resolved);
    if (!output_within && !input_within) continue;
    if (output_within && !input_within) {
      return Error{
          ErrorCode::kInvalidValue,
          cat("the output lies in an input (", input.string(), "), which is read and never written to; put it ",
              "beside that, e.g. at ", (file.parent_path() / resolved.filename()).string()),
          output.string()};
    }
    return Error{ErrorCode::kInvalidValue,
                 cat("the output ", output_within ? "is" : "contains", " an input (", input.string(),
                     "), which would be lost; choose another output"),
                 output.string()};
  }
  return {};
}

namespace {

/// Resolves the name of a folder of results, which may not be, contain or lie in an input.
Result<fs::path> resolve_folder(const fs::path& named, const std::vector<fs::path>& inputs) {
  if (is_standard_output(named)) {
    return Error{ErrorCode::kUnsupported, "the output is a folder, not a pipe; give a folder", named.string()};
  }
  E2LF_RETURN_IF_ERROR(check_apart(named, inputs));
  return resolve(named);
}

}  // namespace

std::string recover_cycles(const fs::path& partial, const fs::path& kept) {
  const auto cycles = capture::recover_event_images(partial, kept);
  if (!cycles || *cycles == 0) return {};
  return cat(*cycles, *cycles == 1 ? " cycle" : " cycles");
}

Recover recover_recording(const recordings::Codec& codec) {
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

Result<OutputFile> OutputFile::create(const fs::path& named, const OutputRules& rules) {
  OutputFile output;
  const bool is_stdout = is_standard_output(named);
  if (is_stdout || e2lf::is_stream(named)) {
    if (!rules.streams) {
      return Error{ErrorCode::kUnsupported, "this output is written as a file, not to a pipe or a device; give a file",
                   named.string()};
    }
    // A pipe that the same program reads and writes never ends.
    std::error_code error;
    const bool is_read =
        fs::is_fifo(named, error) && std::any_of(rules.inputs.begin(), rules.inputs.end(), [&](const fs::path& input) {
          return fs::weakly_canonical(named, error) == fs::weakly_canonical(input, error);
        });
    if (is_read) {
      return Error{ErrorCode::kInvalidValue, "the output is the pipe that is read; choose another", named.string()};
    }
    output.place_ = is_stdout ? fs::path("-") : named;
    return output;
  }
  E2LF_RETURN_IF_ERROR(check_apart(named, rules.inputs));
  E2LF_RETURN_IF_ERROR(check_ending(named, rules.ending));
  E2LF_ASSIGN_OR_RETURN(output.target_, resolve(named));
  std::error_code error;
  E2LF_RETURN_IF_ERROR(check_not_a_side_file(fs::absolute(named, error)));
  E2LF_RETURN_IF_ERROR(check_not_a_side_file(output.target_));
  std::vector<fs::path> beside_inputs;
  for (const fs::path& input : rules.inputs) append_side_files(input, beside_inputs);
  E2LF_RETURN_IF_ERROR(check_apart(named, beside_inputs));
  E2LF_RETURN_IF_ERROR(check_output(output.target_, rules.overwrite));
  if (rules.side_file != nullptr) output.triggers_ = rules.side_file(output.target_);
  E2LF_RETURN_IF_ERROR(check_apart(record_path_beside(output.target_), rules.inputs));
  if (!output.triggers_.empty()) E2LF_RETURN_IF_ERROR(check_apart(output.triggers_, rules.inputs));
  output.overwrite_ = rules.overwrite;
  output.is_live_ = std::none_of(rules.inputs.begin(), rules.inputs.end(),
                                 [](const fs::path& input) { return !file_of_input(input).empty(); });
  E2LF_RETURN_IF_ERROR(output.check_place());
  E2LF_ASSIGN_OR_RETURN(Workspace workspace,
                        Workspace::create(output.target_, keeper(output.target_, rules.side_file, rules.recover)));
  output.place_ = workspace.path() / output.target_.filename();
  if (output.is_live_) E2LF_RETURN_IF_ERROR(write_file(workspace.path() / kLive, std::string("live\n")));
  output.workspace_.emplace(std::move(workspace));
  return output;
}

Result<OutputFile> OutputFile::create(const fs::path& named, const Verb& verb, std::vector<fs::path> inputs,
                                      std::string ending) {
  return create(named,
                {.inputs = std::move(inputs), .overwrite = verb.common().overwrite, .ending = std::move(ending)});
}

fs::path OutputFile::record_path() const {
  return record_path_beside(place_);
}

Result<void> OutputFile::check_place() const {
  E2LF_RETURN_IF_ERROR(check_output(target_, overwrite_));
  const fs::path record = record_path_beside(target_);
  // The record of a result that no longer exists is useless.
  if (is_there(record) && !(is_our_record(record) && (overwrite_ || !is_there(target_)))) {
    return foreign_side(record, target_, is_our_record(record));
  }
  if (triggers_.empty() || !is_there(triggers_)) return {};
  if (const fs::path owner = other_owner(triggers_, target_); !owner.empty()) {
    // The existing triggers are the same; but this risk is not taken for a recording that cannot be repeated.
    return is_live_ ? shared_triggers(triggers_, target_, owner) : Result<void>();
  }
  const bool is_ours = is_our_trigger_file(triggers_);
  return overwrite_ && is_ours ? Result<void>() : foreign_side(triggers_, target_, is_ours);
}

Result<void> OutputFile::commit() {
  if (!workspace_) return {};
  // The files may have changed since create().
  E2LF_RETURN_IF_ERROR(check_place());
  bool keeps_triggers = triggers_.empty();
  const fs::path new_triggers = workspace_->path() / triggers_.filename();
  if (!triggers_.empty() && is_there(triggers_)) {
    const fs::path owner = other_owner(triggers_, target_);
    keeps_triggers = is_there(new_triggers) && is_same_content(new_triggers, triggers_);
    if (!owner.empty() && !keeps_triggers) return shared_triggers(triggers_, target_, owner);
  }
  // Old side files are removed first: a result without its triggers is incomplete, but one with those of another is
  // wrong.
  std::error_code error;
  fs::remove(record_path_beside(target_), error);
  if (!keeps_triggers) fs::remove(triggers_, error);
  E2LF_RETURN_IF_ERROR(move_into_place(place_, target_));
  if (!keeps_triggers && is_there(new_triggers)) E2LF_RETURN_IF_ERROR(move_into_place(new_triggers, triggers_));
  if (is_there(record_path())) return move_into_place(record_path(), record_path_beside(target_));
  return {};
}

Result<void> GrowingFolder::open(const fs::path& named, const OutputRules& rules, Json record) {
  E2LF_ASSIGN_OR_RETURN(path_, resolve_folder(named, rules.inputs));
  std::error_code error;
  if (is_there(path_) && !fs::is_directory(path_, error)) {
    return exists(path_, "the output is a folder, but a file with this name exists; choose another output");
  }
  E2LF_RETURN_IF_ERROR(check_folder_name(path_));
  is_new_ = !is_there(path_);
  std::vector<std::string> listed;
  if (is_there(path_) && !fs::is_empty(path_, error)) {
    const auto earlier = is_our_record(path_ / "run.json") ? read_json(path_ / "run.json") : Json::object();
    if (!earlier || earlier->value("verb", "") != verb_) {
      return exists(path_, cat("this folder was not written by e2lf ", verb_,
                               " (it contains no run.json of e2lf); choose another"));
    }
    if (earlier->contains("files")) listed = earlier->value("files", std::vector<std::string>());
  }
  for (const std::string& file : files_) {
    const bool is_ours = std::find(listed.begin(), listed.end(), file) != listed.end();
    if (is_there(path_ / file) && !is_ours) {
      return exists(path_ / file, "e2lf did not write this file, so it is not replaced; move it away");
    }
  }
  remove_dead_parts(path_);
  remove_dead_parts(path_ / "results");
  return write_record(std::move(record));
}

Result<void> GrowingFolder::write_record(Json record) const {
  record["written_by"] = "e2lf";
  record["files"] = files_;
  return write_file(path_ / "run.json", json_text(record));
}

void GrowingFolder::withdraw() const {
  std::error_code error;
  if (!is_new_ || std::distance(fs::directory_iterator(path_, error), {}) > 1) return;
  fs::remove(path_ / "run.json", error);
  fs::remove(path_, error);
}

Result<ResultFolder> open_output_folder(const fs::path& named, const Verb& verb, const std::vector<fs::path>& inputs) {
  E2LF_ASSIGN_OR_RETURN(const fs::path target, resolve_folder(named, inputs));
  E2LF_RETURN_IF_ERROR(check_folder_name(target));
  return ResultFolder::create(target, verb.common().overwrite);
}

Result<void> commit(OutputFile& output, const RunRecord& record, const Verb& verb) {
  if (!output.is_stream()) E2LF_RETURN_IF_ERROR(record.write(output.record_path(), verb));
  return output.commit();
}

Result<void> commit(ResultFolder& folder, const RunRecord& record, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  return folder.commit(std::move(about));
}

Result<std::optional<OutputFile>> open_optional(const fs::path& named, const OutputRules& rules) {
  std::optional<OutputFile> output;
  if (!named.empty()) {
    E2LF_ASSIGN_OR_RETURN(output, OutputFile::create(named, rules));
  }
  return output;
}

}  // namespace e2lf::cli
