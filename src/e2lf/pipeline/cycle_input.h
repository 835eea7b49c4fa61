// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/recon/fusion.h"

namespace e2lf::pipeline {

using CycleClock = std::chrono::steady_clock;

/// The measurement for one light field.
struct CycleImages {
  capture::Measurement images;  ///< images of one cycle, or event images summed over several
  /// The last cycle, without its images, with the least confidence of all of them; only for recordings.
  std::optional<cycles::Cycle> cycle;
  size_t without_events = 0;                                ///< number of cycles without events
  cycles::CycleSource source = cycles::CycleSource::kAuto;  ///< what determines the times of its patterns
  CycleClock::time_point ready = CycleClock::now();  ///< when the images, or the last bytes of live input, arrived
  double behind_s = 0;  ///< from the end of the last pattern until the last bytes arrived; 0 unless live
  [[nodiscard]] bool is_live() const { return cycle && cycle->arrival; }
};

/// What determines the schedule of a recording.
struct ScheduleChoice {
  std::optional<cycles::Schedule> schedule = {};  ///< that of the caller; empty = the paper's
  std::optional<size_t> num_patterns = {};        ///< of the paper's schedule; empty = as the recording states
  size_t usual_patterns = 4;                      ///< of the paper's schedule if nothing else states it
  /// "lit", "all", or "auto": all transitions if the network or the patterns of the recording require it.
  std::string transitions = "auto";
  std::optional<size_t> num_wanted = {};  ///< number of patterns of the network
};

/// Events that were opened: the content of a file of measurements, or a recording.
using EventSource = std::variant<capture::MeasurementFile, std::unique_ptr<recordings::RecordingReader>>;

/// Returns a result whose error names `input` if it has no location of its own.
template <typename T>
[[nodiscard]] Result<T> naming(const std::filesystem::path& input, Result<T> result) {
  if (result || !result.error().location.empty()) return result;
  Error error = result.error();
  error.location = input.string();
  return error;
}

/// How events are divided into cycles and summed.
struct CycleInputOptions {
  std::filesystem::path input = {};  ///< the name under which the events were opened
  size_t cycles_per_field = 1;
  uint64_t max_cycles = 0;                ///< 0 = all
  bool is_strict = false;                 ///< whether sums that exceed 16 bits are an error
  cycles::CycleOptions cycles = {};       ///< of a recording, without the schedule; its polarity also applies to files
  ScheduleChoice schedule = {};           ///< of a recording
  std::optional<int64_t> origin_us = {};  ///< see open_cycles()
};

/// Provides the measurements for a sequence of light fields, from a file of measurements or from a recording that is
/// divided into cycles while it is read.
class CycleInput {
 public:
  /// Opens the input. Fails with kInvalidValue if max_cycles is less than cycles_per_field (option "max_cycles"), if
  /// a file contains fewer cycles than one light field takes, or if an option does not apply to the kind of
  /// measurement; and as open_cycles() does.
  [[nodiscard]] static Result<CycleInput> open(EventSource source, CycleInputOptions options);

  /// Returns the sums over the next cycles_per_field cycles, or nothing if fewer are left; these are counted in
  /// summary(). Sums saturate at 16 bits, and the events lost in this way are counted there, too.
  [[nodiscard]] Result<std::optional<CycleImages>> next();

  /// Fuses each cycle with up to `most_cycles` before it, of which a camera with this profile recorded the events: see
  /// recon::CycleFusion. The images remain those of the last cycle. Fails with kInvalidValue, option "fuse", for
  /// measurements other than event images and for sums over cycles.
  [[nodiscard]] Result<void> fuse(const capture::SensorProfile& camera, size_t most_cycles);

  /// Fails with kInvalidValue, option "transitions", if the lit ones of event images are requested, which only a
  /// calibration selects.
  [[nodiscard]] Result<void> check_transitions() const;

  /// Returns true if all counts of a file of event images are 0.
  [[nodiscard]] bool is_without_events() const;
  [[nodiscard]] bool is_recording() const { return reader_.has_value(); }
  /// Returns true if the file contains the cycles of exactly one light field. Always false for recordings, whose length
  /// is unknown.
  [[nodiscard]] bool has_one_field() const { return has_one_field_; }
  [[nodiscard]] capture::MeasurementKind measurement() const {
    return reader_ ? capture::MeasurementKind::kEventImages : file_.cycles.front().kind;
  }
  /// Returns the number of event images of a cycle.
  [[nodiscard]] size_t transitions() const {
    return reader_ ? reader_->schedule().num_images() : file_.cycles.front().events.count;
  }
  /// Returns the setup with which the events were recorded. Fails as recorded_setup() does.
  [[nodiscard]] Result<capture::RecordedSetup> setup() const {
    if (!reader_) return file_.setup;
    return setup_of_cycles(options_.input, *reader_);
  }
  /// Returns the reader of the recording, and what its cycles told of the rig. The former must not be called for files.
  [[nodiscard]] const cycles::CycleReader& reader() const { return reader_.value(); }
  [[nodiscard]] const diagnose::RigCheck& rig() const { return *rig_; }
  /// Returns a summary of the data that was left out of the recording and of sums.
  [[nodiscard]] recordings::DecodeSummary summary() const;

 private:
  explicit CycleInput(CycleInputOptions options) : options_(std::move(options)) {}
  [[nodiscard]] Result<void> take(capture::MeasurementFile file);
  [[nodiscard]] Result<std::optional<CycleImages>> next_cycle();

  CycleInputOptions options_;
  capture::MeasurementFile file_;
  std::optional<cycles::CycleReader> reader_;
  std::shared_ptr<diagnose::RigCheck> rig_ = std::make_shared<diagnose::RigCheck>();
  std::optional<recon::CycleFusion> fusion_;
  bool has_one_field_ = false;
  size_t taken_ = 0;
  uint64_t saturated_ = 0;  ///< number of events lost to saturated sums
  uint64_t left_over_ = 0;  ///< number of cycles at the end, too few for a sum
};

/// Adds the counts of another cycle to a sum of the same shape. Returns the number of events that were lost because the
/// sum saturates at 16 bits.
uint64_t add_counts(const capture::EventImages& more, capture::EventImages& sum);

/// Opens the cycles of a recording with the schedule and the source of times that follow from the options and the
/// recording. An automatic source becomes the one that other options imply: triggers if their channel or kind is given,
/// and the schedule if `origin_us` is given, the time at which the first pattern of any cycle began. Fails with
/// kInvalidValue if the schedule is the source and this time is missing, and as recorded_setup() and
/// CycleReader::open() do.
[[nodiscard]] Result<cycles::CycleReader> open_cycles(std::unique_ptr<recordings::RecordingReader> recording,
                                                      const CycleInputOptions& options);

}  // namespace e2lf::pipeline
