// SPDX-License-Identifier: MIT
#include "e2lf/recordings/time_sort.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/recordings/continued_clock.h"
#include "e2lf/recordings/sorted_runs.h"

namespace e2lf::recordings {
namespace {

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
