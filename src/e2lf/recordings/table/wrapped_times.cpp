// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/wrapped_times.h"

#include <cstdlib>
#include <optional>

namespace e2lf::recordings::table {
namespace {

class UnwrappedBlocks final : public EventBlocks {
 public:
  UnwrappedBlocks(std::unique_ptr<EventBlocks> blocks, TimeUnit unit)
      : blocks_(std::move(blocks)), is_ns_(unit == TimeUnit::kNanoseconds), us_per_unit_(us_per(unit)) {}

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

  static int64_t us_per(TimeUnit unit) {
    return unit == TimeUnit::kSeconds ? 1'000'000 : unit == TimeUnit::kMilliseconds ? 1000 : 1;
  }

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

  std::unique_ptr<EventBlocks> blocks_;
  bool is_ns_;
  int64_t us_per_unit_;
  std::optional<int64_t> last_;
  int64_t loops_ = 0;
  int odd_ = 0;
  bool has_wrapped_ = false;
};

}  // namespace

std::unique_ptr<EventBlocks> make_unwrapped(std::unique_ptr<EventBlocks> blocks, TimeUnit unit) {
  return std::make_unique<UnwrappedBlocks>(std::move(blocks), unit);
}

}  // namespace e2lf::recordings::table
