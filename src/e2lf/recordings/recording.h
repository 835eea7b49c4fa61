// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/io/decode_summary.h"
#include "e2lf/recordings/timeline.h"

namespace e2lf::recordings {

class RunningCamera;

/// A rectangle of the sensor, in pixels from its upper left corner.
struct SensorRegion {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const SensorRegion&) const = default;
};

/// The settings that are applied to a live camera before it starts. Empty settings are left as the camera has them.
struct CameraSetup {
  /// Trigger inputs to enable: "main", "aux", or the number of their triggers; "none" disables all. Empty = all inputs
  /// of the camera.
  std::vector<std::string> trigger_channels = {};
  std::filesystem::path biases = {};              ///< a file of biases, as written by the vendor's programs (.bias)
  std::optional<uint32_t> max_events_per_s = {};  ///< limit of the event rate controller, which drops events; 0 = off
  std::vector<SensorRegion> regions = {};         ///< the pixels that send events; empty = all
  std::string encoding = {};                      ///< "evt2", "evt2.1", "evt3"
  bool switches_filters_off = false;  ///< the anti-flicker and event trail filters of the sensor, which drop events
  std::shared_ptr<RunningCamera> running = {};  ///< receives the camera when it has started
  bool operator==(const CameraSetup&) const = default;
};

/// Returns whether anything is to be set.
[[nodiscard]] bool has_settings(CameraSetup setup);

/// Parses regions, "X,Y,WIDTH,HEIGHT" with spaces between them; "all" and an empty text are none. Fails with
/// kInvalidValue.
[[nodiscard]] Result<std::vector<SensorRegion>> parse_regions(const std::string& text);

/// Something that a file does not state and that was assumed, as text, and the name of the option that overrides it.
struct Assumption {
  std::string text;
  std::string option = {};
};

/// How a table of events (text, numpy arrays, HDF5 columns) was read.
struct TableReading {
  std::string columns;    ///< "t, x, y, p", in the order of the file, or "x, y, p, t" for named columns
  std::string time_unit;  ///< "s", "ms", "us" or "ns"
  std::string polarity;   ///< "0 = OFF, 1 = ON"
};

/// The properties that a recording states.
struct RecordingInfo {
  std::string format = {};  ///< the codec: "evt2", "evt2.1", "evt3", "dat", "hdf5", "aedat4", "csv", ...
  size_t width = 0;         ///< size of the sensor, px; 0 if the file does not state it
  size_t height = 0;
  std::vector<std::pair<std::string, std::string>> header = {};  ///< keys and values in the order of the file
  std::vector<Assumption> assumptions = {};
  std::vector<std::string> streams = {};   ///< streams of events, if the format may hold several
  std::optional<TableReading> table = {};  ///< only for tables

  /// Returns the value of a header key, or nothing.
  [[nodiscard]] std::optional<std::string> find(const std::string& key) const;
};

enum class TimeOrigin {
  kAbsolute,  ///< times are those of the sensor's clock
  kZero,      ///< the first event or trigger of the recording is at 0, and all others are shifted alike
};

/// The unit of the times in a table.
enum class TimeUnit {
  kAuto,  ///< as the names state, otherwise microseconds for whole numbers and seconds for fractions
  kSeconds,
  kMilliseconds,
  kMicroseconds,
  kNanoseconds,
};

/// The names of the units in options.
inline constexpr Choice<TimeUnit> kTimeUnits[] = {{"auto", TimeUnit::kAuto},
                                                  {"s", TimeUnit::kSeconds},
                                                  {"ms", TimeUnit::kMilliseconds},
                                                  {"us", TimeUnit::kMicroseconds},
                                                  {"ns", TimeUnit::kNanoseconds}};

/// The names of the policies in options.
inline constexpr Choice<RestartPolicy> kRestartPolicies[] = {
    {"continue", RestartPolicy::kContinue}, {"split", RestartPolicy::kSplit}, {"refuse", RestartPolicy::kRefuse}};

struct OpenOptions {
  std::string format = {};                      ///< empty = detected by content, or else by extension
  DecodePolicy policy = DecodePolicy::kReport;  ///< how to treat damage
  TimeOrigin time = TimeOrigin::kAbsolute;
  size_t width = 0;  ///< sensor size for files that do not state it; a contradiction is kInvalidValue
  size_t height = 0;
  TimeUnit time_unit = TimeUnit::kAuto;  ///< unit of tables; kInvalidValue for formats with a fixed unit
  std::string columns = {};     ///< order of the columns of tables, e.g. "txyp", where "-" skips a column; empty = as
                                ///< their names state
  std::string polarities = {};  ///< the numbers of OFF and ON in tables, e.g. "1,2"; empty = 0/1 or -1/1
  std::string stream = {};      ///< number or name of a stream of events if there are several
  int threads = 0;              ///< number of threads of one read() call; 0 = all cores
  RestartPolicy restart = RestartPolicy::kContinue;
  bool counts_reports = false;  ///< whether to sum the sensor's own counts, which takes time

  /// read() returns only from_us <= t < to_us. These are times of the sensor's clock, whatever `time` is, or with kZero
  /// for `range`, times since the first event or trigger. In files, the reader seeks; in streams, it skips.
  int64_t from_us = INT64_MIN;
  int64_t to_us = INT64_MAX;
  TimeOrigin range = TimeOrigin::kAbsolute;

  CameraSetup camera = {};  ///< settings of a live camera; see Camera::set_up()
};

/// Reads a recording of any format from front to back in bounded memory. open_recording() creates readers of
/// formats. Timeline describes which times are believed.
class RecordingReader {
 public:
  static constexpr size_t kDefaultBatch = size_t{1} << 18;
  static constexpr size_t kMinBatch = 64;

  /// `blocks` may be null, if there are only triggers; `triggers` are those that are stored separately, in order of
  /// time; `name` is the name of the source, for messages.
  RecordingReader(BlocksPtr blocks, RecordingInfo info, const std::string& name, const OpenOptions& options,
                  BlocksPtr triggers = {});

  [[nodiscard]] const RecordingInfo& info() const { return info_; }
  [[nodiscard]] const OpenOptions& options() const { return options_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Replaces `batch` by the next events and triggers, at most `max_events` (>= kMinBatch) of each; live: what has
  /// come. Returns false with an empty batch at the end; summary().live.failure tells a failure of live input from it.
  /// Fails with kIo, with kFormat if the events are not in order of time (Timeline), and, under the strict policy, with
  /// the first violation. After a stop request or a failure of live input, an end inside a word is not a violation.
  [[nodiscard]] Result<bool> read(EventBatch& batch, size_t max_events = kDefaultBatch);

  /// Declares that events with begin_us <= t < end_us (times as returned by read()) are not needed. A format that
  /// decodes faster without them leaves out those that are not decoded yet, as many as is cheap; triggers are always
  /// returned. The span holds until another one is given, or until seek().
  void skip_events(int64_t begin_us, int64_t end_us);

  /// Seeks to the first event or trigger with t >= t_us, forwards or backwards but within the range of the options, and
  /// resets the summary. Fails with kUnsupported if the source is not seekable.
  [[nodiscard]] Result<void> seek(int64_t t_us);

  /// Continues with the next part of a recording whose clock starts again. With RestartPolicy::kSplit, read() ends at
  /// such a place; the next part has its own times, and the summary is reset. Returns false at the end of the
  /// recording. Fails as read() does.
  [[nodiscard]] Result<bool> next_part();

  /// Returns when the newest bytes of what was returned arrived at this host, or nothing if the source is not live.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> arrival() const;

  /// Replaces the properties of the recording by those of the container that holds it: format, header, streams and
  /// assumptions.
  void take_container(RecordingInfo info) { info_ = std::move(info); }

  /// Includes the losses of a source from which the bytes of this reader come, such as a camera, a bag, or the one that
  /// decompresses them.
  void count_losses(std::function<DecodeSummary()> losses) { losses_before_.push_back(std::move(losses)); }

  /// Returns the summary of everything that read() has returned and of what was left out before, with times shifted
  /// like the events'.
  [[nodiscard]] DecodeSummary summary() const;

 private:
  [[nodiscard]] Result<bool> read_one_clock(EventBatch& batch, size_t max_events);
  [[nodiscard]] Result<void> join_part(int64_t first_us);
  [[nodiscard]] Result<bool> refill_pending(size_t max_events);
  [[nodiscard]] Result<void> find_shift();
  [[nodiscard]] int64_t in_range(int64_t t_us) const;
  [[nodiscard]] Result<void> begin_at(int64_t absolute_us);
  [[nodiscard]] Result<void> skip_to(int64_t absolute_us);
  void end_at(int64_t absolute_us, EventBatch& batch);
  [[nodiscard]] Result<void> apply_policy();
  [[nodiscard]] DecodeSummary left_out_before() const;
  void pass_over_cut(const DecodeSummary& before);
  void count(const EventColumns& events);

  OpenOptions options_;
  RecordingInfo info_;
  std::string name_;
  Timeline timeline_;
  DecodeSummary summary_;  ///< its times are absolute
  std::vector<std::function<DecodeSummary()>> losses_before_;
  PendingBatch pending_;                        ///< read but not yet returned, with absolute times
  bool has_begun_ = false, has_ended_ = false;  ///< options_.from_us or to_us was reached
  std::optional<Restart> joint_;                ///< before what comes next, if that is earlier
  int64_t part_shift_us_ = 0;                   ///< added to the times of timeline_
  bool is_first_part_ = true;
  bool has_restarted_ = false;       ///< seeking must then begin at the start
  bool is_between_parts_ = false;    ///< pending_ contains data of the next part
  std::optional<int64_t> shift_us_;  ///< subtracted from times; unknown until the first event under TimeOrigin::kZero
  int64_t range_origin_us_ = 0;      ///< the origin of from_us and to_us
  std::array<uint64_t, kNumViolations> known_violations_{};
};

/// Writes a recording from front to back. create_recording() creates writers. If a writer is destroyed before finish(),
/// no file appears.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;

  /// Returns whether the format can hold triggers; otherwise write() drops them.
  [[nodiscard]] virtual bool holds_triggers() const = 0;

  /// Appends events and triggers. Fails with kInvalidValue (an event outside the sensor, times that decrease within the
  /// batch or since the last one, or times beyond the range of the format) and kIo.
  [[nodiscard]] virtual Result<void> write(const EventBatch& batch) = 0;

  /// Completes the file and moves it to its path. Fails with kIo.
  [[nodiscard]] virtual Result<void> finish() = 0;
};

using ReaderPtr = std::unique_ptr<RecordingReader>;
using WriterPtr = std::unique_ptr<RecordingWriter>;

/// Opens a recording. Fails with kNotFound, kFormat (not a recording, or one whose header contradicts itself),
/// kUnsupported (a known format that cannot be read) and kInvalidValue (unknown options.format).
[[nodiscard]] Result<ReaderPtr> open_recording(const std::filesystem::path& path, const OpenOptions& options = {});
[[nodiscard]] Result<ReaderPtr> open_recording(SourcePtr source, const OpenOptions& options = {});

/// Creates a recording. If `format` is empty, the extension of the path selects it; .raw keeps info.format if that is a
/// RAW encoding, and is EVT3 otherwise. `info` provides the sensor size and header keys. An existing file is replaced
/// at finish(). Fails with kInvalidValue (unknown format, or missing or unsuitable size) and kIo.
[[nodiscard]] Result<WriterPtr> create_recording(const std::filesystem::path& path, const std::string& format,
                                                 const RecordingInfo& info);

/// Creates a recording in any sink. Fails with kUnsupported for formats that require a file (HDF5).
[[nodiscard]] Result<WriterPtr> create_recording(SinkPtr sink, const std::string& format, const RecordingInfo& info);

/// Reads the whole recording into one batch, for tests and small files.
[[nodiscard]] Result<EventBatch> read_all(RecordingReader& reader);

}  // namespace e2lf::recordings
