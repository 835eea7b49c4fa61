// SPDX-License-Identifier: MIT
#include "e2lf/cycles/pixel_filter.h"

#include "e2lf/base/contract.h"

namespace e2lf::cycles {
namespace {

/// Fewer quiet events than this are not significant.
constexpr float kMinCount = 3;

}  // namespace

PixelFilter::PixelFilter(size_t width, size_t height, const PixelFilterOptions& options)
    : options_(options), width_(width), height_(height), counts_(width * height) {}

void PixelFilter::add_quiet_events(const recordings::EventColumns& events, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) {
    if (events.x[i] < width_ && events.y[i] < height_) counts_[events.y[i] * width_ + events.x[i]] += 1;
  }
}

void PixelFilter::add_quiet_time(int64_t duration_us) {
  quiet_s_ += static_cast<double>(duration_us) * 1e-6;
  // Older counts fade: at most memory_s of time is kept, and the counts are reduced in proportion.
  const double kept = quiet_s_ > options_.memory_s ? options_.memory_s / quiet_s_ : 1;
  quiet_s_ *= kept;
  silenced_.clear();
  for (size_t i = 0; i < counts_.size(); ++i) {
    counts_[i] *= static_cast<float>(kept);
    if (counts_[i] >= kMinCount && counts_[i] > options_.max_quiet_rate_hz * quiet_s_) silenced_.push_back(i);
  }
}

void PixelFilter::apply(capture::EventImages& images) const {
  E2LF_REQUIRE(images.image_size() == counts_.size(), "images of another size than the sensor's");
  for (const size_t pixel : silenced_) {
    for (size_t k = 0; k < images.count; ++k) images.image(k)[pixel] = 0;
  }
}

}  // namespace e2lf::cycles
