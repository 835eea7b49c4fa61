// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"

/// What a program may write, and what it may replace. Every output goes through OutputFile, open_result_folder() or
/// GrowingFolder.
namespace e2lf {

/// The second file of a format that stores a part of its content beside the first, such as triggers beside events.
struct SideFile {
  std::filesystem::path (*path_of)(const std::filesystem::path& result) = nullptr;  ///< null = there is none
  /// Returns whether e2lf wrote a file with the name of a side file, judging by its first bytes.
  bool (*is_ours)(const std::filesystem::path& side) = nullptr;
};

struct OutputRules {
  std::vector<std::filesystem::path> inputs = {};  ///< files, folders and pipes that are read; empty ones are ignored
  std::vector<std::filesystem::path> read_beside = {};  ///< files that are read beside the inputs
  bool overwrite = false;
  std::string ending = {};  ///< the required extension of the file if there is one format: ".png"
  bool streams = false;  ///< whether the format is written front to back, so that "-", devices and pipes are possible
  bool is_live = false;  ///< whether the result cannot be created again
  SideFile side = {};
};

/// A result file with the files that belong to it: its record (<file>.run.json) and its side file. They are checked
/// together, appear together and are replaced together.
class OutputFile {
 public:
  /// Resolves links in `named`, and checks it and its side files. Fails with kExists (a file exists that may not be
  /// replaced), kInvalidValue (the output is, contains or lies in an input, or its extension is that of another
  /// format), kUnsupported (a stream, but the format requires a file) and kIo.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& named, const OutputRules& rules);

  /// Returns where to write: a name in a workspace, or the stream itself ("-" for standard output).
  [[nodiscard]] const std::filesystem::path& path() const { return place_; }
  /// Returns where to write the record.
  [[nodiscard]] std::filesystem::path record_path() const { return record_path_beside(place_); }
  [[nodiscard]] bool is_stream() const { return !workspace_.has_value(); }

  /// Returns the stream for text to the user: standard error if standard output receives the data.
  [[nodiscard]] std::FILE* text() const { return place_ == "-" ? stderr : stdout; }

  /// Moves everything that was written to path() and beside it to its place, and removes side files of the result that
  /// it replaces. Does nothing for a stream. Fails with kExists and kIo.
  [[nodiscard]] Result<void> commit();

 private:
  OutputFile() = default;
  [[nodiscard]] Result<void> check_place() const;
  std::filesystem::path target_, place_;
  std::filesystem::path side_path_;  ///< empty = none
  SideFile side_;
  bool overwrite_ = false;
  std::optional<Workspace> workspace_;
};

/// Opens a folder for results; ResultFolder describes what it replaces. Fails as OutputFile::create() does, and for a
/// new folder with the name of a file ("frames.mp4").
[[nodiscard]] Result<ResultFolder> open_result_folder(const std::filesystem::path& named, const OutputRules& rules);

/// A result folder that grows over several runs of one verb. Each run adds results with unique names and replaces
/// `files`, which describe all of them. An existing folder must be empty or belong to the same verb. Files with these
/// names that its run.json does not list are not replaced.
class GrowingFolder {
 public:
  GrowingFolder(std::string verb, std::vector<std::string> files) : verb_(std::move(verb)), files_(std::move(files)) {}

  /// Creates the folder, removes what a killed run left unfinished in it and in results/, and writes its run.json, so
  /// that a killed run can continue. Fails as OutputFile::create() does.
  [[nodiscard]] Result<void> open(const std::filesystem::path& named, const OutputRules& rules, Json record);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] Result<void> write_record(Json record) const;
  /// Removes the folder if open() created it and it contains only its record.
  void withdraw() const;

 private:
  bool is_new_ = false;
  std::string verb_;
  std::vector<std::string> files_;
  std::filesystem::path path_;
};

/// Fails with kInvalidValue if an output is, contains or lies in one of the inputs, comparing files and not names.
[[nodiscard]] Result<void> check_apart(const std::filesystem::path& output,
                                       const std::vector<std::filesystem::path>& inputs);

}  // namespace e2lf
