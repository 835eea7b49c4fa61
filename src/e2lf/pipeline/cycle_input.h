// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement_io.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/pipeline/recorded_setup.h"

namespace e2lf::pipeline {

using CycleClock = std::chrono::steady_clock;

/// What was measured for one light field.
struct CycleImages {
  capture::Measurement images;                       ///< of one cycle; of event images also sums over several
  std::optional<cycles::Cycle> cycle;                ///< of a recording: the last one, without its images
  CycleClock::time_point ready = CycleClock::now();  ///< when they were there: of a live recording, the last bytes
  double behind_s = 0;                               ///< from the end of the last pattern until then; live alone
  [[nodiscard]] bool is_live() const { return cycle && cycle->arrival; }
};

struct CycleInputOptions {
  size_t cycles_per_field = 1;
  uint64_t max_cycles = 0;       ///< 0 = all
  bool is_strict = false;        ///< sums beyond 16 bits are an error
  bool invert_polarity = false;  ///< of files of event images; a reader of cycles has an option of its own
  /// Sees each cycle of a recording.
  std::function<void(const cycles::Cycle& cycle, cycles::CycleSource source)> on_cycle = {};
};

/// The measurements for one light field after the other, from a file of them or cut from a recording as it is read.
class CycleInput {
 public:
  /// Fails with kInvalidValue if fewer cycles are asked for than one light field takes (location "max_cycles"), if a
  /// file holds fewer, or if an option does not apply to its kind of measurement.
  [[nodiscard]] static Result<CycleInput> create(capture::MeasurementFile file, CycleInputOptions options);
  [[nodiscard]] static Result<CycleInput> create(cycles::CycleReader reader, CycleInputOptions options);

  /// Returns the sums over the next cycles_per_field cycles, or nothing at the end, where fewer are left. What sums
  /// beyond 16 bits leave out is counted in summary().
  [[nodiscard]] Result<std::optional<CycleImages>> next();

  /// Returns true if all counts of a file of events are 0.
  [[nodiscard]] bool is_without_events() const;
  [[nodiscard]] bool is_recording() const { return reader_.has_value(); }
  /// Returns true if the file holds the cycles of one light field, however many are asked for. It is always false for
  /// recordings, whose length is unknown.
  [[nodiscard]] bool has_one_field() const { return has_one_field_; }
  [[nodiscard]] capture::MeasurementKind measurement() const {
    return reader_ ? capture::MeasurementKind::kEventImages : file_.cycles.front().kind;
  }
  /// Returns what the events were made with; `input` is the name under which they were opened. Fails as
  /// recorded_setup() does.
  [[nodiscard]] Result<capture::RecordedSetup> setup(const std::filesystem::path& input) const {
    if (!reader_) return file_.setup;
    return setup_of_cycles(input, *reader_);
  }
  /// Returns the reader of a recording; the contract is broken for files.
  [[nodiscard]] const cycles::CycleReader& reader() const { return reader_.value(); }
  /// Returns what was left out of a recording and of sums.
  [[nodiscard]] recordings::DecodeSummary summary() const;

 private:
  explicit CycleInput(CycleInputOptions options) : options_(std::move(options)) {}
  [[nodiscard]] Result<std::optional<CycleImages>> next_cycle();

  CycleInputOptions options_;
  capture::MeasurementFile file_;
  std::optional<cycles::CycleReader> reader_;
  bool has_one_field_ = false;
  size_t taken_ = 0;
  uint64_t saturated_ = 0;  ///< of sums
};

/// Adds the counts of another cycle to a sum of the same shape. Returns how many events there is no room for in 16
/// bits.
uint64_t add_counts(const capture::EventImages& more, capture::EventImages& sum);

/// Returns the time from the end of the last pattern of a cycle until the bytes that completed it arrived, or 0 if the
/// input is not live.
[[nodiscard]] double behind_s(const cycles::Cycle& cycle);

}  // namespace e2lf::pipeline
