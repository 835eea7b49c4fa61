// SPDX-License-Identifier: MIT
#include "e2lf/video/frame_tone.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2lf/base/contract.h"

namespace e2lf::video {
namespace {

/// Maps the values at two quantiles to 0 and 1.
void stretch(std::span<float> frame, double low_share, double high_share) {
  std::vector<float> sorted(frame.begin(), frame.end());
  const float low = quantile(sorted, low_share), high = quantile(sorted, high_share);
  const float scale = high > low ? 1.0F / (high - low) : 0.0F;
  for (float& value : frame) value = (value - low) * scale;
}

}  // namespace

float quantile(std::span<float> values, double share) {
  E2LF_REQUIRE(!values.empty() && share >= 0.0 && share <= 1.0, "a quantile needs values and a share");
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(place);
  const auto at = values.begin() + static_cast<ptrdiff_t>(below);
  std::nth_element(values.begin(), at, values.end());
  if (below + 1 == values.size()) return *at;
  const float above = *std::min_element(at + 1, values.end());
  return *at + static_cast<float>(place - static_cast<double>(below)) * (above - *at);
}

void apply_frame_tone(FrameTone tone, std::span<float> frame) {
  constexpr double kRobustShare = 0.01;
  if (frame.empty()) return;
  switch (tone) {
    case FrameTone::kNone:
      break;
    case FrameTone::kExpRobust:
      for (float& value : frame) value = std::exp(value);
      stretch(frame, kRobustShare, 1.0 - kRobustShare);
      break;
    case FrameTone::kRobust:
      stretch(frame, kRobustShare, 1.0 - kRobustShare);
      break;
    case FrameTone::kStandard:
      stretch(frame, 0.0, 1.0);
      break;
  }
  for (float& value : frame) value = std::clamp(value, 0.0F, 1.0F);
}

}  // namespace e2lf::video
