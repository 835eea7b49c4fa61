// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/live/pace.h"
#include "e2lf/live/render.h"
#include "e2lf/live/statistics.h"
#include "e2lf/recon/fusion.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// Records the event stream on request. Each recording is a new file recording_000.raw, recording_001.raw, ... in EVT3
/// with the header of the source. The file grows as events arrive, so that it contains everything read so far however
/// the program ends. All functions may be called from any thread.
class Recorder {
 public:
  /// Recordings are written to `folder`, which must exist. If it is empty, begin() fails.
  Recorder(std::filesystem::path folder, recordings::RecordingInfo info);

  /// Starts a recording unless one is in progress. Fails with kInvalidValue (no folder), kNotFound and kIo.
  [[nodiscard]] Result<void> begin();
  /// Ends the recording if one is in progress. Fails with kIo.
  [[nodiscard]] Result<void> end();

  [[nodiscard]] bool is_recording() const;

  /// Appends a batch if a recording is in progress. A write error ends the recording and is reported by json().
  void write(const recordings::EventBatch& batch);

  /// Returns {"can_record", "is_recording", "file", "bytes", "error"} of the current or else of the last recording.
  [[nodiscard]] Json json() const;

 private:
  [[nodiscard]] Result<void> finish();

  std::filesystem::path folder_, file_;
  recordings::RecordingInfo info_;
  mutable std::mutex mutex_;
  std::unique_ptr<recordings::RecordingWriter> writer_;
  std::string error_;
  size_t number_ = 0;
};

/// The sharpness of all event images of a cycle. Unlike that of a picture, which shows the patterns of its moment, it
/// is the same for each cycle of a still scene, but for noise.
struct CycleSharpness {
  uint64_t number = 0;  ///< of the cycle in the recording
  double sharpness = 0;
};

/// A picture of the events of a short time window.
struct EventPicture {
  lightfield::ByteImage image;  ///< 128 = no events, brighter = ON, darker = OFF
  uint64_t events = 0;
  double sharpness = 0;                      ///< see sharpness_of()
  std::optional<CycleSharpness> cycle = {};  ///< of the newest cycle; empty until there is one
};

/// Computes how sharp the edges are in a picture [y, x] of the number of ON minus OFF events per pixel: the mean
/// product of the differences between neighbours in adjacent rows (and columns), divided by the square of the mean
/// number of events per pixel, and at least 0. Edges extend over several rows, whereas the noise of the pixels is
/// independent and cancels. Defocus flattens edges, so that the value is largest in focus; it does not depend on the
/// event rate. Returns 0 if there are no events or fewer than 2x2 pixels.
[[nodiscard]] double sharpness_of(std::span<const int16_t> signed_counts, size_t width, uint64_t events);

/// Returns the mean over the event images of a cycle, weighted by the squares of their numbers of events.
[[nodiscard]] double sharpness_of(const capture::EventImages& images);

/// Makes pictures of the event stream for framing and focusing, but only while pictures are requested. Each picture
/// accumulates the events of kWindowUs; the next picture starts after the previous one was taken.
class EventPreview {
 public:
  static constexpr int64_t kWindowUs = 30'000;

  EventPreview(size_t width, size_t height) : width_(width), height_(height) {}

  /// Adds a batch of events. Called by the reading thread.
  void add(const recordings::EventBatch& batch);

  /// Passes the newest cycle on. Called by the reading thread.
  void add_cycle(uint64_t number, const capture::EventImages& images);

  /// Requests pictures and returns the newest one, or nothing if none is complete yet. A request is valid for
  /// kPatience.
  [[nodiscard]] std::optional<EventPicture> take(Clock::time_point now = Clock::now());

  /// Returns true while a request is valid.
  [[nodiscard]] bool is_asked(Clock::time_point now = Clock::now()) const;

 private:
  static constexpr std::chrono::seconds kPatience{2};
  void finish();

  size_t width_, height_;
  mutable std::mutex mutex_;
  std::optional<Clock::time_point> asked_;
  std::optional<int64_t> begin_us_;
  std::vector<int16_t> signed_;
  std::vector<uint16_t> all_;
  uint64_t events_ = 0;
  std::optional<EventPicture> finished_;
  std::optional<CycleSharpness> cycle_;
};

/// Converts times of the sensor's clock to arrival times at this host. Most bytes arrive late, because they are sent in
/// pieces and wait to be decoded. The offset between the clocks is therefore that of the least delayed bytes within the
/// last kWindow, which also follows the drift of the clocks.
class ArrivalClock {
 public:
  static constexpr std::chrono::seconds kWindow{5};

  /// `speed` is that of the sensor's clock: above 1 for a recording that is replayed faster than it was recorded.
  explicit ArrivalClock(double speed = 1) : speed_(speed) {}

  /// Adds bytes that arrived at `arrival` and whose newest event has the time t_us.
  void add(Clock::time_point arrival, int64_t t_us) {
    const int64_t offset_us =
        std::chrono::duration_cast<std::chrono::microseconds>(arrival.time_since_epoch()).count() - host_us(t_us);
    if (arrival - begin_ >= kWindow) {
      before_us_ = least_us_;
      least_us_ = kUnknown;
      begin_ = arrival;
    }
    least_us_ = std::min(least_us_, offset_us);
  }

  /// Returns when an event with the time t_us arrived. add() must have been called before.
  [[nodiscard]] Clock::time_point arrival_of(int64_t t_us) const {
    return Clock::time_point(std::chrono::microseconds(std::min(least_us_, before_us_) + host_us(t_us)));
  }

 private:
  [[nodiscard]] int64_t host_us(int64_t t_us) const {
    return speed_ == 1 ? t_us : std::llround(static_cast<double>(t_us) / speed_);
  }

  static constexpr int64_t kUnknown = std::numeric_limits<int64_t>::max() / 2;
  double speed_;
  Clock::time_point begin_{};
  int64_t least_us_ = kUnknown, before_us_ = kUnknown;
};

/// Maximum number of cycles of a static scene that are summed.
inline constexpr size_t kMostCycles = 16;

/// Sums the event images of the last cycles of a static scene. Memory is bounded by kMostCycles cycles.
class CycleSum {
 public:
  /// Adds the images of a cycle and replaces them by the sum over the last `wanted` cycles (1 to kMostCycles), or over
  /// all cycles if fewer were added. Returns the number of cycles in the sum. Sums saturate at the range of int16.
  /// Images whose shape differs from that of the previous ones start a new sum.
  size_t add(capture::EventImages& images, size_t wanted);

 private:
  std::deque<capture::EventImages> last_;
  std::vector<int32_t> sum_;
};

/// Opens a live source that is divided into cycles. `on_batch` is called for each batch that is read.
using OpenCycles =
    std::function<Result<cycles::CycleReader>(const std::function<void(const recordings::EventBatch&)>& on_batch)>;

struct ReadingOptions {
  std::filesystem::path recordings = {};  ///< the folder of Recorder
  bool is_inverted = false;               ///< batches have ON and OFF exchanged; recordings store them as sent
  uint64_t max_cycles = 0;                ///< 0 = all
  double speed = 1;                       ///< of the sensor's clock, above 1 for a recording that is replayed faster
  std::function<void(const diagnose::Finding&)> on_finding = {};  ///< called once for each code
};

/// Reads a live source as fast as it delivers: finds cycles, accumulates and fuses event images, updates the
/// statistics, records, and makes pictures for focusing. next() must be called by one thread only; all other functions
/// may be called from any thread. While there is neither a recording nor a request for pictures, most cycles are read
/// without the events that are not part of an event image; see cycles::CycleReader::read_whole_every().
class LiveReader {
 public:
  /// Opens the source. Fails as `open` does.
  [[nodiscard]] static Result<std::unique_ptr<LiveReader>> open(const OpenCycles& open, const ReadingOptions& options);

  /// Waits for the next complete cycle that is not dropped as a late one (LateCycles) and swaps it into `cycle`. The
  /// last cycle is never dropped. Returns false at the end of the source, after max_cycles, and soon after a stop was
  /// requested. Fails as CycleReader::next() does.
  [[nodiscard]] Result<bool> next(LiveCycle& cycle);

  /// Sets the number of cycles (1 to kMostCycles) over which event images are summed, from the next cycle on.
  void set_average(size_t cycles) { average_ = cycles; }
  [[nodiscard]] size_t average() const { return average_; }

  /// Prepares the fusion of cycles from a camera with this profile (recon::CycleFusion), in means of up to
  /// `most_cycles`. Without this call, there is none. Must be called before next().
  void prepare_fusion(const capture::SensorProfile& camera, size_t most_cycles);
  /// Returns the largest number of cycles in a mean, or 0 if prepare_fusion() was not called.
  [[nodiscard]] size_t most_fused() const { return sensor_ ? most_fused_ : 0; }
  /// Sets whether cycles are fused, from the next one on. Cycles that are summed are not.
  void set_fusing(bool is_fusing) { wants_fusion_ = is_fusing; }
  [[nodiscard]] bool is_fusing() const { return sensor_ && wants_fusion_ && average_ == 1; }

  [[nodiscard]] const cycles::CycleReader& cycles() const { return *cycles_; }
  /// Returns the check of the rig; only the thread that reads may call it.
  [[nodiscard]] const diagnose::RigCheck& rig() const { return rig_; }
  /// Adds what another check found. May be called from any thread.
  void add_findings(const diagnose::Findings& findings);
  [[nodiscard]] Statistics& statistics() { return statistics_; }
  [[nodiscard]] EventPreview& preview() { return *preview_; }
  [[nodiscard]] Recorder& recorder() { return *recorder_; }

 private:
  [[nodiscard]] Result<bool> read(LiveCycle& cycle);
  void see(const recordings::EventBatch& batch);
  void choose_events();
  void fuse(LiveCycle& cycle);
  /// Updates the statistics and the findings, which short sources only get at their end.
  void report(bool has_ended = false);
  void announce(const diagnose::Findings& findings);

  ReadingOptions options_;
  std::optional<cycles::CycleReader> cycles_;
  diagnose::RigCheck rig_;
  std::mutex findings_mutex_;
  diagnose::Findings other_findings_;
  std::set<std::string> announced_;  ///< codes
  Statistics statistics_;
  std::optional<EventPreview> preview_;
  std::optional<Recorder> recorder_;
  std::atomic<size_t> average_ = 1;
  std::optional<capture::SensorProfile> sensor_;  ///< of the cycles that can be fused
  size_t most_fused_ = 1;
  std::atomic<bool> wants_fusion_ = true;
  std::optional<recon::CycleFusion> fusion_;
  CycleSum sum_;
  LateCycles late_;
  uint64_t taken_ = 0;
  bool has_all_events_ = false;
  recordings::EventBatch sent_;  ///< a batch with the polarity that was sent
  ArrivalClock arrivals_;
  Clock::time_point reported_{};
  std::optional<std::pair<uint64_t, int64_t>> previous_;  ///< number and begin of the previous cycle
};

}  // namespace e2lf::live
