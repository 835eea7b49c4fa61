// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>

#include "e2lf/base/result.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/options.h"
#include "e2lf/live/event_preview.h"
#include "e2lf/live/live_cycle.h"
#include "e2lf/live/pace.h"
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
