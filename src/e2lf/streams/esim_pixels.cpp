// SPDX-License-Identifier: MIT
// ESIM (Rebecq et al., "ESIM: an open event camera simulator", CoRL 2018): the log intensity is linear between two
// samples.
#include <algorithm>
#include <cmath>

#include "e2lf/sensor/draws.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/stream_pixels.h"

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

  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override {
    SinglePixels::advance(segment, parts);
    ++segment_;
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
    const auto words = CounterRng(options_.seed, sensor::kSegmentStream + segment_).bits(i);
    const auto [first, second] = sensor::normals_of(words[0], words[1]);
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
  uint64_t segment_ = 0;
  std::vector<EsimPixel> pixels_;
};

}  // namespace

std::unique_ptr<StreamPixels> make_esim_pixels(const StreamOptions& options, const LightSegment& first) {
  return std::make_unique<EsimPixels>(options, first);
}

}  // namespace e2lf::streams
