// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/cli/verbs.h"
#include "e2lf/diagnose/field_check.h"
#include "e2lf/files/options.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/field_sequence.h"

namespace e2lf::cli {

/// Writes a reconstructed light field to an existing folder: its views in `format` ("png" and "png16": VV_UU.png;
/// "npy": lightfield.npy, not clamped), contact_sheet.png and epi.png. `views` is the orientation of the views; all
/// images are written upright, and `light_field` is upright afterwards. Only lightfield.npy keeps the order of the
/// views, which is that of the patterns.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                lightfield::LightField& light_field, const std::string& format,
                                                const capture::Orientation& views, const ProgressFn& progress);

/// Returns the name of the folder of a cycle: cycle_00000, cycle_00001, ...
[[nodiscard]] std::string cycle_name(size_t cycle);

/// The settings of all light fields of a run.
struct LightFieldWriterOptions {
  std::filesystem::path input;  ///< name of the input, for messages
  std::string format;           ///< output format; see write_reconstruction()
  bool is_quiet = false;
  std::optional<capture::Orientation> views = {};  ///< orientation in which views are reconstructed
  std::optional<capture::Codes> codes = {};        ///< patterns that determine the signs of the events
  std::optional<diagnose::FieldCheck> check = {};  ///< compares each light field with its events
  size_t cycles_per_field = 1;                     ///< number of cycles over which counts are summed
  bool is_confirmed = true;                        ///< whether a file of event images states no doubt about its cycles
};

/// Reconstructs cycles one by one, writes their light fields, and keeps a record of them.
class LightFieldWriter {
 public:
  LightFieldWriter(LightFieldWriterOptions options, pipeline::FieldSequence sequence)
      : options_(std::move(options)), sequence_(std::move(sequence)) {}

  /// Reconstructs a cycle and writes it to an existing folder.
  [[nodiscard]] Result<void> process(const pipeline::CycleImages& cycle, const std::filesystem::path& folder);

  /// Returns the notes about the orientation of the views for the run records.
  [[nodiscard]] Json notes() const;
  [[nodiscard]] const Json& cycles() const { return cycles_; }
  [[nodiscard]] const LiveLog& live_log() const { return live_log_; }
  /// Returns the brightness of all cycles. At least one must have been processed.
  [[nodiscard]] const pipeline::Tone& tone() const { return sequence_.tone(); }

 private:
  /// Returns what may be wrong with the events of a cycle, and logs it for the first such cycles.
  diagnose::Findings check_events(const pipeline::CycleImages& cycle);
  /// Returns the comparison of a light field with its events for the record, judged if it is the first.
  [[nodiscard]] Result<Json> check_field(const lightfield::LightField& field, const capture::Measurement& used,
                                         bool is_of_lit, bool is_confirmed) const;

  LightFieldWriterOptions options_;
  pipeline::FieldSequence sequence_;
  size_t warned_ = 0;
  Json cycles_ = Json::array();
  LiveLog live_log_;
};

/// Returns a line on the difference between the events of a cycle of the record and those that its light field would
/// cause, with the verdict.
[[nodiscard]] std::string event_error_text(const Json& cycle);

/// Logs what the check of the first cycle of the record found.
void log_check(const std::filesystem::path& input, const Json& cycle);

}  // namespace e2lf::cli
