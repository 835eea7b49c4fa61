// SPDX-License-Identifier: MIT
// Sorts events whose times step back; declared in event_blocks.h.

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <unistd.h>
#include <utility>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kBufferedEvents = size_t{1} << 22;  // for all runs together during the merge
constexpr size_t kLeastBuffer = 256;                 // for one run

std::filesystem::path temporary_folder() {
  std::error_code error;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("/tmp") : folder;
}

Error io_error(const char* action) {
  return {ErrorCode::kIo,
          cat("cannot ", action, " the temporary file that sorts the events by time (", std::strerror(errno),
              "); free space there, or set TMPDIR to a folder with 16 bytes for each event"),
          temporary_folder().string()};
}

std::vector<Event> sorted_records(const EventColumns& events) {
  std::vector<Event> records(events.size());
  for (size_t i = 0; i < events.size(); ++i) records[i] = events[i];
  std::stable_sort(records.begin(), records.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
  return records;
}

/// Sorts events by time; the order of events with equal times is preserved.
void sort_by_time(EventColumns& events) {
  const std::vector<Event> records = sorted_records(events);
  for (size_t i = 0; i < records.size(); ++i) events.set(i, records[i]);
}

/// Sorts more events than memory should hold, with a temporary file that has no name: sorted runs are added and then
/// merged. Needs 16 bytes of disk space per event in TMPDIR or /tmp, which are released with the object or the process.
class SortedRuns {
 public:
  SortedRuns() = default;
  SortedRuns(const SortedRuns&) = delete;
  SortedRuns& operator=(const SortedRuns&) = delete;
  ~SortedRuns() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  /// Sorts the events and adds them as the next run. Fails with kIo.
  Result<void> add(EventColumns& events) {
    if (descriptor_ < 0) E2LF_RETURN_IF_ERROR(open_file());
    const std::vector<Event> records = sorted_records(events);
    const auto* next = reinterpret_cast<const uint8_t*>(records.data());
    auto offset = static_cast<off_t>(begins_.back() * sizeof(Event));
    for (size_t left = records.size() * sizeof(Event); left > 0;) {
      const ssize_t written = ::pwrite(descriptor_, next, left, offset);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return io_error("write");
      next += written;
      offset += written;
      left -= static_cast<size_t>(written);
    }
    begins_.push_back(begins_.back() + records.size());
    return {};
  }

  /// Starts merging from the first event; runs that are added later are not included.
  void rewind() { is_merging_ = false; }

  /// Replaces `events` by the next ones, at most `max_events`. Of events with equal times, those of earlier runs come
  /// first. Returns false when there are no more. Fails with kIo.
  Result<bool> next(EventColumns& events, size_t max_events) {
    if (!is_merging_) E2LF_RETURN_IF_ERROR(begin_merge());
    events.clear();
    while (events.size() < max_events && !heads_.empty()) {
      std::pop_heap(heads_.begin(), heads_.end(), std::greater<>());
      Head& head = heads_.back();
      Run& run = runs_[head.run];
      events.push_back(run.buffer[run.place++]);
      bool more = run.place < run.buffer.size();
      if (!more) {
        E2LF_ASSIGN_OR_RETURN(more, refill(run));
      }
      if (!more) {
        heads_.pop_back();
        continue;
      }
      head.t_us = run.buffer[run.place].t;
      std::push_heap(heads_.begin(), heads_.end(), std::greater<>());
    }
    return !events.empty();
  }

 private:
  /// The remainder of a run, and the part of it in memory.
  struct Run {
    uint64_t next = 0, end = 0;  ///< indices of events in the file
    std::vector<Event> buffer;
    size_t place = 0;
  };
  /// The position of the next event of a run in the overall order.
  struct Head {
    int64_t t_us = 0;
    size_t run = 0;
    bool operator>(const Head& other) const { return t_us != other.t_us ? t_us > other.t_us : run > other.run; }
  };

  Result<void> open_file() {
    std::string name = (temporary_folder() / "e2lf_sort_XXXXXX").string();
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) return io_error("make");
    ::unlink(name.c_str());
    return {};
  }

  /// Reads the next events of a run into memory; returns false at its end.
  Result<bool> refill(Run& run) {
    const size_t share = std::max(kLeastBuffer, kBufferedEvents / runs_.size());
    const auto count = static_cast<size_t>(std::min<uint64_t>(share, run.end - run.next));
    run.buffer.resize(count);
    run.place = 0;
    auto* next = reinterpret_cast<uint8_t*>(run.buffer.data());
    auto offset = static_cast<off_t>(run.next * sizeof(Event));
    for (size_t left = count * sizeof(Event); left > 0;) {
      const ssize_t got = ::pread(descriptor_, next, left, offset);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return io_error("read");
      next += got;
      offset += got;
      left -= static_cast<size_t>(got);
    }
    run.next += count;
    return count > 0;
  }

  Result<void> begin_merge() {
    runs_.assign(begins_.size() - 1, Run());
    heads_.clear();
    for (size_t i = 0; i < runs_.size(); ++i) {
      runs_[i].next = begins_[i];
      runs_[i].end = begins_[i + 1];
      E2LF_ASSIGN_OR_RETURN(const bool more, refill(runs_[i]));
      if (more) heads_.push_back({runs_[i].buffer.front().t, i});
    }
    std::make_heap(heads_.begin(), heads_.end(), std::greater<>());
    is_merging_ = true;
    return {};
  }

  int descriptor_ = -1;
  std::vector<uint64_t> begins_ = {0};  ///< begin of each run in events, and the end of the last
  std::vector<Run> runs_;               ///< while merging
  std::vector<Head> heads_;             ///< a heap, the earliest in front
  bool is_merging_ = false;
};

constexpr size_t kBlockEvents = size_t{1} << 17;

/// Counts events that are earlier than a preceding one.
class OrderCounter {
 public:
  void add(const Column<int64_t>& times_us) {
    for (const int64_t t_us : times_us) {
      late_ += t_us < latest_us_;
      latest_us_ = std::max(latest_us_, t_us);
    }
  }
  [[nodiscard]] uint64_t late() const { return late_; }

 private:
  int64_t latest_us_ = INT64_MIN;
  uint64_t late_ = 0;
};

/// Sorts a source that cannot be read twice: the latest events are buffered, so that earlier ones can precede them.
class SortedPipe final : public EventBlocks {
 public:
  SortedPipe(BlocksPtr blocks, std::string name, size_t window)
      : blocks_(std::move(blocks)), name_(std::move(name)), window_(window) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    const uint64_t known = order_.late();
    order_.add(block.events.t);
    summary.out_of_order += order_.late() - known;
    waiting_.append(block.events);
    if (order_.late() > known) sort_by_time(waiting_);
    if (!waiting_.empty() && waiting_.t.front() < handed_out_us_) return too_late();
    const size_t wait = more ? std::min(window_, waiting_.size()) : 0;
    const size_t end = waiting_.size() - wait;
    block.events.clear();
    block.events.append(waiting_, 0, end);
    if (end > 0) handed_out_us_ = block.events.t.back();
    EventColumns rest;
    rest.append(waiting_, end, waiting_.size());
    std::swap(waiting_, rest);
    return more || end > 0;
  }

  std::span<const Restart> restarts() const override { return blocks_->restarts(); }

  Result<void> seek_before(int64_t t_us) override { return blocks_->seek_before(t_us); }

 private:
  [[nodiscard]] Error too_late() const {
    return {ErrorCode::kUnsupported,
            cat("an event is more than ", window_,
                " events late and cannot be sorted in a stream; write the events to a file first"),
            name_};
  }

  BlocksPtr blocks_;
  std::string name_;
  size_t window_;
  OrderCounter order_;
  EventColumns waiting_;
  int64_t handed_out_us_ = INT64_MIN;
};

/// Sorts a source that can be read twice. The first next() or seek_before() determines how.
class SortedFile final : public EventBlocks {
 public:
  SortedFile(BlocksPtr blocks, const TimeSortOptions& options) : blocks_(std::move(blocks)), options_(options) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_RETURN_IF_ERROR(prepare());
    if (way_ == Way::kInOrder) return blocks_->next(block, summary);
    block.clear();
    if (!std::exchange(has_begun_, true)) {
      summary.append(found_);
      block.triggers = triggers_;
    }
    if (way_ == Way::kFile) return runs_.next(block.events, kBlockEvents);
    const size_t end = std::min(memory_.size(), next_ + kBlockEvents);
    block.events.append(memory_, next_, end);
    return std::exchange(next_, end) < end;
  }

  std::span<const Restart> restarts() const override { return blocks_->restarts(); }

  Result<void> seek_before(int64_t t_us) override {
    E2LF_RETURN_IF_ERROR(prepare());
    if (way_ == Way::kInOrder) return blocks_->seek_before(t_us);
    has_begun_ = false;
    runs_.rewind();
    next_ = static_cast<size_t>(std::lower_bound(memory_.t.begin(), memory_.t.end(), t_us) - memory_.t.begin());
    return {};
  }

 private:
  enum class Way {
    kUnknown,
    kInOrder,  ///< the source is sorted already and is passed on
    kMemory,   ///< memory_ contains all events, sorted
    kFile,     ///< runs_ contains all events
  };

  Result<void> prepare() {
    if (way_ != Way::kUnknown) return {};
    E2LF_RETURN_IF_ERROR(look());
    if (way_ != Way::kUnknown) return {};
    // Too many for memory: events in order are read again, others are written to sorted runs.
    memory_ = {};
    triggers_.clear();
    E2LF_RETURN_IF_ERROR(blocks_->seek_before(INT64_MIN));
    if (order_.late() == 0) {
      way_ = Way::kInOrder;
      return {};
    }
    return write_runs();
  }

  /// Reads until the method is determined: to the end, or to the first event out of order after memory is full.
  Result<void> look() {
    EventBatch block;
    for (bool is_all_held = true;;) {
      E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, found_));
      order_.add(block.events.t);
      if (is_all_held) hold(block);
      if (!more && is_all_held) {
        if (order_.late() > 0) sort_by_time(memory_);
        found_.out_of_order = order_.late();
        way_ = Way::kMemory;
        return {};
      }
      is_all_held = is_all_held && memory_.size() <= options_.memory_events;
      if (!more || (!is_all_held && order_.late() > 0)) return {};
    }
  }

  Result<void> write_runs() {
    EventBatch block;
    order_ = {};
    found_ = {};
    for (bool more = true; more;) {
      E2LF_ASSIGN_OR_RETURN(more, blocks_->next(block, found_));
      order_.add(block.events.t);
      hold(block);
      if (memory_.size() < options_.memory_events && more) continue;
      E2LF_RETURN_IF_ERROR(runs_.add(memory_));
      memory_.clear();
    }
    memory_ = {};
    found_.out_of_order = order_.late();
    way_ = Way::kFile;
    return {};
  }

  void hold(const EventBatch& block) {
    memory_.append(block.events);
    triggers_.insert(triggers_.end(), block.triggers.begin(), block.triggers.end());
  }

  BlocksPtr blocks_;
  TimeSortOptions options_;
  Way way_ = Way::kUnknown;
  OrderCounter order_;
  DecodeSummary found_;  ///< summary of the first reading
  EventColumns memory_;
  size_t next_ = 0;  ///< index of the next event in memory_
  SortedRuns runs_;
  std::vector<Trigger> triggers_;
  bool has_begun_ = false;  ///< whether triggers and the summary were returned
};

}  // namespace

BlocksPtr make_time_sorted(BlocksPtr blocks, bool is_seekable, std::string name, const TimeSortOptions& options) {
  blocks = make_continued(std::move(blocks), EventOrder::kAny);
  if (is_seekable) return std::make_unique<SortedFile>(std::move(blocks), options);
  return std::make_unique<SortedPipe>(std::move(blocks), std::move(name), options.pipe_events);
}

}  // namespace e2lf::recordings
