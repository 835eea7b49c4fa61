// SPDX-License-Identifier: MIT
// v2e (Hu, Liu, Delbruck, "v2e: From Video Frames to Realistic DVS Events", CVPR Workshops 2021), frame by frame.
// Unlike in v2e, frames are not rounded to 8 bits, times are not rounded to float32, and events of the same time are in
// the order of pixels.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "e2lf/base/rng.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::streams {
namespace {

constexpr double kWhite = 255.0;     // of its input
constexpr double kLinear = 20.0;     // end of the linear part of its logarithm; also added to the light in rates
constexpr double kDarkShare = 0.75;  // share of its shot noise that light suppresses

struct V2ePixel {
  double base = 0.0, low_pass = 0.0;  ///< after lin-log
  float theta_on = 0.0F, theta_off = 0.0F, leak_factor = 1.0F;
  int32_t steps = 0;                      ///< in this frame: thresholds up or down
  double inten01 = 0.0, last_s = -1e300;  ///< of its last event
};

/// One frame, which is the end of a part of the segment.
struct Frame {
  double begin_us, end_us;  ///< since the beginning of the segment
  double share;             ///< share of the segment that has elapsed at its end
  uint64_t number;
  [[nodiscard]] double seconds() const { return (end_us - begin_us) * 1e-6; }
};

double lin_log(double number) {
  return number <= kLinear ? number * (std::log(kLinear) / kLinear) : std::log(number);
}

double number_of(double light) {
  return kWhite * std::clamp(light, 0.0, 1.0);
}

class V2ePixels : public StreamPixels {
 public:
  V2ePixels(const StreamOptions& options, const LightSegment& first)
      : seed_(options.seed), v2e_(options.v2e), pixels_(first.from.size()) {
    for (size_t i = 0; i < pixels_.size(); ++i) {
      V2ePixel& pixel = pixels_[i];
      pixel.base = pixel.low_pass = lin_log(number_of(static_cast<double>(first.from[i])));
      const auto words = CounterRng(options.map_seed, sensor::kThresholdStream).bits(i);
      const auto [on, off] = normals_of(words[0], words[1]);
      pixel.theta_on = std::max(v2e_.pos_thres + v2e_.sigma_thres * on, sensor::kMinThreshold);
      pixel.theta_off = std::max(v2e_.neg_thres + v2e_.sigma_thres * off, sensor::kMinThreshold);
      pixel.leak_factor = std::pow(10.0F, v2e_.noise_rate_cov_decades * normals_of(words[2], words[3])[0]);
    }
  }

  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override {
    const auto duration_us = static_cast<double>(segment.end_us - segment.begin_us);
    const auto frame_us = static_cast<double>(v2e_.frame_us);
    for (double begin_us = 0.0; begin_us < duration_us; begin_us += frame_us) {
      const double end_us = std::min(begin_us + frame_us, duration_us);
      add_frame(segment, {begin_us, end_us, end_us / duration_us, frame_++}, parts);
    }
  }

 private:
  void add_frame(const LightSegment& segment, const Frame& frame, std::vector<std::vector<PixelEvent>>& parts) {
    // The subdivision of a frame depends on the pixel with the most events.
    std::vector<int32_t> most(parts.size());
    for_parts(pixels_.size(),
              [&](size_t part, size_t begin, size_t end) { most[part] = see_light(segment, frame, begin, end); });
    const int32_t slots = std::max(*std::max_element(most.begin(), most.end()), 1);
    for_parts(pixels_.size(), [&](size_t part, size_t begin, size_t end) {
      PixelEventSink events(parts[part], segment.end_us - segment.begin_us);
      for (size_t i = begin; i < end; ++i) {
        fire(segment, frame, slots, i, events);
        if (v2e_.shot_noise_rate_hz > 0) add_shot_noise(frame, i, events);
      }
    });
  }

  /// Applies low pass and leak, and computes the number of thresholds of each pixel. Returns the largest one.
  int32_t see_light(const LightSegment& segment, const Frame& frame, size_t begin, size_t end) {
    int32_t most = 0;
    for (size_t i = begin; i < end; ++i) {
      V2ePixel& pixel = pixels_[i];
      const double from = segment.from[i], to = segment.to[i];
      const double number = number_of(from + (to - from) * frame.share);
      pixel.inten01 = (number + kLinear) / (kWhite + kLinear);
      const double rate = 2 * std::numbers::pi * static_cast<double>(v2e_.cutoff_hz);
      const double weight = rate > 0 ? std::min(pixel.inten01 * frame.seconds() * rate, 1.0) : 1.0;
      pixel.low_pass += weight * (lin_log(number) - pixel.low_pass);
      if (v2e_.leak_rate_hz > 0) pixel.base -= leak(frame, i);
      const double difference = pixel.low_pass - pixel.base;
      const double threshold = difference > 0 ? pixel.theta_on : pixel.theta_off;
      pixel.steps = static_cast<int32_t>(std::clamp(difference / threshold, -32768.0, 32767.0));
      most = std::max(most, std::abs(pixel.steps));
    }
    return most;
  }

  [[nodiscard]] double leak(const Frame& frame, size_t i) const {
    const V2ePixel& pixel = pixels_[i];
    double rate = static_cast<double>(v2e_.leak_rate_hz * pixel.leak_factor);
    if (v2e_.leak_jitter_fraction > 0) {
      const auto words = CounterRng(seed_, sensor::kSegmentStream + frame.number).bits(i);
      rate *= 1.0 - static_cast<double>(v2e_.leak_jitter_fraction * normals_of(words[0], words[1])[0]);
    }
    return frame.seconds() * rate * static_cast<double>(pixel.theta_on);
  }

  /// Adds the n events of a pixel in the first n slots of the frame. An event in the refractory period does not move
  /// the base, so that it may occur in a later frame.
  void fire(const LightSegment& segment, const Frame& frame, int32_t slots, size_t i, PixelEventSink& events) {
    V2ePixel& pixel = pixels_[i];
    const bool is_on = pixel.steps > 0;
    const double slot_us = (frame.end_us - frame.begin_us) / slots;
    const double refractory_s = v2e_.refractory_period_s;
    const bool can_be_blind = refractory_s > slot_us * 1e-6;
    for (int32_t slot = 0; slot < std::abs(pixel.steps); ++slot) {
      const double offset_us = frame.begin_us + slot_us * (slot + 1);
      const double t_s = (static_cast<double>(segment.begin_us) + offset_us) * 1e-6;
      if (can_be_blind && !(t_s - pixel.last_s > refractory_s)) continue;
      pixel.last_s = t_s;
      pixel.base += is_on ? static_cast<double>(pixel.theta_on) : -static_cast<double>(pixel.theta_off);
      events.add(offset_us, i, is_on);
    }
  }

  void add_shot_noise(const Frame& frame, size_t i, PixelEventSink& events) {
    V2ePixel& pixel = pixels_[i];
    const double draw = (CounterRng(seed_, sensor::kDefectStream + frame.number).bits(i)[0] + 0.5) * 0x1p-32;
    const double share =
        static_cast<double>(v2e_.shot_noise_rate_hz) / 2 * frame.seconds() * (1.0 - kDarkShare * pixel.inten01);
    const bool is_off = draw < share * static_cast<double>(v2e_.neg_thres / pixel.theta_off);
    const bool is_on = draw > 1.0 - share * static_cast<double>(v2e_.pos_thres / pixel.theta_on);
    if (!is_off && !is_on) return;
    events.add(frame.end_us, i, is_on);
    pixel.base = pixel.low_pass;
  }

  uint64_t seed_, frame_ = 0;
  V2eOptions v2e_;
  std::vector<V2ePixel> pixels_;
};

}  // namespace

std::unique_ptr<StreamPixels> make_v2e_pixels(const StreamOptions& options, const LightSegment& first) {
  return std::make_unique<V2ePixels>(options, first);
}

}  // namespace e2lf::streams
