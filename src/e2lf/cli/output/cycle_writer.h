// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/cli/output/live_log.h"
#include "e2lf/files/options.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/field_sequence.h"

namespace e2lf::cli {

/// Returns the name of the folder of a cycle: cycle_00000, cycle_00001, ...
[[nodiscard]] std::string cycle_name(size_t cycle);

/// The settings of all light fields of a run.
struct CycleWriterOptions {
  std::filesystem::path input;  ///< name of the input, for messages
  std::string format;           ///< output format; see write_reconstruction()
  bool is_quiet = false;
  std::optional<capture::Orientation> views = {};  ///< orientation in which views are reconstructed
  std::optional<capture::Codes> codes = {};        ///< patterns that determine the signs of the events
};

/// Reconstructs cycles one by one, writes their light fields, and keeps a record of them.
class CycleWriter {
 public:
  CycleWriter(CycleWriterOptions options, pipeline::FieldSequence sequence)
      : options_(std::move(options)), sequence_(std::move(sequence)) {}

  /// Reconstructs a cycle and writes it to an existing folder. Returns the light field in upright orientation.
  Result<lightfield::LightField> process(const pipeline::CycleImages& cycle, const std::filesystem::path& folder);

  /// Returns the notes about the orientation of the views for the run records.
  [[nodiscard]] Json notes() const;
  [[nodiscard]] const Json& cycles() const { return cycles_; }
  [[nodiscard]] const LiveLog& live_log() const { return live_log_; }
  /// Returns the brightness of all cycles. At least one must have been processed.
  [[nodiscard]] const pipeline::Tone& tone() const { return sequence_.tone(); }

 private:
  Result<pipeline::Field> reconstruct(const pipeline::CycleImages& cycle);
  /// Warns about implausible events in the first cycles.
  void warn_of_events(const pipeline::CycleImages& cycle);

  CycleWriterOptions options_;
  pipeline::FieldSequence sequence_;
  size_t warned_ = 0;
  Json cycles_ = Json::array();
  LiveLog live_log_;
};

}  // namespace e2lf::cli
