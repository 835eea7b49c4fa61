// SPDX-License-Identifier: MIT
#include "e2lf/files/result_folder.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <random>
#include <set>
#include <sys/stat.h>

#include "e2lf/base/text.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

constexpr char kRecord[] = "run.json";

/// Returns the record of a folder, or null if it has none written by e2lf. A link does not count as a record.
Json record_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return nullptr;
  const auto json = read_json(path);
  if (!json || !json->is_object()) return nullptr;
  const bool is_marked = json->value("written_by", Json()) == "e2lf";
  const bool is_older = json->contains("verb") && json->contains("version") && json->contains("options");
  return is_marked || is_older ? *json : Json(nullptr);
}

/// Returns true if a path stays below its folder, as the paths listed in a record do.
bool is_inner(const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const fs::path& step : path) {
    if (step == ".." || step == ".") return false;
  }
  return true;
}

void add_listed(const Json& record, const fs::path& below, std::set<fs::path>& listed) {
  listed.insert(below / kRecord);
  const Json files = record.value("files", Json::array());
  if (!files.is_array()) return;
  for (const Json& file : files) {
    if (file.is_string() && is_inner(file.get<std::string>())) listed.insert(below / file.get<std::string>());
  }
}

/// Returns the files of a folder that are listed by its record and by the records of its parts, relative to the folder.
std::set<fs::path> listed_files(const fs::path& folder) {
  std::set<fs::path> listed;
  const Json record = record_of(folder / kRecord);
  if (record.is_null()) return listed;
  add_listed(record, {}, listed);
  const Json run = record.value("run", Json());
  std::error_code error;
  for (const fs::path& path : paths_in(folder)) {
    if (run.is_null() || !fs::is_directory(fs::symlink_status(path, error))) continue;
    const Json part = record_of(path / kRecord);
    if (!part.is_null() && part.value("run", Json()) == run) add_listed(part, path.filename(), listed);
  }
  return listed;
}

/// Fails if a folder contains a file or link that its record does not list. Empty folders do not matter.
Result<void> check_content(const fs::path& folder, const fs::path& target) {
  const std::set<fs::path> listed = listed_files(folder);
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    const fs::path inner = entry->path().lexically_relative(folder);
    const fs::file_status status = entry->symlink_status(ignored);
    if (fs::is_directory(status) || (fs::is_regular_file(status) && listed.contains(inner))) continue;
    return fail(ErrorCode::kExists, target, "the folder holds ", inner.string(),
                ", which e2lf did not write and does not replace; move it away or choose another folder");
  }
  return error ? Result<void>(fail_to("look through the folder", folder, error.value())) : Result<void>();
}

Result<void> check_replaceable(const fs::path& target, bool overwrite) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(target, error);
  if (!fs::exists(status)) return {};
  if (!fs::is_directory(status)) {
    return fail(ErrorCode::kExists, target, "the output is a folder, and a file or link has this name; choose another");
  }
  if (!overwrite) {
    return Error{ErrorCode::kExists, "the output exists already; replace it or choose another", target.string(),
                 "overwrite"};
  }
  if (fs::is_empty(target, error)) return {};
  if (error) return fail_to("look into the folder", target, error.value());
  if (record_of(target / kRecord).is_null()) {
    return fail(ErrorCode::kExists, target,
                "e2lf did not write this folder (it contains no run.json of e2lf), so it is never replaced; choose "
                "another folder");
  }
  return check_content(target, target);
}

int rename_with(const fs::path& from, const fs::path& to, unsigned int how) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), how);
}

/// Renames to a name that must be free, also on file systems that cannot guarantee this.
Result<void> rename_to_free(const fs::path& from, const fs::path& to) {
  if (rename_with(from, to, RENAME_NOREPLACE) == 0) return {};
  int error_number = errno;
  if ((error_number == EINVAL || error_number == ENOSYS) && !is_there(to)) {
    if (::rename(from.c_str(), to.c_str()) == 0) return {};
    error_number = errno;
  }
  if (error_number == EEXIST || error_number == EINVAL) {
    return fail(ErrorCode::kExists, to, "the output was created by another program in the meantime; choose another");
  }
  return fail_to("put the folder in place", to, error_number);
}

/// Swaps `place` and `target`, atomically if the file system supports it.
Result<void> exchange(const fs::path& place, const fs::path& target) {
  if (rename_with(place, target, RENAME_EXCHANGE) == 0) return {};
  if (errno != EINVAL && errno != ENOSYS) return fail_to("replace the folder", target, errno);
  const fs::path aside = place.parent_path() / "replaced";
  if (::rename(target.c_str(), aside.c_str()) != 0) return fail_to("replace the folder", target, errno);
  if (::rename(place.c_str(), target.c_str()) != 0) {
    const int error_number = errno;
    static_cast<void>(::rename(aside.c_str(), target.c_str()));
    return fail_to("replace the folder", target, error_number);
  }
  static_cast<void>(::rename(aside.c_str(), place.c_str()));
  return {};
}

/// Completes the record with the marks of a folder of ours and the list of its files, except those of its parts.
Json complete_record(Json record, const fs::path& folder, const std::string& run) {
  std::set<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (fs::is_directory(entry->symlink_status(ignored))) {
      if (fs::exists(entry->path() / kRecord, ignored)) entry.disable_recursion_pending();
    } else if (const fs::path inner = entry->path().lexically_relative(folder); inner != kRecord) {
      files.insert(inner.string());
    }
  }
  record["written_by"] = "e2lf";
  record["run"] = run;
  record["files"] = files;
  return record;
}

Result<void> write_record(const fs::path& folder, const Json& record) {
  return write_file(folder / kRecord, json_text(record));
}

}  // namespace

bool is_our_record(const fs::path& path) {
  return !record_of(path).is_null();
}

ResultFolder::ResultFolder(fs::path target, bool overwrite, Workspace workspace)
    : target_(std::move(target)),
      place_(workspace.path() / target_.filename()),
      overwrite_(overwrite),
      run_(formatted("%08x%08x", std::random_device()(), std::random_device()())),
      workspace_(std::move(workspace)) {}

Result<ResultFolder> ResultFolder::create(const fs::path& named, bool overwrite) {
  std::error_code unknown;
  fs::path target =
      fs::weakly_canonical(fs::absolute(named.has_filename() ? named : named.parent_path(), unknown), unknown);
  if (unknown) target = named;
  E2LF_RETURN_IF_ERROR(check_replaceable(target, overwrite));
  E2LF_ASSIGN_OR_RETURN(Workspace workspace, Workspace::create(target));
  ResultFolder folder(target, overwrite, std::move(workspace));
  std::error_code error;
  fs::create_directory(folder.place_, error);
  if (error) return fail_to("make the folder", target, error.value());
  return folder;
}

Result<void> ResultFolder::commit(Json record) {
  E2LF_RETURN_IF_ERROR(write_record(place_, complete_record(std::move(record), place_, run_)));
  if (!is_there(target_)) {
    E2LF_RETURN_IF_ERROR(rename_to_free(place_, target_));
  } else {
    // The existing folder may have changed since create().
    E2LF_RETURN_IF_ERROR(check_replaceable(target_, overwrite_));
    E2LF_RETURN_IF_ERROR(exchange(place_, target_));
    // Files may have been added to the old folder in between.
    if (const Result<void> unchanged = check_content(place_, target_); !unchanged) {
      E2LF_RETURN_IF_ERROR(exchange(place_, target_));
      return unchanged;
    }
  }
  is_committed_ = true;
  return {};
}

Result<fs::path> ResultFolder::begin_part(const std::string& name) {
  const fs::path folder = (is_committed_ ? workspace_.path() / "parts" : place_) / name;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail_to("make the folder", target_ / name, error.value());
  return folder;
}

Result<void> ResultFolder::commit_part(const std::string& name, Json record) {
  const fs::path folder = (is_committed_ ? workspace_.path() / "parts" : place_) / name;
  E2LF_RETURN_IF_ERROR(write_record(folder, complete_record(std::move(record), folder, run_)));
  return is_committed_ ? rename_to_free(folder, target_ / name) : Result<void>();
}

Result<void> ResultFolder::update_record(Json record) const {
  E2LF_REQUIRE(is_committed_, "a record is written again after commit()");
  const Json before = record_of(target_ / kRecord);
  record["written_by"] = "e2lf";
  record["run"] = run_;
  record["files"] = before.is_null() ? Json::array() : before.value("files", Json::array());
  return write_record(target_, record);
}

fs::path record_path_beside(const fs::path& file) {
  fs::path path = file;
  path += ".run.json";
  return path;
}

fs::path path_beside(const fs::path& file, fs::path (*name_beside)(const fs::path&)) {
  fs::path beside = name_beside(file);
  if (is_there(beside)) return beside;
  std::error_code error;
  const fs::path target = fs::canonical(file, error);
  return error ? beside : name_beside(target);
}

}  // namespace e2lf
