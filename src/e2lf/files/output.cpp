// SPDX-License-Identifier: MIT
#include "e2lf/files/output.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

bool is_standard_output(const fs::path& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
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
  if (path.empty()) return fail(ErrorCode::kInvalidValue, "output", "the output has no name; give one");
  if (fs::is_symlink(fs::symlink_status(path, error)) && !fs::exists(path, error)) {
    return fail(ErrorCode::kExists, path,
                "the output is a link whose target does not exist; remove it or choose another output");
  }
  fs::path resolved = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : resolved;
}

/// Fails if a name is that of the record of another existing file or folder, as which the output would be read.
Result<void> check_not_a_record(const fs::path& path) {
  const std::string name = path.filename().string(), record_end = record_path_beside("").string();
  fs::path owner;
  if (name.ends_with(record_end) && name.size() > record_end.size()) {
    owner = path.parent_path() / name.substr(0, name.size() - record_end.size());
    if (!is_file(owner)) owner.clear();
  }
  if (name == "run.json" && is_our_record(path)) owner = path.parent_path();
  if (owner.empty()) return {};
  return fail(ErrorCode::kExists, path,
              cat("this is the name of the record of ", owner.filename().string(),
                  ", and would be read as such; choose another output"));
}

Error foreign_side(const fs::path& side, const fs::path& target, bool is_ours) {
  const char* const remedy = is_ours ? "; move it away, replace it or choose another output"
                                     : ", but e2lf did not write it, so it is not replaced; move it away or choose "
                                       "another output";
  return {ErrorCode::kExists, cat("this file would belong to ", target.filename().string(), remedy), side.string(),
          is_ours ? "overwrite" : ""};
}

Result<void> move_into_place(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return {};
  return fail_to("move the file to its place", to, errno);
}

/// Fails if a folder would be created under the name of a file, since the user expects this file.
Result<void> check_folder_name(const fs::path& path) {
  constexpr std::string_view kFiles[] = {".avi",  ".csv",  ".dat",  ".gif",  ".h5",  ".hdf5",        ".html",
                                         ".jpeg", ".jpg",  ".json", ".mat",  ".mp4", ".npy",         ".npz",
                                         ".onnx", ".pfm",  ".ply",  ".png",  ".raw", ".safetensors", ".svg",
                                         ".tif",  ".tiff", ".txt",  ".webm", ".zip"};
  const std::string extension = path.extension().string();
  if (is_there(path) || std::ranges::find(kFiles, extension) == std::end(kFiles)) return {};
  return fail(ErrorCode::kInvalidValue, path, "the output is a folder, and a name that ends in ", extension,
              " is that of a file; give a folder");
}

}  // namespace

Result<void> check_apart(const fs::path& output, const std::vector<fs::path>& inputs) {
  E2LF_ASSIGN_OR_RETURN(const fs::path resolved, resolve(output));
  for (const fs::path& input : inputs) {
    std::error_code error;
    const fs::path file = fs::canonical(input, error);
    if (input.empty() || error) continue;
    const bool output_within = is_within(resolved, file), input_within = is_within(file, resolved);
    if (!output_within && !input_within) continue;
    if (output_within && !input_within) {
      return fail(ErrorCode::kInvalidValue, output, "the output lies in an input (", input.string(),
                  "), which is read and never written to; put it ", "beside that, e.g. at ",
                  (file.parent_path() / resolved.filename()).string());
    }
    return fail(ErrorCode::kInvalidValue, output, "the output ", output_within ? "is" : "contains", " an input (",
                input.string(), "), which would be lost; choose another output");
  }
  return {};
}

namespace {

/// Resolves the name of a folder of results, which may not be, contain or lie in an input.
Result<fs::path> resolve_folder(const fs::path& named, const std::vector<fs::path>& inputs) {
  if (is_standard_output(named)) {
    return fail(ErrorCode::kUnsupported, named, "the output is a folder, not a pipe; give a folder");
  }
  E2LF_RETURN_IF_ERROR(check_apart(named, inputs));
  return resolve(named);
}

}  // namespace

Result<OutputFile> OutputFile::create(const fs::path& named, const OutputRules& rules) {
  OutputFile output;
  const bool is_stdout = is_standard_output(named);
  if (is_stdout || e2lf::is_stream(named)) {
    if (!rules.streams) {
      return fail(ErrorCode::kUnsupported, named,
                  "this output is written as a file, not to a pipe or a device; give a file",
                  rules.ending.empty() ? "" : cat(" whose name ends in ", rules.ending));
    }
    // A pipe that the same program reads and writes never ends.
    std::error_code error;
    const bool is_read = fs::is_fifo(named, error) && std::ranges::any_of(rules.inputs, [&](const fs::path& input) {
                           return fs::weakly_canonical(named, error) == fs::weakly_canonical(input, error);
                         });
    if (is_read) {
      return fail(ErrorCode::kInvalidValue, named, "the output is the pipe that is read; choose another");
    }
    output.place_ = is_stdout ? fs::path("-") : named;
    return output;
  }
  E2LF_RETURN_IF_ERROR(check_apart(named, rules.inputs));
  if (!rules.ending.empty() && named.extension() != rules.ending) {
    return fail(ErrorCode::kInvalidValue, named, "this output is written as ", rules.ending, "; give it such a name");
  }
  E2LF_ASSIGN_OR_RETURN(output.target_, resolve(named));
  std::error_code error;
  E2LF_RETURN_IF_ERROR(check_not_a_record(fs::absolute(named, error)));
  E2LF_RETURN_IF_ERROR(check_not_a_record(output.target_));
  E2LF_RETURN_IF_ERROR(check_apart(named, rules.read_beside));
  E2LF_RETURN_IF_ERROR(check_apart(record_path_beside(output.target_), rules.inputs));
  output.side_ = rules.side;
  if (rules.side.path_of != nullptr) {
    output.side_path_ = rules.side.path_of(output.target_);
    E2LF_RETURN_IF_ERROR(check_apart(output.side_path_, rules.inputs));
    E2LF_RETURN_IF_ERROR(check_apart(output.side_path_, rules.read_beside));
  }
  output.overwrite_ = rules.overwrite;
  E2LF_RETURN_IF_ERROR(output.check_place());
  E2LF_ASSIGN_OR_RETURN(Workspace workspace, Workspace::create(output.target_, rules.is_live));
  output.place_ = workspace.path() / output.target_.filename();
  output.workspace_.emplace(std::move(workspace));
  return output;
}

Result<void> OutputFile::check_place() const {
  E2LF_RETURN_IF_ERROR(check_output(target_, overwrite_));
  const fs::path record = record_path_beside(target_);
  // The record of a result that no longer exists is useless.
  if (is_there(record) && !(is_our_record(record) && (overwrite_ || !is_there(target_)))) {
    return foreign_side(record, target_, is_our_record(record));
  }
  if (side_path_.empty() || !is_there(side_path_)) return {};
  const bool is_ours = side_.is_ours(side_path_);
  return overwrite_ && is_ours ? Result<void>() : foreign_side(side_path_, target_, is_ours);
}

Result<void> OutputFile::commit() {
  if (!workspace_) return {};
  // The files may have changed since create().
  E2LF_RETURN_IF_ERROR(check_place());
  const fs::path record = record_path_beside(target_), new_side = workspace_->path() / side_path_.filename();
  const bool has_side = !side_path_.empty();
  // Old side files are set aside first: a result without its triggers is incomplete, but one with those of another is
  // wrong. They return if the result cannot be moved.
  const fs::path old_record = workspace_->path() / "replaced_record", old_side = workspace_->path() / "replaced_side";
  std::error_code error;
  fs::rename(record, old_record, error);
  if (has_side) fs::rename(side_path_, old_side, error);
  if (const Result<void> moved = move_into_place(place_, target_); !moved) {
    fs::rename(old_record, record, error);
    if (has_side) fs::rename(old_side, side_path_, error);
    return moved;
  }
  if (has_side && is_there(new_side)) E2LF_RETURN_IF_ERROR(move_into_place(new_side, side_path_));
  return is_there(record_path()) ? move_into_place(record_path(), record) : Result<void>();
}

Result<void> GrowingFolder::open(const fs::path& named, const OutputRules& rules, Json record) {
  E2LF_ASSIGN_OR_RETURN(path_, resolve_folder(named, rules.inputs));
  std::error_code error;
  if (is_there(path_) && !is_folder(path_)) {
    return fail(ErrorCode::kExists, path_,
                "the output is a folder, but a file with this name exists; choose another output");
  }
  E2LF_RETURN_IF_ERROR(check_folder_name(path_));
  is_new_ = !is_there(path_);
  std::vector<std::string> listed;
  if (is_there(path_) && !fs::is_empty(path_, error)) {
    const auto earlier = is_our_record(path_ / "run.json") ? read_json(path_ / "run.json") : Json::object();
    if (!earlier || earlier->value("verb", "") != verb_) {
      return fail(
          ErrorCode::kExists, path_,
          cat("this folder was not written by e2lf ", verb_, " (it contains no run.json of e2lf); choose another"));
    }
    if (earlier->contains("files")) listed = earlier->value("files", std::vector<std::string>());
  }
  for (const std::string& file : files_) {
    const bool is_ours = std::ranges::find(listed, file) != listed.end();
    if (is_there(path_ / file) && !is_ours) {
      return fail(ErrorCode::kExists, path_ / file,
                  "e2lf did not write this file, so it is not replaced; move it away");
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

Result<ResultFolder> open_result_folder(const fs::path& named, const OutputRules& rules) {
  E2LF_ASSIGN_OR_RETURN(const fs::path target, resolve_folder(named, rules.inputs));
  E2LF_RETURN_IF_ERROR(check_folder_name(target));
  return ResultFolder::create(target, rules.overwrite);
}

}  // namespace e2lf
