// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/table_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/table/time_units.h"

namespace e2lf::recordings::table {
namespace {

/// Drops the unused rows of a table.
class UsedRows final : public EventBlocks {
 public:
  UsedRows(BlocksPtr blocks, int64_t zero_us) : blocks_(std::move(blocks)), zero_us_(zero_us) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    const EventColumns& events = block.events;
    const auto is_zero = [&](size_t i) {
      return events.t[i] == zero_us_ && events.x[i] == 0 && events.y[i] == 0 && events.p[i] == 0;
    };
    bool has_zeros = zeros_ > 0;
    for (size_t i = 0; i < events.size() && !has_zeros; ++i) has_zeros = is_zero(i);
    if (has_zeros) {
      used_.clear();
      for (size_t i = 0; i < events.size(); ++i) {
        if (is_zero(i) && has_begun_) {
          ++zeros_;
          continue;
        }
        end_run(summary);
        used_.push_back(events[i]);
        has_begun_ |= events.t[i] > zero_us_;
      }
      if (!more) end_run(summary);
      std::swap(block.events, used_);
    } else if (!events.empty()) {
      has_begun_ |= events.t.back() > zero_us_;
    }
    return more || !block.empty();
  }

  [[nodiscard]] uint64_t block_byte() const override { return blocks_->block_byte(); }
  [[nodiscard]] size_t event_bytes() const override { return blocks_->event_bytes(); }

  Result<void> seek_before(int64_t t_us) override {
    zeros_ = 0;
    has_begun_ = false;
    return blocks_->seek_before(t_us);
  }

 private:
  /// A few such rows may be events of a clock that starts again.
  static constexpr uint64_t kMostEvents = 7;

  void end_run(DecodeSummary& summary) {
    if (zeros_ > kMostEvents) {
      summary.add(Violation::kZeros, blocks_->block_byte(), zeros_);
      zeros_ = 0;
    }
    for (; zeros_ > 0; --zeros_) used_.push_back({0, 0, 0, zero_us_});
  }

  BlocksPtr blocks_;
  int64_t zero_us_;
  EventColumns used_;
  uint64_t zeros_ = 0;      ///< number of rows of zeros that were withheld
  bool has_begun_ = false;  ///< whether a later time preceded
};

/// Unwraps times of a signed or unsigned 32-bit clock that counts `unit`. A decrease by more than three quarters of its
/// range is a wrap (DecodeSummary::time_loops), and an increase by as much after a wrap is a late event. Other times
/// are unchanged. Seeking behind a wrap goes to the first block.
class UnwrappedBlocks final : public EventBlocks {
 public:
  UnwrappedBlocks(BlocksPtr blocks, TimeUnit unit)
      : blocks_(std::move(blocks)),
        is_ns_(unit == TimeUnit::kNanoseconds),
        us_per_unit_(std::max<int64_t>(1, std::llround(us_per(unit)))) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    for (int64_t& t_us : block.events.t) {
      const int64_t loops = loops_at(is_ns_ ? t_us : t_us / us_per_unit_, summary);
      if (loops != 0 && is_time(t_us)) t_us += is_ns_ ? loops * kCircle / 1000 : loops * kCircle * us_per_unit_;
    }
    return more;
  }

  Result<void> seek_before(int64_t t_us) override {
    last_.reset();
    loops_ = 0;
    return blocks_->seek_before(has_wrapped_ ? INT64_MIN : t_us);
  }

 private:
  static constexpr int64_t kCircle = int64_t{1} << 32;
  static constexpr int kMaxOdd = 16;

  /// In the units of the times; nanoseconds are in whole microseconds.
  [[nodiscard]] int64_t circle() const { return is_ns_ ? kCircle / 1000 : kCircle; }

  /// Returns how often the clock has wrapped around before a time.
  int64_t loops_at(int64_t time, DecodeSummary& summary) {
    if (time < -circle() / 2 || time > circle()) return loops_;  // not of 32 bits
    if (!last_) last_ = time;
    const int64_t step = time - *last_, quarter = circle() / 4;
    if (std::abs(step) <= quarter || step < -3 * quarter) {
      if (step < -3 * quarter) {
        ++loops_;
        ++summary.time_loops;
        has_wrapped_ = true;
      }
      last_ = time;
      odd_ = 0;
      return loops_;
    }
    if (step > 3 * quarter && loops_ > 0) return loops_ - 1;
    // Damage, or a pause if many times agree.
    if (++odd_ == kMaxOdd) last_.reset();
    return loops_;
  }

  BlocksPtr blocks_;
  bool is_ns_;
  int64_t us_per_unit_;
  std::optional<int64_t> last_;
  int64_t loops_ = 0;
  int odd_ = 0;
  bool has_wrapped_ = false;
};

constexpr size_t kMostLone = 9;
constexpr size_t kLeastOthers = 100;
constexpr int64_t kApart = 100, kLeastGapUs = 1'000'000;

bool is_apart(int64_t gap_us, int64_t others_us) {
  return gap_us > kLeastGapUs && gap_us / kApart > others_us;
}

double seconds(int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

/// Warns at the end of blocks, which must be in order of time, about implausible times: if up to nine events at the
/// beginning or the end are separated from all others by more than a hundred times the duration of these, as after
/// damage of a single time, or if all of a hundred events or more have the same time.
class ToldBlocks final : public EventBlocks {
 public:
  ToldBlocks(BlocksPtr blocks, std::string name) : blocks_(std::move(blocks)), name_(std::move(name)) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
    add(block.events.t);
    if (!more && !std::exchange(is_told_, true)) tell();
    return more;
  }

  [[nodiscard]] uint64_t block_byte() const override { return blocks_->block_byte(); }
  [[nodiscard]] size_t event_bytes() const override { return blocks_->event_bytes(); }

  Result<void> seek_before(int64_t t_us) override {
    is_told_ = true;  // because a part is not conclusive
    return blocks_->seek_before(t_us);
  }

 private:
  void add(const Column<int64_t>& times_us) {
    const size_t wanted = kMostLone + 1 - std::min(kMostLone + 1, first_us_.size());
    first_us_.insert(first_us_.end(), times_us.begin(),
                     times_us.begin() + static_cast<ptrdiff_t>(std::min(wanted, times_us.size())));
    const size_t late = std::min(kMostLone + 1, times_us.size());
    last_us_.insert(last_us_.end(), times_us.end() - static_cast<ptrdiff_t>(late), times_us.end());
    if (last_us_.size() > kMostLone + 1) last_us_.erase(last_us_.begin(), last_us_.end() - kMostLone - 1);
    count_ += times_us.size();
  }

  void tell() const {
    if (count_ < kLeastOthers) return;
    if (first_us_.front() == last_us_.back()) {
      log_warning(cat(name_, ": all ", count_, " events have the time ", first_us_.front(),
                      " us; check the unit of the times, and store them with more digits"));
    }
    size_t early = 0;
    for (size_t i = 0; i + 1 < first_us_.size(); ++i) {
      if (is_apart(first_us_[i + 1] - first_us_[i], last_us_.front() - first_us_[i + 1])) early = i + 1;
    }
    const int64_t begin_us = first_us_[early];
    if (early > 0) {
      log_warning(cat(name_, ": the first ", early, " of ", count_, " events are ",
                      seconds(begin_us - first_us_[early - 1]),
                      " s before the others; if their times are damaged, begin ", "at ", begin_us, " us (--from-us)"));
    }
    for (size_t i = 0; i + 1 < last_us_.size(); ++i) {
      const int64_t gap_us = last_us_[i + 1] - last_us_[i];
      if (!is_apart(gap_us, last_us_[i] - begin_us)) continue;
      log_warning(cat(name_, ": the last ", last_us_.size() - 1 - i, " of ", count_, " events are ", seconds(gap_us),
                      " s after the others, which take ", seconds(last_us_[i] - begin_us),
                      " s; if their times are damaged, end at ", last_us_[i] + 1, " us (--to-us)"));
      return;
    }
  }

  BlocksPtr blocks_;
  std::string name_;
  std::vector<int64_t> first_us_, last_us_;  ///< the times of the first and last events, kMostLone + 1 at most
  uint64_t count_ = 0;
  bool is_told_ = false;
};

}  // namespace

ReaderPtr make_table_reader(BlocksPtr blocks, TimeUnit unit, RecordingInfo info, const std::string& name,
                            const OpenOptions& options, TriggersPtr triggers, int64_t zero_us) {
  blocks = std::make_unique<UsedRows>(std::move(blocks), zero_us);
  blocks = std::make_unique<UnwrappedBlocks>(std::move(blocks), unit);
  const bool is_whole = options.from_us == INT64_MIN && options.to_us == INT64_MAX;
  if (is_whole) blocks = std::make_unique<ToldBlocks>(std::move(blocks), name);
  return make_block_reader(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings::table
