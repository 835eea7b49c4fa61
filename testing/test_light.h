// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <vector>

#include "e2lf/base/rng.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::streams {

/// A sensor under light controlled by a test. It keeps all its events.
class TestLight {
 public:
  /// The pixels begin in the steady state for the light of the first call of show() or ramp().
  explicit TestLight(const StreamOptions& options, size_t height = 1, size_t width = 1)
      : size_(height * width), stream_(EventStream::create(options, height, width).value()) {}

  /// Shows a pattern with uniform light, to which the light jumps.
  void show(float light, int64_t duration_us) { show(std::vector<float>(size_, light), duration_us); }
  void show(const std::vector<float>& light, int64_t duration_us, bool is_black = false) {
    const int64_t end_us = now_us_ + duration_us;
    advance({now_us_, end_us, light, light, pattern_++, now_us_, end_us, is_black});
  }

  /// Shows a pattern in which the light follows light(seconds since its beginning), in linear pieces of `piece_us`.
  void follow(const std::function<double(double)>& light, int64_t duration_us, int64_t piece_us) {
    const int64_t begin_us = now_us_, end_us = begin_us + duration_us;
    const auto image = [&](int64_t t_us) {
      return std::vector<float>(size_, static_cast<float>(light(static_cast<double>(t_us - begin_us) * 1e-6)));
    };
    while (now_us_ < end_us) {
      const int64_t next_us = std::min(now_us_ + piece_us, end_us);
      const auto from = image(now_us_), to = image(next_us);
      advance({now_us_, next_us, from, to, pattern_, begin_us, end_us});
    }
    ++pattern_;
  }
  void ramp(float from, float to, int64_t duration_us) {
    follow([=](double t) { return from + (to - from) * t * 1e6 / static_cast<double>(duration_us); }, duration_us,
           duration_us);
  }

  [[nodiscard]] const recordings::EventColumns& events() const { return events_; }
  [[nodiscard]] const EventStream& stream() const { return stream_; }
  [[nodiscard]] int64_t now_us() const { return now_us_; }

  /// Returns the signed sum of all events at or after `from_us`.
  [[nodiscard]] int64_t sum(int64_t from_us = 0) const {
    int64_t sum = 0;
    for (size_t i = 0; i < events_.size(); ++i) sum += events_.t[i] < from_us ? 0 : events_.p[i] != 0 ? 1 : -1;
    return sum;
  }
  [[nodiscard]] size_t num_on() const { return static_cast<size_t>(std::count(events_.p.begin(), events_.p.end(), 1)); }

 private:
  void advance(const LightSegment& segment) {
    stream_.advance(segment, events_);
    now_us_ = segment.end_us;
  }

  size_t size_;
  EventStream stream_;
  recordings::EventColumns events_;
  int64_t now_us_ = 0;
  uint64_t pattern_ = 0;
};

/// Returns options for the paper's models or ESIM without noise.
inline StreamOptions quiet(StreamModel model, float tau = 0.3F, float eps = 0.01F) {
  StreamOptions options;
  options.model = model;
  options.constants = {.eps = eps, .tau = tau, .sigma_w = 0.0F, .sigma_z = 0.0F};
  return options;
}

/// Returns options for physical pixels that follow the light immediately, are identical and have no noise.
inline StreamOptions ideal_pixels(float tau = 0.3F, float eps = 0.01F) {
  using enum capture::PixelConstant;
  StreamOptions options;
  options.model = StreamModel::kPixel;
  options.pixel[kEps] = eps;
  options.pixel[kReceptorRate] = options.pixel[kAmplifierRate] = 1e9F;
  options.pixel[kThresholdOn] = options.pixel[kThresholdOff] = tau;
  return options;
}

struct MeanAndDeviation {
  size_t count = 0;
  double mean = 0.0, deviation = 0.0;
};

/// Computes the mean and deviation of the thresholds implied by the time of each pixel's first event.
template <typename ThresholdAt>
MeanAndDeviation first_thresholds(const recordings::EventColumns& events, size_t height, size_t width,
                                  const ThresholdAt& threshold_at) {
  MeanAndDeviation result;
  double squares = 0;
  std::vector<int> seen(height * width);
  for (size_t i = 0; i < events.size(); ++i) {
    if (seen[events.y[i] * width + events.x[i]]++ > 0) continue;
    const double threshold = threshold_at(static_cast<double>(events.t[i]) + 0.5);
    ++result.count;
    result.mean += threshold;
    squares += threshold * threshold;
  }
  const auto n = static_cast<double>(result.count);
  result.mean /= n;
  result.deviation = std::sqrt(squares / n - result.mean * result.mean);
  return result;
}

/// Returns the light for which ln(light + eps) is `log_light`.
inline double light_of_log(double log_light, double eps = 0.01) {
  return std::exp(log_light) - eps;
}

}  // namespace e2lf::streams
