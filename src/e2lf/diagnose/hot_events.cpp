// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/hot_events.h"

#include <algorithm>

#include "e2lf/base/text.h"

namespace e2lf::diagnose {
namespace {

constexpr size_t kMostSlices = 8, kFewestSlices = 3, kEventsPerPixel = 2;
constexpr size_t kMostPixels = size_t{1} << 22;

}  // namespace

bool are_many_hot(size_t hot, size_t pixels) {
  // docs/troubleshooting.md states how often these thresholds are wrong.
  constexpr size_t kLeastHot = 4;
  constexpr double kLeastShare = 3e-4;
  return hot >= kLeastHot && static_cast<double>(hot) >= kLeastShare * static_cast<double>(pixels);
}

HotEvents::HotEvents(size_t height, size_t width) : pixels_(height * width) {
  if (pixels_ > kMostPixels) pixels_ = 0;
  sums_.cycles = 1;
  sums_.counts.height = height;
  sums_.counts.width = width;
}

void HotEvents::add(const recordings::EventColumns& events) {
  Planes<int32_t>& counts = sums_.counts;
  if (pixels_ == 0) return;
  for (size_t i = 0; i < events.size();) {
    const bool is_full = counts.count == 0 || in_slice_ == kEventsPerPixel * pixels_;
    if (is_full && counts.count == kMostSlices) return;
    if (is_full) {
      counts.values.resize(++counts.count * pixels_);
      in_slice_ = 0;
    }
    int32_t* const slice = counts.image(counts.count - 1).data();
    const size_t end = i + std::min(events.size() - i, kEventsPerPixel * pixels_ - in_slice_);
    in_slice_ += end - i;
    for (; i < end; ++i) {
      if (events.x[i] < counts.width && events.y[i] < counts.height) ++slice[events.y[i] * counts.width + events.x[i]];
    }
  }
}

size_t HotEvents::count() const {
  capture::CountSums sums = sums_;
  if (in_slice_ < kEventsPerPixel * pixels_ && sums.counts.count > 0) --sums.counts.count;
  sums.counts.values.resize(sums.counts.count * pixels_);
  if (sums.counts.count < kFewestSlices) return 0;
  const size_t hot = capture::hot_pixels(sums).size();
  return are_many_hot(hot, pixels_) ? hot : 0;
}

std::optional<Finding> HotEvents::finding() const {
  const size_t hot = count();
  if (hot == 0) return std::nullopt;
  return Finding{
      "pixels-hot",
      Severity::kWarning,
      cat(hot, " pixels have far more events than their neighbours all the time"),
      "mask them in the camera, or give them the events of their neighbours by `e2lf reconstruct --filter-pixels`",
      {{"pixels", hot}}};
}

}  // namespace e2lf::diagnose
