// SPDX-License-Identifier: MIT
#include "e2lf/live/cycle_sum.h"

#include <algorithm>

#include "e2lf/base/contract.h"

namespace e2lf::live {

size_t CycleSum::add(capture::EventImages& images, size_t wanted) {
  E2LF_REQUIRE(wanted >= 1 && wanted <= kMostCycles, "the number of summed cycles must be from 1 to kMostCycles");
  if (wanted == 1 || sum_.size() != images.values.size()) {
    last_.clear();
    sum_.clear();
  }
  if (wanted == 1) return 1;
  sum_.resize(images.values.size());
  const auto apply = [this](const capture::EventImages& of, int sign) {
    for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += sign * of.values[i];
  };
  for (; last_.size() >= wanted; last_.pop_front()) apply(last_.front(), -1);
  apply(images, 1);
  last_.push_back(images);
  for (size_t i = 0; i < sum_.size(); ++i) images.values[i] = capture::saturated(sum_[i]);
  return last_.size();
}

}  // namespace e2lf::live
