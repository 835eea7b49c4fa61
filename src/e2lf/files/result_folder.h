// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/files/workspace.h"

namespace e2lf {

/// A folder of results that appears whole or not at all. It is made in a workspace beside its place; commit() writes
/// its run.json, which lists the files, and puts it in place. Without commit() nothing appears.
///
/// A folder that is there is replaced only when it is empty or holds a run.json of ours, and of it only the files that
/// run.json lists: all others are in the new folder too. Links in it are never followed.
///
/// A long result comes in parts, folders of their own in the folder of all: each appears whole when it is done.
class ResultFolder {
 public:
  /// Fails with kExists (a folder that is there and may not be replaced) and kIo.
  [[nodiscard]] static Result<ResultFolder> create(const std::filesystem::path& target, bool overwrite);

  /// Where to write until commit().
  [[nodiscard]] const std::filesystem::path& path() const { return place_; }

  /// Writes `record` with the list of files as run.json and puts the folder in place. Fails with kExists (a file of
  /// someone else has the name of one of ours, or the folder came to be meanwhile) and kIo; nothing is replaced then.
  [[nodiscard]] Result<void> commit(Json record = Json::object());

  /// Makes the folder in which to write a part.
  [[nodiscard]] Result<std::filesystem::path> begin_part(const std::string& name);

  /// Ends a part: writes its run.json, and puts it in place when the folder of all is there already.
  [[nodiscard]] Result<void> commit_part(const std::string& name, Json record);

  /// Writes run.json again after commit(), when the last part is done.
  [[nodiscard]] Result<void> update_record(Json record) const;

 private:
  ResultFolder(std::filesystem::path target, bool overwrite, Workspace workspace);
  std::filesystem::path target_, place_;
  bool overwrite_, is_committed_ = false;
  std::string run_;  ///< tells the parts of this result from other results that lie in its folder
  Workspace workspace_;
};

/// Whether a run.json, or the "<file>.run.json" of a file, is of our writing.
[[nodiscard]] bool is_our_record(const std::filesystem::path& path);

}  // namespace e2lf
