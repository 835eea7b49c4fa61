// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/options.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::cli {

/// What a run was made of: verb, version, resolved options, seed, SHA-256 of every input, timings. Written as run.json
/// beside the results, so that any result can be made again.
class RunRecord {
 public:
  explicit RunRecord(std::string verb);

  /// Adds an input file, or every file of an input folder. What is neither (a pipe, a camera) has no hash and is left
  /// out.
  void add_input(const std::filesystem::path& path);

  /// Adds an input file by what was read of it, which is hashed at once.
  void add_input(const std::filesystem::path& path, std::span<const uint8_t> bytes);

  /// Ends the step that began at construction or at the last call.
  void end_step(const std::string& name);

  /// A result or an estimate worth keeping, e.g. the gain that was chosen.
  void note(const std::string& key, Json value) { notes_[key] = std::move(value); }
  void note(const Json& notes) { notes_.update(notes); }

  /// The value that an option which leaves it open (a default of the model's, "auto") came to, so that the run can be
  /// made again from its record.
  void resolve(const std::string& option, Json value) { resolved_[option] = std::move(value); }

  [[nodiscard]] const Json& timings_s() const { return timings_s_; }

  /// The record; ResultFolder writes it as run.json. Reads the inputs, and warns of those that are not what they were
  /// in the run that is made again.
  [[nodiscard]] Result<Json> json(const Verb& verb) const;

  /// The record of a result of which parts are still being made: nothing of inputs and results yet.
  [[nodiscard]] Json json_so_far(const Verb& verb) const;

  /// Writes the record beside a single file, to OutputFile::record_path().
  [[nodiscard]] Result<void> write(const std::filesystem::path& path, const Verb& verb) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::string verb_;
  struct Input {
    std::filesystem::path path;
    std::string sha256;  ///< empty: not read yet
  };
  std::vector<Input> inputs_;
  Json timings_s_ = Json::object();
  Json notes_ = Json::object();
  Json resolved_ = Json::object();
  Clock::time_point step_begin_ = Clock::now();
};

/// The SHA-256 of a file in hex, as sha256sum prints it; for a folder, of its sorted "hash  name" lines.
[[nodiscard]] Result<std::string> sha256_of(const std::filesystem::path& path, const ProgressFn& progress = {});

}  // namespace e2lf::cli
