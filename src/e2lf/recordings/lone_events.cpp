// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kMostLone = 9;
constexpr size_t kLeastOthers = 100;
constexpr int64_t kApart = 100, kLeastGapUs = 1'000'000;

bool is_apart(int64_t gap_us, int64_t others_us) {
  return gap_us > kLeastGapUs && gap_us / kApart > others_us;
}

double seconds(int64_t us) {
  return static_cast<double>(us) * 1e-6;
}

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
  [[nodiscard]] std::span<const Restart> restarts() const override { return blocks_->restarts(); }

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

BlocksPtr make_lone_events_told(BlocksPtr blocks, std::string name, const OpenOptions& options) {
  if (options.from_us != INT64_MIN || options.to_us != INT64_MAX) return blocks;
  return std::make_unique<ToldBlocks>(std::move(blocks), std::move(name));
}

}  // namespace e2lf::recordings
