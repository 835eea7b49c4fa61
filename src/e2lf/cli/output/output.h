// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/files/workspace.h"
#include "e2lf/recordings/open/recording_place.h"

namespace e2lf::cli {

/// The one place that decides where a verb may write and what that may replace. Every output of every verb goes through
/// OutputFile or open_output_folder().
///
/// A run that was killed leaves its workspace. The next run to the same place removes it. What was made of live input,
/// which does not come again, it keeps first:
using Recover = std::function<std::string(const std::filesystem::path& partial, const std::filesystem::path& kept)>;
/// writes what is finished in `partial` to `kept` and returns what that is ("12 cycles"), or "" when it is nothing.

struct OutputRules {
  std::vector<std::filesystem::path> inputs = {};  ///< what the verb reads; "" and names that are no path are left out
  bool overwrite = false;
  std::string ending = {};  ///< what the name of a file ends in, where there is one format: ".png"
  bool streams = false;     ///< the format is written front to back, so "-", devices and pipes will do
  /// Where a recording's triggers go that its format has no place for; null = nowhere.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;
  Recover recover = {};
};

/// For event images, and for recordings.
[[nodiscard]] std::string recover_cycles(const std::filesystem::path& partial, const std::filesystem::path& kept);
[[nodiscard]] Recover recover_recording(const recordings::RecordingPlace& place);

/// A file of results with the files that belong to it: its record (<file>.run.json) and its triggers
/// (<stem>_triggers.csv, <stem>_trigger.dat). They are checked together, appear together and are replaced together.
/// A file of triggers that another recording has too (a.csv, a.npy) stays as it is, and must be what this one needs.
class OutputFile {
 public:
  /// Resolves links in `named` and checks it and its side files. Fails with kExists (something is there that may not be
  /// replaced), kInvalidValue (the output is, contains or lies in an input, or its name says another format),
  /// kUnsupported (a stream, where the format needs a file) and kIo.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& named, const OutputRules& rules);

  /// Where to write: a name in a workspace, or the stream itself ("-" for standard output).
  [[nodiscard]] const std::filesystem::path& path() const { return place_; }
  /// Where to write the record.
  [[nodiscard]] std::filesystem::path record_path() const;
  [[nodiscard]] bool is_stream() const { return !workspace_.has_value(); }

  /// Where what is said to people goes: standard error when standard output holds data.
  [[nodiscard]] std::FILE* text() const { return place_ == "-" ? stderr : stdout; }

  /// Puts all that was written to path() and beside it in place, and removes side files of the result that was
  /// replaced. Nothing to do for a stream. Fails with kExists and kIo.
  [[nodiscard]] Result<void> commit();

 private:
  OutputFile() = default;
  [[nodiscard]] Result<void> check_place() const;
  std::filesystem::path target_, place_;
  std::filesystem::path triggers_;  ///< where they go; empty = nowhere
  bool overwrite_ = false, is_live_ = false;
  std::optional<Workspace> workspace_;
};

/// A folder of results; see ResultFolder for what it replaces. Fails as OutputFile::create(), and for a new folder with
/// the name of a file ("frames.mp4").
[[nodiscard]] Result<ResultFolder> open_output_folder(const std::filesystem::path& named, const OutputRules& rules);

/// A folder of results that grows over several runs of one verb: runs add results with names that no one else uses, and
/// replace `files`, which tell of all of them. A folder that is there must be empty or of the same verb. Files of those
/// names that its run.json does not list are not replaced.
class GrowingFolder {
 public:
  GrowingFolder(std::string verb, std::vector<std::string> files) : verb_(std::move(verb)), files_(std::move(files)) {}

  /// Makes the folder, clears what a killed run left half written there and in results/, and writes its run.json, so
  /// that a run that is killed can go on. Fails as OutputFile::create().
  [[nodiscard]] Result<void> open(const std::filesystem::path& named, const OutputRules& rules, Json record);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] Result<void> write_record(Json record) const;

 private:
  std::string verb_;
  std::vector<std::string> files_;
  std::filesystem::path path_;
};

/// Fails with kInvalidValue when an output is, contains or lies in one of the inputs, through links or not.
[[nodiscard]] Result<void> check_apart(const std::filesystem::path& output,
                                       const std::vector<std::filesystem::path>& inputs);

}  // namespace e2lf::cli
