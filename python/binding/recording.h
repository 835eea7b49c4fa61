// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"
#include "python/binding/calls.h"
#include "python/binding/events.h"

namespace e2lf::python {

/// The options of open_recording() with their Python names. The defaults are those of recordings::OpenOptions.
struct OpenArguments {
  std::string format = {}, stream = {}, columns = {},
              time_unit = word_of(recordings::OpenOptions().time_unit, recordings::kTimeUnits);
  std::string polarities = {}, restart = word_of(recordings::OpenOptions().restart, recordings::kRestartPolicies);
  size_t width = 0, height = 0;
  std::optional<int64_t> from_us = {}, to_us = {};
  bool relative = false, shift_time = false, strict = false;
  int threads = recordings::OpenOptions().threads;
  std::optional<recordings::CameraSetup> camera_setup = {};
};

/// Returns the options of a reader. Fails with kInvalidValue for an unknown word and an empty range of time.
[[nodiscard]] recordings::OpenOptions open_options(const std::string& name, const OpenArguments& arguments);

/// Opens a recording by its name, as the verbs do, and logs assumptions. Fails with kInvalidValue for restart="split"
/// unless the caller reads the parts.
[[nodiscard]] std::unique_ptr<recordings::RecordingReader> open_reader(const std::string& name,
                                                                       const OpenArguments& arguments,
                                                                       bool reads_parts = false);

/// Throws the failure that ended live input, such as an unplugged camera, if there was one.
void check_live(const recordings::DecodeSummary& summary);

/// The limits of a slice of a recording: a duration and a number of events, of which the earlier applies; without
/// either, slices are returned as decoded.
struct SliceSize {
  std::optional<int64_t> delta_us;
  std::optional<size_t> events;
};

/// A slice of a recording in the form in which Python receives it.
struct Slice {
  EventRecords events;
  std::vector<recordings::Trigger> triggers;
  int64_t begin_us = 0, end_us = 0;
};

/// A recording that is read in slices.
class Recording {
 public:
  Recording(std::string name, std::unique_ptr<recordings::RecordingReader> reader, std::optional<int64_t> from_us);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Throws ValueError if the recording is closed.
  [[nodiscard]] recordings::RecordingReader& reader() const;

  /// Returns the next slice, or nothing at the end. Fails once with kIo if live input failed. Slices of a fixed
  /// duration are contiguous and may be empty.
  [[nodiscard]] std::optional<Slice> next(const SliceSize& size);

  /// Returns all events and triggers with begin_us <= t < end_us, from any position; reading continues after them.
  [[nodiscard]] Slice between(int64_t begin_us, int64_t end_us);

  /// Continues with the next part after reading has ended because the clock starts again.
  [[nodiscard]] bool next_part();

  void seek(int64_t t_us);
  [[nodiscard]] recordings::DecodeSummary summary();
  void close();

 private:
  [[nodiscard]] Result<std::optional<Slice>> read_slice(const SliceSize& size);
  [[nodiscard]] Result<bool> refill();
  [[nodiscard]] int64_t next_us() const;
  void discard_batch();
  [[nodiscard]] Result<void> fill(Slice& slice, std::optional<size_t> most_events, int64_t end_us);
  void take_events(Slice& slice, size_t end);
  void take_triggers(Slice& slice, int64_t end_us);

  std::string name_;
  bool is_live_;
  std::unique_ptr<recordings::RecordingReader> reader_;
  size_t most_events_;                     ///< maximum number of events in a batch
  std::optional<int64_t> slice_begin_us_;  ///< start of the next slice of fixed duration
  recordings::EventBatch batch_;           ///< the data read last, returned up to event_ and trigger_
  size_t event_ = 0, trigger_ = 0;
  bool has_ended_ = false, has_failed_ = false;
  OneAtATime use_;
};

}  // namespace e2lf::python
