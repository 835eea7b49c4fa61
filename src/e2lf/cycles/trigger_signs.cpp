// SPDX-License-Identifier: MIT
#include "e2lf/cycles/trigger_signs.h"

namespace e2lf::cycles {

void TriggerSigns::add(const recordings::EventColumns& events, const std::vector<Mark>& marks) {
  marks_.insert(marks_.end(), marks.begin(), marks.end());
  histogram_.add(events, 0, events.size());
  if (!events.empty()) {
    first_event_us_ = std::min(first_event_us_, events.t.front());
    last_event_us_ = std::max(last_event_us_, events.t.back());
  }
  forget();
}

std::optional<Mark> TriggerSigns::take(bool needs_sign, bool is_end) {
  if (marks_.empty()) return std::nullopt;
  Mark mark = marks_.front();
  if (needs_sign) {
    if (!is_end && last_event_us_ < mark.t_us + options_.window_us + EventHistogram::kBinUs) return std::nullopt;
    mark.on_share = on_share_at(mark.t_us);
  }
  marks_.pop_front();
  return mark;
}

/// Returns the share of ON in the rise at a time. Returns nothing if chance may have caused it, or at the beginning of
/// the recording, where the first events of the pixels are not informative.
std::optional<float> TriggerSigns::on_share_at(int64_t t_us) const {
  if (t_us - options_.window_us < first_event_us_) return std::nullopt;
  const EventRise rise = event_rise(histogram_, t_us, options_.window_us);
  if (rise.significance < options_.min_significance) return std::nullopt;
  return static_cast<float>(rise.on / rise.total());
}

/// Drops the bins that are not needed for future triggers.
void TriggerSigns::forget() {
  const int64_t needed_us = std::min(known_until(last_event_us_), last_event_us_) - 2 * options_.window_us;
  histogram_.forget_before(needed_us);
}

}  // namespace e2lf::cycles
