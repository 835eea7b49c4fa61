// SPDX-License-Identifier: MIT
#include "e2lf/events/cycles/mark_signer.h"

#include <algorithm>
#include <cmath>

namespace e2lf::events {
namespace {

constexpr int64_t kBinUs = 100;

/// The start of the bin that a time lies in.
int64_t bin_of(int64_t t_us) {
  const int64_t remainder = t_us % kBinUs;
  return t_us - remainder - (remainder < 0 ? kBinUs : 0);
}

}  // namespace

void MarkSigner::add(const EventColumns& events, const std::vector<Mark>& marks) {
  marks_.insert(marks_.end(), marks.begin(), marks.end());
  for (size_t i = 0; i < events.size();) {
    const int64_t bin_us = bin_of(events.t[i]);
    Counts& counts = bins_[bin_us];
    for (; i < events.size() && events.t[i] < bin_us + kBinUs; ++i) ++(events.p[i] != 0 ? counts.on : counts.off);
  }
  if (!events.empty()) last_event_us_ = std::max(last_event_us_, events.t.back());
  forget();
}

std::optional<Mark> MarkSigner::take(bool needs_sign, bool is_end) {
  if (marks_.empty()) return std::nullopt;
  Mark mark = marks_.front();
  if (needs_sign) {
    if (!is_end && last_event_us_ < mark.t_us + options_.window_us + kBinUs) return std::nullopt;
    mark.on_share = on_share_at(mark.t_us);
  }
  marks_.pop_front();
  return mark;
}

MarkSigner::Counts MarkSigner::count(int64_t begin_us, int64_t end_us) const {
  Counts sum;
  for (auto bin = bins_.lower_bound(begin_us); bin != bins_.end() && bin->first < end_us; ++bin) {
    sum.on += bin->second.on;
    sum.off += bin->second.off;
  }
  return sum;
}

/// The share of ON in what rises at a time; nothing where chance may have made it.
std::optional<float> MarkSigner::on_share_at(int64_t t_us) const {
  const int64_t begin_us = bin_of(t_us);
  const Counts before = count(begin_us - options_.window_us, begin_us);
  const Counts after = count(begin_us, begin_us + options_.window_us);
  const double on_rise = std::max(0.0, static_cast<double>(after.on) - before.on);
  const double off_rise = std::max(0.0, static_cast<double>(after.off) - before.off);
  const double all = static_cast<double>(before.on) + before.off + after.on + after.off;
  if (on_rise + off_rise < options_.min_significance * std::sqrt(all + 1)) return std::nullopt;
  return static_cast<float>(on_rise / (on_rise + off_rise));
}

/// Drops the bins that no trigger to come can be compared with.
void MarkSigner::forget() {
  const int64_t needed_us = std::min(known_until(last_event_us_), last_event_us_) - 2 * options_.window_us;
  bins_.erase(bins_.begin(), bins_.lower_bound(needed_us));
}

}  // namespace e2lf::events
