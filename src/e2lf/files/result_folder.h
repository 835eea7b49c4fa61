// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"

namespace e2lf {

/// A folder of results that appears either whole or not at all. It is made in a workspace beside its final place.
/// commit() writes its run.json, which lists the files, and moves it there. Without commit(), nothing appears.
///
/// An existing folder is replaced only if it is empty, or if it holds a run.json written by e2lf and nothing that this
/// does not list. Links in it are never followed.
///
/// A long result is made in parts, which are subfolders. Each of them appears whole as soon as it is done.
class ResultFolder {
 public:
  /// Fails with kExists if a folder exists and may not be replaced, and with kIo.
  [[nodiscard]] static Result<ResultFolder> create(const std::filesystem::path& target, bool overwrite);

  /// Returns the folder to write to until commit().
  [[nodiscard]] const std::filesystem::path& path() const { return place_; }

  /// Writes `record` with the list of files as run.json and moves the folder to its place. Fails with kIo, and with
  /// kExists if a folder that may not be replaced was created meanwhile; nothing is replaced in these cases.
  [[nodiscard]] Result<void> commit(Json record = Json::object());

  /// Creates the folder of a part and returns its path.
  [[nodiscard]] Result<std::filesystem::path> begin_part(const std::string& name);

  /// Finishes a part: writes its run.json and, if the whole folder is already in place, moves the part there.
  [[nodiscard]] Result<void> commit_part(const std::string& name, Json record);

  /// Writes run.json again after commit(), when the last part is done.
  [[nodiscard]] Result<void> update_record(Json record) const;

 private:
  ResultFolder(std::filesystem::path target, bool overwrite, Workspace workspace);
  std::filesystem::path target_, place_;
  bool overwrite_, is_committed_ = false;
  std::string run_;  ///< distinguishes the parts of this result from other results in its folder
  Workspace workspace_;
};

/// Returns true if a run.json, or the "<file>.run.json" beside a file, was written by e2lf.
[[nodiscard]] bool is_our_record(const std::filesystem::path& path);

/// Returns "<file>.run.json", where a verb that writes a single file keeps its record.
[[nodiscard]] std::filesystem::path record_path_beside(const std::filesystem::path& file);

/// Returns the path that `name_beside` derives from `file`. If nothing is there and `file` is a link, it is derived
/// from what the link leads to, because outputs through a link are written there.
[[nodiscard]] std::filesystem::path path_beside(const std::filesystem::path& file,
                                                std::filesystem::path (*name_beside)(const std::filesystem::path&));

}  // namespace e2lf
