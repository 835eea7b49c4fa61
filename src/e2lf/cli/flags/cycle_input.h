// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement_io.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/recorded_setup.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {

using CycleClock = std::chrono::steady_clock;

/// What was measured of a light field, and what is known of it.
struct CycleImages {
  capture::Measurement images;  ///< of one cycle; of event images also sums over several
  Json about = Json::object();  ///< for the record: of a recording, times and confidence of the last cycle
  CycleClock::time_point ready = CycleClock::now();  ///< when they were there: of a live recording, the last bytes
  double behind_s = 0;   ///< from the end of the last pattern until then; live recordings only
  bool is_live = false;  ///< came as it was recorded
};

/// The event images of one light field after the other, from a file of them or cut from a recording as it is read.
class CycleInput {
 public:
  CycleInput(capture::MeasurementFile file, const CycleFlags& flags, size_t cycles_per_field)
      : file_(std::move(file)), cycles_per_field_(cycles_per_field), is_strict_(flags.recording.is_strict) {
    has_one_field_ = file_.cycles.size() / cycles_per_field == 1;
    if (flags.max_cycles != 0 && flags.max_cycles < file_.cycles.size()) file_.cycles.resize(flags.max_cycles);
  }
  CycleInput(cycles::CycleReader reader, const CycleFlags& flags, size_t cycles_per_field)
      : reader_(std::move(reader)),
        max_cycles_(flags.max_cycles),
        cycles_per_field_(cycles_per_field),
        is_strict_(flags.recording.is_strict) {}

  /// The sums over the next cycles_per_field cycles; nothing at the end, where fewer are left. What sums beyond 16 bits
  /// leave out is counted in summary(), and is an error with --strict.
  [[nodiscard]] Result<std::optional<CycleImages>> next();

  /// Whether all counts of a file of events are 0.
  [[nodiscard]] bool is_without_events() const;
  [[nodiscard]] bool is_recording() const { return reader_.has_value(); }
  /// Whether the file holds the cycles of one light field, however many are asked for. Of a recording nobody knows.
  [[nodiscard]] bool has_one_field() const { return has_one_field_; }
  [[nodiscard]] capture::MeasurementKind measurement() const {
    return reader_ ? capture::MeasurementKind::kEventImages : file_.cycles.front().kind;
  }
  /// What the events were made with; `input` as it was opened. Fails as recorded_setup() does.
  [[nodiscard]] Result<RecordedSetup> setup(const std::filesystem::path& input) const {
    return reader_ ? setup_of_cycles(input, *reader_) : recorded_setup(file_, input);
  }
  [[nodiscard]] cycles::CycleSource source() const { return reader_->source(); }
  /// Of a recording alone.
  [[nodiscard]] const cycles::Schedule& schedule() const { return reader_->schedule(); }
  [[nodiscard]] const ConfidenceWatch& confidence() const { return confidence_; }
  [[nodiscard]] const recordings::RecordingInfo& info() const { return reader_->recording().info(); }
  [[nodiscard]] cycles::CycleReport report() const { return reader_->report(); }
  /// What was left out of a recording and of sums.
  [[nodiscard]] recordings::DecodeSummary summary() const;

 private:
  [[nodiscard]] Result<std::optional<CycleImages>> next_cycle();

  capture::MeasurementFile file_;
  std::optional<cycles::CycleReader> reader_;
  uint64_t max_cycles_ = 0;
  size_t cycles_per_field_ = 1;
  bool is_strict_ = false, has_one_field_ = false;
  ConfidenceWatch confidence_;
  size_t taken_ = 0;
  uint64_t saturated_ = 0;  ///< of sums
};

/// Opens event images, another measurement or a recording. Fails with kInvalidValue where flags of recordings are given
/// for a measurement, where a file holds fewer cycles than one light field needs or fewer are asked for.
[[nodiscard]] Result<CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                  size_t cycles_per_field, const Verb& verb);

}  // namespace e2lf::cli
