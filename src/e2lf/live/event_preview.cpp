// SPDX-License-Identifier: MIT
#include "e2lf/live/event_preview.h"

#include <algorithm>
#include <cstdlib>

namespace e2lf::live {
namespace {

/// Returns the count that is displayed as white: the 99.5th percentile of the nonzero counts, at least 1.
int white_count(const std::vector<uint16_t>& all) {
  constexpr size_t kMostCount = 255;
  std::vector<size_t> pixels(kMostCount + 1);
  size_t lit = 0;
  for (const uint16_t count : all) {
    ++pixels[std::min<size_t>(count, kMostCount)];
    lit += count > 0 ? 1 : 0;
  }
  size_t above = 0, count = kMostCount;
  while (count > 1 && above + pixels[count] <= lit / 200) above += pixels[count--];
  return static_cast<int>(count);
}

}  // namespace

double sharpness_of(std::span<const int16_t> signed_counts, size_t width, uint64_t events) {
  const size_t height = width == 0 ? 0 : signed_counts.size() / width;
  if (events == 0 || width < 2 || height < 2) return 0;
  int64_t sum = 0;
  for (size_t y = 0; y + 1 < height; ++y) {
    const int16_t* const upper = signed_counts.data() + y * width;
    const int16_t* const lower = upper + width;
    for (size_t x = 0; x + 1 < width; ++x) {
      sum += static_cast<int64_t>(upper[x + 1] - upper[x]) * (lower[x + 1] - lower[x]);
      sum += static_cast<int64_t>(lower[x] - upper[x]) * (lower[x + 1] - upper[x + 1]);
    }
  }
  const double product = static_cast<double>(sum) / static_cast<double>(2 * (width - 1) * (height - 1));
  const double mean = static_cast<double>(events) / static_cast<double>(signed_counts.size());
  return std::max(0.0, product / (mean * mean));
}

double sharpness_of(const capture::EventImages& images) {
  const size_t pixels = images.height * images.width;
  double sum = 0, weights = 0;
  for (size_t i = 0; i < images.count; ++i) {
    const auto image = std::span<const int16_t>(images.values).subspan(i * pixels, pixels);
    uint64_t events = 0;
    for (const int16_t count : image) events += static_cast<uint64_t>(std::abs(count));
    const double weight = static_cast<double>(events) * static_cast<double>(events);
    sum += weight * sharpness_of(image, images.width, events);
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

void EventPreview::add(const recordings::EventBatch& batch) {
  const recordings::EventColumns& events = batch.events;
  if (events.empty()) return;
  const std::lock_guard lock(mutex_);
  if (!asked_ || finished_) return;
  if (signed_.empty()) {
    signed_.resize(width_ * height_);
    all_.resize(width_ * height_);
  }
  if (!begin_us_) begin_us_ = events.t.front();
  for (size_t i = 0; i < events.size() && events.t[i] < *begin_us_ + kWindowUs; ++i) {
    if (events.x[i] >= width_ || events.y[i] >= height_) continue;
    const size_t pixel = events.y[i] * width_ + events.x[i];
    if (all_[pixel] == INT16_MAX) continue;
    ++all_[pixel];
    signed_[pixel] = static_cast<int16_t>(signed_[pixel] + (events.p[i] != 0 ? 1 : -1));
    ++events_;
  }
  if (events.t.back() >= *begin_us_ + kWindowUs) finish();
}

void EventPreview::finish() {
  EventPicture picture;
  picture.image = lightfield::ByteImage(width_, height_, 1);
  picture.events = events_;
  picture.sharpness = sharpness_of(signed_, width_, events_);
  const int white = white_count(all_);
  for (size_t i = 0; i < signed_.size(); ++i) {
    picture.image.pixels[i] = static_cast<uint8_t>(std::clamp(128 + 127 * signed_[i] / white, 0, 255));
  }
  finished_ = std::move(picture);
  std::fill(signed_.begin(), signed_.end(), int16_t{0});
  std::fill(all_.begin(), all_.end(), uint16_t{0});
  begin_us_.reset();
  events_ = 0;
}

void EventPreview::add_cycle(uint64_t number, const capture::EventImages& images) {
  if (!is_asked()) return;
  const CycleSharpness cycle{number, sharpness_of(images)};
  const std::lock_guard lock(mutex_);
  cycle_ = cycle;
}

bool EventPreview::is_asked(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  return asked_ && now - *asked_ < kPatience;
}

std::optional<EventPicture> EventPreview::take(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  // A picture that was not taken for a long time is out of date.
  if (asked_ && now - *asked_ >= kPatience) finished_.reset();
  asked_ = now;
  if (finished_) finished_->cycle = cycle_;
  return std::exchange(finished_, std::nullopt);
}

}  // namespace e2lf::live
