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

/// The folder of a cycle: cycle_00000 ...
[[nodiscard]] std::string cycle_name(size_t cycle);

/// What all light fields of a run have in common.
struct CycleWriterOptions {
  std::filesystem::path input;  ///< for messages
  std::string format;           ///< of write_reconstruction()
  bool is_quiet = false;
  std::optional<capture::Orientation> views = {};  ///< how they come out
  std::optional<capture::Codes> codes = {};        ///< from which the signs of the events follow
};

/// Reconstructs cycles and writes each; what has been done so far.
class CycleWriter {
 public:
  CycleWriter(CycleWriterOptions options, pipeline::FieldSequence sequence)
      : options_(std::move(options)), sequence_(std::move(sequence)) {}

  /// Into an existing folder. Returns the light field, upright.
  Result<lightfield::LightField> process(const pipeline::CycleImages& cycle, const std::filesystem::path& folder);

  /// What the records of folders with views note of them.
  [[nodiscard]] Json notes() const;
  [[nodiscard]] const Json& cycles() const { return cycles_; }
  [[nodiscard]] const LiveLog& live_log() const { return live_log_; }
  /// Of all cycles; there must be one.
  [[nodiscard]] const pipeline::Tone& tone() const { return sequence_.tone(); }

 private:
  Result<pipeline::Field> reconstruct(const pipeline::CycleImages& cycle);
  /// Says of the first cycles why their events are hardly those of a scene.
  void warn_of_events(const pipeline::CycleImages& cycle);

  CycleWriterOptions options_;
  pipeline::FieldSequence sequence_;
  size_t warned_ = 0;
  Json cycles_ = Json::array();
  LiveLog live_log_;
};

}  // namespace e2lf::cli
