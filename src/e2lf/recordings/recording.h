// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/byte_sink.h"
#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/io/decode_summary.h"
#include "e2lf/recordings/pending_batch.h"
#include "e2lf/recordings/restart.h"

namespace e2lf::recordings {

/// What a file does not say and was taken for granted, for people, and the setting that says otherwise.
struct Assumption {
  std::string text;
  Setting setting = Setting::kNone;
};

/// How a table of events (text, numpy arrays, HDF5 columns) was read.
struct TableReading {
  std::string columns;    ///< "t, x, y, p": in the order of the file, or "x, y, p, t" of columns with names
  std::string time_unit;  ///< "s", "ms", "us" or "ns"
  std::string polarity;   ///< "0 = OFF, 1 = ON"
};

/// What a recording says of itself.
struct RecordingInfo {
  std::string format;  ///< the codec: "evt2", "evt2.1", "evt3", "dat", "hdf5", "aedat4", "csv", ...
  size_t width = 0;    ///< of the sensor, in pixels; 0 = the file does not say
  size_t height = 0;
  std::vector<std::pair<std::string, std::string>> header;  ///< keys and values in the file's order
  std::vector<Assumption> assumptions = {};
  std::vector<std::string> streams = {};   ///< of events, where the format may hold several: "0 (events of DAVIS346)"
  std::optional<TableReading> table = {};  ///< of tables only

  /// The value of a header key, or nothing.
  [[nodiscard]] std::optional<std::string> find(const std::string& key) const;
};

enum class TimeOrigin {
  kAbsolute,  ///< the sensor's own clock
  kZero,      ///< the first event or trigger of the recording is at 0; events and triggers are shifted alike
};

/// What the times of a table count.
enum class TimeUnit {
  kAuto,  ///< as names and headers say, else microseconds where times are whole numbers, else seconds
  kSeconds,
  kMilliseconds,
  kMicroseconds,
  kNanoseconds,
};

struct OpenOptions {
  std::string format = {};                      ///< empty = found by content first, by extension second
  DecodePolicy policy = DecodePolicy::kReport;  ///< what to do about damage
  TimeOrigin time = TimeOrigin::kAbsolute;
  size_t width = 0;  ///< sensor size for files that do not say; a file that says otherwise is kInvalidValue
  size_t height = 0;
  TimeUnit time_unit = TimeUnit::kAuto;  ///< of tables; kInvalidValue for formats that have a unit of their own
  std::string columns = {};  ///< of tables, as "txyp", "-" = to be passed over; empty = found by names and values
  std::string stream = {};   ///< number or name of a stream of events, where there are several
  int threads = 1;           ///< for one read() call; 0 = all cores
  RestartPolicy restart = RestartPolicy::kContinue;
  bool counts_reports = false;  ///< sum what the sensor counted itself (DecodeSummary::sensor_events_in); takes time

  /// read() hands out from_us <= t < to_us only: times of the sensor's clock, whatever `time` is, or under kZero of
  /// `range` since the first event or trigger of the recording. A file is sought, a stream is skipped.
  int64_t from_us = INT64_MIN;
  int64_t to_us = INT64_MAX;
  TimeOrigin range = TimeOrigin::kAbsolute;
};

/// Reads a recording from front to back in bounded memory. Made by open_recording(). The public functions are the same
/// for all formats; a format implements read_next() and what else it can do well.
class RecordingReader {
 public:
  static constexpr size_t kDefaultBatch = size_t{1} << 18;
  static constexpr size_t kMinBatch = 64;

  explicit RecordingReader(const OpenOptions& options) : options_(options) {}
  virtual ~RecordingReader() = default;
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  [[nodiscard]] const RecordingInfo& info() const { return info_; }
  [[nodiscard]] const OpenOptions& options() const { return options_; }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< of the source, for messages

  /// Replaces `batch` by the next events and triggers, at most `max_events` (>= kMinBatch) of each; a live source gives
  /// what has arrived. False (and an empty batch) at the end. Fails with kIo and, under the strict policy, with the
  /// first violation. Where a stop was asked for, an end inside a word is none.
  [[nodiscard]] Result<bool> read(EventBatch& batch, size_t max_events = kDefaultBatch);

  /// Tells that events with begin_us <= t < end_us (times as read() gives them) are not needed. A format that decodes
  /// faster without them leaves out those that it has not decoded yet, as many as is cheap; triggers are always given
  /// out. The span holds until another one is given, or until seek().
  void skip_events(int64_t begin_us, int64_t end_us);

  /// Goes to the first event or trigger with t >= t_us, forwards or backwards; starts the summary anew.
  /// Fails with kUnsupported where the source cannot be sought.
  [[nodiscard]] Result<void> seek(int64_t t_us);

  /// Under RestartPolicy::kSplit read() ends where the clock starts again: goes on to the part behind, which has its
  /// own times, and starts the summary anew. False where the recording itself has ended. Fails as read() does.
  [[nodiscard]] Result<bool> next_part();

  /// When the newest bytes behind what was handed out arrived at this host; nothing for what is not live.
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return std::nullopt; }

  /// What was left out before the bytes came to this reader; see Camera::left_out().
  [[nodiscard]] virtual DecodeSummary left_out_before() const;

  /// Tells of the container that holds the recording which this reader reads: its format, header, streams and
  /// assumptions in place of the recording's own.
  void take_container(RecordingInfo info) { info_ = std::move(info); }

  /// Counts among that what a source counts that stays alive elsewhere: it unpacks the bytes of this reader.
  void count_losses_of(std::shared_ptr<const DecodeSummary> losses) { losses_of_source_ = std::move(losses); }

  /// What was met in what read() has handed out; times are shifted as theirs. What was left out
  /// before counts too.
  [[nodiscard]] DecodeSummary summary() const;

 protected:
  /// Appends the next events and triggers, absolute in time, at most `max_events` of each. False when there is no more.
  /// Counts violations in summary_; events and triggers are counted by the caller.
  [[nodiscard]] virtual Result<bool> read_next(EventBatch& batch, size_t max_events) = 0;

  /// skip_events() in the times of read_next(). The default leaves out nothing.
  virtual void skip_decoding(int64_t /*begin_us*/, int64_t /*end_us*/) {}

  /// For read_next(), with nothing appended yet: what it appends from here on is from a clock that may have started
  /// again. `byte` is where, `before_us` the last time in front of it.
  void begin_part(uint64_t byte, int64_t before_us) { joint_ = Restart{byte, before_us}; }

  /// Goes to a place at or before the first event with t >= t_us (absolute), as near as is cheap; the start will do. It
  /// lies in front of the first restart.
  [[nodiscard]] virtual Result<void> seek_before(int64_t t_us);

  OpenOptions options_;
  RecordingInfo info_;
  DecodeSummary summary_;           ///< absolute times
  std::string name_ = "recording";  ///< of the source, for messages

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
  void pass_over_cut();
  void count(const EventColumns& events, size_t begin, size_t end);

  std::shared_ptr<const DecodeSummary> losses_of_source_;
  PendingBatch pending_;                        ///< read but not yet handed out, absolute in time
  bool has_begun_ = false, has_ended_ = false;  ///< options_.from_us and to_us were met
  std::optional<Restart> joint_;                ///< in front of what comes next, if that is earlier
  int64_t part_shift_us_ = 0;                   ///< added to what read_next() gives
  bool is_first_part_ = true;
  bool has_restarted_ = false;       ///< so that times behind that are sought from the start
  bool is_between_parts_ = false;    ///< what pending_ holds is of the next part
  std::optional<int64_t> shift_us_;  ///< what to subtract; unknown until the first event under TimeOrigin::kZero
  int64_t range_origin_us_ = 0;      ///< what from_us and to_us count from
  std::array<uint64_t, kNumViolations> known_violations_{};
};

/// Writes a recording front to back. Made by create_recording(). Destroyed without finish(), nothing appears.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;

  /// Whether the format can hold triggers; write() drops them otherwise.
  [[nodiscard]] virtual bool holds_triggers() const = 0;

  /// Whether t comes back as written; a format that starts at 0 is false.
  [[nodiscard]] virtual bool holds_absolute_time() const { return true; }

  /// Appends events and triggers. Fails with kInvalidValue for an event outside the sensor, time that runs backwards
  /// (within the batch or against the batches before) or time beyond the format's range, and with kIo.
  [[nodiscard]] virtual Result<void> write(const EventBatch& batch) = 0;

  /// Ends the file and puts it in place. Fails with kIo.
  [[nodiscard]] virtual Result<void> finish() = 0;
};

/// Opens a recording. Fails with kNotFound, kFormat (not a recording, or one whose header contradicts itself),
/// kUnsupported (a format we know but do not read) and kInvalidValue (unknown options.format).
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_recording(const std::filesystem::path& path,
                                                                      const OpenOptions& options = {});
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_recording(std::unique_ptr<ByteSource> source,
                                                                      const OpenOptions& options = {});

/// Starts a recording; `format` empty = by the path's extension (.raw keeps info.format where that is a RAW encoding,
/// otherwise EVT3). info gives the size and header keys. An existing file is replaced at finish().
/// Fails with kInvalidValue (unknown format or size) and kIo.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_recording(const std::filesystem::path& path,
                                                                        const std::string& format,
                                                                        const RecordingInfo& info);

/// The same into any sink; formats that need a file of their own (HDF5) are kUnsupported.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_recording(std::unique_ptr<ByteSink> sink,
                                                                        const std::string& format,
                                                                        const RecordingInfo& info);

/// The whole recording in one batch, for tests and small files.
[[nodiscard]] Result<EventBatch> read_all(RecordingReader& reader);

}  // namespace e2lf::recordings
