// SPDX-License-Identifier: MIT
// Models whose pixels follow the light without delay: ESIM (Rebecq et al., "ESIM: an open event camera simulator", CoRL
// 2018), where the log intensity is linear between two samples, and those of the paper, Eq. 8 to 10.
#include <algorithm>
#include <cmath>

#include "e2lf/base/rng.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::streams {
namespace {

struct EsimPixel {
  double reference = 0.0, level = 0.0;  ///< log intensity
  double last_us = 0.0;                 ///< of its last event
  bool has_fired = false;
};

class EsimPixels : public SinglePixels {
 public:
  EsimPixels(const StreamOptions& options, const LightSegment& first)
      : SinglePixels(first.from.size()), options_(options), pixels_(count()) {
    for (size_t i = 0; i < count(); ++i) pixels_[i].reference = pixels_[i].level = log_of(first.from[i]);
  }

 private:
  void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) override {
    const auto duration_us = static_cast<double>(segment.end_us - segment.begin_us);
    for (size_t i = begin; i < end; ++i) {
      const double from = log_of(segment.from[i]), to = log_of(segment.to[i]);
      // A segment is a jump followed by a ramp to its end: two pairs of samples, each with its own threshold.
      const auto normals = thresholds_of(i);
      pass(segment, i, from, 0.0, normals[0], events);
      pass(segment, i, to, duration_us, normals[1], events);
    }
  }

  [[nodiscard]] std::array<float, 2> thresholds_of(size_t i) const {
    const auto& constants = options_.constants;
    if (constants.sigma_z == 0) return {constants.tau, constants.tau};
    const auto words = CounterRng(options_.seed, sensor::kSegmentStream + segment_number()).bits(i);
    const auto [first, second] = normals_of(words[0], words[1]);
    return {std::max(constants.tau + constants.sigma_z * first, sensor::kMinThreshold),
            std::max(constants.tau + constants.sigma_z * second, sensor::kMinThreshold)};
  }

  /// Moves the log intensity of a pixel to `to` within `duration_us`. Only crossings on the way count. An event in the
  /// refractory period is lost, but still moves the reference.
  void pass(const LightSegment& segment, size_t i, double to, double duration_us, double threshold,
            PixelEventSink& events) {
    EsimPixel& pixel = pixels_[i];
    const double from = std::exchange(pixel.level, to);
    constexpr double kSmallest = 1e-6;  // as in ESIM: smaller changes are ignored
    if (std::abs(to - from) <= kSmallest) return;
    const double sign = to > from ? 1.0 : -1.0;
    for (;;) {
      const double crossing = pixel.reference + sign * threshold;
      if (!(sign * crossing > sign * from && sign * crossing <= sign * to)) return;
      pixel.reference = crossing;
      const double offset_us = (crossing - from) / (to - from) * duration_us;
      const double t_us = static_cast<double>(segment.begin_us) + offset_us;
      if (pixel.has_fired && t_us - pixel.last_us < options_.esim_refractory_us) continue;
      pixel.has_fired = true;
      pixel.last_us = t_us;
      events.add(offset_us, i, sign > 0);
    }
  }

  [[nodiscard]] double log_of(float intensity) const {
    return std::log((intensity > 0.0F ? intensity : 0.0) + static_cast<double>(options_.constants.eps));
  }

  StreamOptions options_;
  std::vector<EsimPixel> pixels_;
};

/// The state of a pixel. Within a pattern, it counts thresholds from its reference; the next pattern moves the
/// reference.
struct StepPixel {
  double reference = 0.0;  ///< log intensity
  double level = 0.0;      ///< without noise, at the end of the previous segment
  double noise = 0.0;      ///< of the log intensity, in this pattern
  double threshold = 0.0;  ///< in this pattern
  int count = 0;           ///< of thresholds crossed by the events of this pattern
};

class StepPixels : public SinglePixels {
 public:
  StepPixels(const StreamOptions& options, const LightSegment& first)
      : SinglePixels(first.from.size()), options_(options), pixels_(count()) {
    for (size_t i = 0; i < count(); ++i) pixels_[i].reference = pixels_[i].level = log_of(light_of(first.from[i]));
  }

 private:
  void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) override {
    for (size_t i = begin; i < end; ++i) {
      StepPixel& pixel = pixels_[i];
      if (segment.begins_pattern()) begin_pattern(segment.pattern, i, pixel);
      const double from = light_of(segment.from[i]), to = light_of(segment.to[i]);
      jump(i, log_of(from), pixel, events);
      if (from != to) ramp(segment, i, from, to, pixel, events);
      pixel.level = log_of(to);
    }
  }

  void begin_pattern(uint64_t pattern, size_t i, StepPixel& pixel) const {
    const double tau = options_.constants.tau;
    const bool is_quantised = options_.model == StreamModel::kQuantised;
    pixel.reference = is_quantised ? pixel.level : pixel.reference + tau * pixel.count;
    pixel.count = 0;
    pixel.noise = 0.0;
    pixel.threshold = std::max(tau, static_cast<double>(sensor::kMinThreshold));
    // Nothing was counted before the first pattern, so it has no noise, as in simulate_events().
    if (pattern == 0 || (options_.constants.sigma_w == 0 && options_.constants.sigma_z == 0)) return;
    const uint64_t k = pattern - 1;
    const auto words = CounterRng(options_.seed, k / 2).bits(i);
    const auto [w, z] = normals(words[2 * (k % 2)], words[2 * (k % 2) + 1]);
    pixel.noise = options_.constants.sigma_w * w;
    pixel.threshold =
        std::max(options_.constants.tau + options_.constants.sigma_z * z, static_cast<double>(sensor::kMinThreshold));
  }

  /// Computes CounterRng::normal2 from any two words.
  static std::array<double, 2> normals(uint32_t word0, uint32_t word1) {
    const double radius = std::sqrt(-2.0 * std::log((word0 + 0.5) * 0x1p-32));
    const double angle = word1 * (2.0 * std::numbers::pi * 0x1p-32);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

  /// Adds the events of an immediate change of light to `level`.
  static void jump(size_t i, double level, StepPixel& pixel, PixelEventSink& events) {
    const double steps = std::trunc((level + pixel.noise - pixel.reference) / pixel.threshold - pixel.count);
    const int change = static_cast<int>(std::clamp(steps, -32768.0, 32767.0));
    for (int k = 0; k < std::abs(change); ++k) events.add(0.0, i, change > 0);
    pixel.count += change;
  }

  /// Adds the events of a linear change of light from `from` to `to`, each where it crosses the next threshold.
  void ramp(const LightSegment& segment, size_t i, double from, double to, StepPixel& pixel,
            PixelEventSink& events) const {
    const int sign = to > from ? 1 : -1;
    const auto duration_us = static_cast<double>(segment.end_us - segment.begin_us);
    const double end = log_of(to) + pixel.noise - pixel.reference;
    while (sign * end >= sign * (pixel.count + sign) * pixel.threshold) {
      pixel.count += sign;
      const double crossed = std::exp(pixel.reference + pixel.count * pixel.threshold - pixel.noise) - eps();
      events.add((crossed - from) / (to - from) * duration_us, i, sign > 0);
    }
  }

  [[nodiscard]] double eps() const { return options_.constants.eps; }
  [[nodiscard]] double log_of(double light) const { return std::log(light + eps()); }
  static double light_of(float intensity) { return intensity > 0.0F ? intensity : 0.0; }

  StreamOptions options_;
  std::vector<StepPixel> pixels_;
};

}  // namespace

std::unique_ptr<StreamPixels> make_esim_pixels(const StreamOptions& options, const LightSegment& first) {
  return std::make_unique<EsimPixels>(options, first);
}

std::unique_ptr<StreamPixels> make_step_pixels(const StreamOptions& options, const LightSegment& first) {
  return std::make_unique<StepPixels>(options, first);
}

}  // namespace e2lf::streams
