// SPDX-License-Identifier: MIT
#include "e2lf/video/event_video.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::video {
namespace {

/// The position of the rows of planes within larger planes.
struct Frame {
  size_t height, width;  ///< of the inner planes
  size_t outer_height, outer_width;

  [[nodiscard]] size_t top() const { return (outer_height - height + 1) / 2; }
  [[nodiscard]] size_t left() const { return (outer_width - width + 1) / 2; }
  [[nodiscard]] size_t outer_row(size_t plane, size_t y) const {
    return (plane * outer_height + top() + y) * outer_width + left();
  }
};

size_t padded_to(size_t size_px, size_t multiple_px) {
  return (size_px + multiple_px - 1) / multiple_px * multiple_px;
}

}  // namespace

EventVideo::EventVideo(VideoModel model, engine::Engine engine, size_t height, size_t width)
    : model_(std::move(model)),
      engine_(std::move(engine)),
      height_(height),
      width_(width),
      padded_height_(padded_to(height, model_.pad_multiple)),
      padded_width_(padded_to(width, model_.pad_multiple)) {}

Result<EventVideo> EventVideo::create(VideoModel model, size_t height, size_t width,
                                      const engine::EngineOptions& options) {
  E2LF_REQUIRE(height > 0 && width > 0, "the sensor must have pixels");
  E2LF_RETURN_IF_ERROR(validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  return EventVideo(std::move(model), std::move(engine), height, width);
}

Result<std::vector<float>> EventVideo::next(capture::VoxelGrid grid) {
  E2LF_REQUIRE(grid.count == model_.bins && grid.height == height_ && grid.width == width_,
               "the grid has another size");
  if (model_.normalises_voxels) capture::normalise_nonzero(grid.values);
  const Frame frame{height_, width_, padded_height_, padded_width_};
  const bool is_padded = padded_height_ != height_ || padded_width_ != width_;
  if (is_padded) {
    std::vector<float> padded(grid.count * padded_height_ * padded_width_);
    for (size_t row = 0; row < grid.count * height_; ++row) {
      std::copy_n(&grid.values[row * width_], width_, &padded[frame.outer_row(row / height_, row % height_)]);
    }
    grid.values = std::move(padded);
  }
  std::vector<float> output(padded_height_ * padded_width_);
  E2LF_RETURN_IF_ERROR(engine_.run_frame(grid.values, padded_height_, padded_width_, state_, output));
  if (!is_padded) return output;
  std::vector<float> picture(height_ * width_);
  for (size_t y = 0; y < height_; ++y) std::copy_n(&output[frame.outer_row(0, y)], width_, &picture[y * width_]);
  return picture;
}

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
