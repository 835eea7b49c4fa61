// SPDX-License-Identifier: MIT
#include "e2lf/cycles/late_edges.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/median.h"

namespace e2lf::cycles {
namespace {

constexpr size_t kRemembered = 7;     // number of intervals whose median is the expected one
constexpr size_t kEnough = 3;         // with fewer, the schedule is used
constexpr double kLeastLateUs = 150;  // displays and clocks have a jitter of about 10 us
constexpr double kLeastShare = 0.02;  // relative to an interval

}  // namespace

LateEdgeFinder::LateEdgeFinder(const Schedule& schedule) : schedule_(schedule), intervals_us_(schedule.size()) {}

double LateEdgeFinder::expected_us(size_t pattern) const {
  const auto& known = intervals_us_[pattern];
  if (known.size() < kEnough) return static_cast<double>(schedule_.patterns[pattern].interval_us());
  return median(std::vector<double>(known.begin(), known.end()));
}

void LateEdgeFinder::learn(size_t pattern, double interval_us) {
  auto& known = intervals_us_[pattern];
  known.push_back(interval_us);
  if (known.size() > kRemembered) known.pop_front();
}

std::optional<LateEdge> LateEdgeFinder::add(const PatternStart& start) {
  if (start.kind != PatternStart::Kind::kSeen) {
    before_.reset();
    last_.reset();
    return std::nullopt;
  }
  std::optional<LateEdge> found;
  if (before_ && last_) {
    const double first_us = expected_us(before_->pattern), second_us = expected_us(last_->pattern);
    const double longer_us = static_cast<double>(last_->t_us - before_->t_us) - first_us;
    const double shorter_us = second_us - static_cast<double>(start.t_us - last_->t_us);
    const double late_us = 0.5 * (longer_us + shorter_us);
    const double least_us = std::max(kLeastLateUs, kLeastShare * std::min(first_us, second_us));
    if (std::abs(late_us) > least_us && std::abs(longer_us - shorter_us) < 0.5 * std::abs(late_us)) {
      found = LateEdge{0, last_->pattern, static_cast<int64_t>(std::llround(late_us))};
    }
  }
  if (last_) learn(last_->pattern, static_cast<double>(start.t_us - last_->t_us));
  before_ = last_;
  last_ = start;
  return found;
}

}  // namespace e2lf::cycles
