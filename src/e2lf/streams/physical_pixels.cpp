// SPDX-License-Identifier: MIT
// Pixels with a photoreceptor, an amplifier, mismatched thresholds, noise, refractory periods and spurious events.
#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/sensor/pixel_model.h"
#include "e2lf/streams/event_stream.h"
#include "e2lf/streams/receptor.h"

namespace e2lf::streams {
namespace {

using enum capture::PixelConstant;
constexpr double kUsPerS = 1e6;

/// The state of a pixel.
struct PhysicalPixel {
  sensor::PixelThresholds thresholds;
  bool is_hot = false;
  bool is_blind = false;    ///< until blind_until_us; it then restarts from its level
  double inverse = 1.0;     ///< w of the photoreceptor
  double level = 0.0;       ///< of the amplifier
  double start = 0.0;       ///< the amplifier's level when the pattern began
  double reference = 0.0;   ///< with which the signal is compared
  double pending = 0.0;     ///< added to the reference when the next pattern begins
  double noise_from = 0.0;  ///< offset to the level when the pattern began
  double noise_to = 0.0;    ///< offset when it ends; linear in between
  double blind_until_us = 0.0;
};

/// A sequence of draws for one pixel and one moment.
class DrawSequence {
 public:
  DrawSequence(uint64_t seed, uint64_t stream, uint64_t pixel) : rng_(seed, stream), index_(pixel) {}

  [[nodiscard]] double uniform() {
    if (next_ == words_.size()) {
      // Pixel numbers have 32 bits; the bits above count the draws.
      words_ = rng_.bits(index_);
      index_ += uint64_t{1} << 32;
      next_ = 0;
    }
    return (static_cast<double>(words_[next_++]) + 0.5) * 0x1p-32;
  }

  /// Returns the waiting time to the next event of a Poisson process with this rate.
  [[nodiscard]] double wait(double rate) { return -std::log(uniform()) / rate; }

 private:
  CounterRng rng_;
  uint64_t index_;
  std::array<uint32_t, 4> words_ = {};
  size_t next_ = words_.size();
};

/// The effect of a spurious event on the pixel.
enum class StrayEffect {
  kNone,   ///< event of a hot pixel
  kReset,  ///< shot noise event: the reference is reset to the present signal
  kLater,  ///< event in the dark: the reference moves by a threshold when the next pattern begins
};

/// A spurious event, which no change of light caused.
struct StrayEvent {
  double time_s;  ///< since the beginning of the segment
  bool is_on;
  StrayEffect effect;
};

/// The quantities of a segment that are common to all pixels.
struct Stretch {
  const LightSegment& segment;
  ReceptorSegment receptor;
  double noise_begin, noise_end;  ///< elapsed share of the pattern at the beginning and end of the segment, 0 to 1
};

class PhysicalPixels : public SinglePixels {
 public:
  PhysicalPixels(const StreamOptions& options, const LightSegment& first)
      : SinglePixels(first.from.size()), options_(options), pixels_(count()) {
    for (size_t i = 0; i < count(); ++i) {
      PhysicalPixel& pixel = pixels_[i];
      pixel.thresholds = sensor::draw_thresholds(constants(), options.map_seed, i);
      pixel.is_hot =
          uniform_of(CounterRng(options.map_seed, sensor::kHotStream).bits(i)[0]) < options.defects.hot_share;
      pixel.inverse = 1.0 / exposure(first.from[i]);
      pixel.level = pixel.start = -std::log(pixel.inverse);
      const float draw = uniform_of(CounterRng(options.seed, 0).bits(i)[0]);
      // No event is due for a pixel at rest: its reference is less than a threshold away, whatever span was fitted.
      const double above = pixel.thresholds.off * constants()[kResetSpan] * draw - constants()[kResetOffset];
      pixel.reference = pixel.level + std::min(above, capture::kAlmostThreshold * pixel.thresholds.off);
      pixel.noise_to = 0.0;
    }
  }

  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override {
    SinglePixels::advance(segment, parts);
    was_black_ = segment.is_black;
  }

 private:
  [[nodiscard]] const capture::PixelConstants& constants() const { return options_.pixel; }
  [[nodiscard]] double exposure(float intensity) const {
    return (intensity > 0.0F ? intensity : 0.0) / static_cast<double>(constants()[kEps]) + 1.0;
  }

  void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) override {
    const auto seconds = [](int64_t from_us, int64_t to_us) { return static_cast<double>(to_us - from_us) / kUsPerS; };
    const double since_s = seconds(segment.pattern_begin_us, segment.begin_us);
    const double pattern_s = seconds(segment.pattern_begin_us, segment.pattern_end_us);
    const double duration_s = seconds(segment.begin_us, segment.end_us);
    const Stretch stretch = {segment,
                             {constants()[kReceptorRate], constants()[kAmplifierRate], duration_s, since_s,
                              segment.from.data() != segment.to.data()},
                             since_s / pattern_s,
                             (since_s + duration_s) / pattern_s};
    ReceptorBlock block;
    for (size_t first = begin; first < end; first += kReceptorBlock) {
      follow_block(stretch, first, std::min(kReceptorBlock, end - first), block, events);
    }
  }

  void follow_block(const Stretch& stretch, size_t first, size_t count, ReceptorBlock& block, PixelEventSink& events) {
    for (size_t i = 0; i < count; ++i) {
      PhysicalPixel& pixel = pixels_[first + i];
      block.from[i] = exposure(stretch.segment.from[first + i]);
      block.to[i] = exposure(stretch.segment.to[first + i]);
      if (stretch.segment.begins_pattern()) begin_pattern(stretch.segment, first + i, block.to[i]);
      block.start[i] = pixel.start;
      block.inverse[i] = pixel.inverse;
    }
    nodes_(stretch.receptor, block, count);
    std::vector<StrayEvent> strays;
    for (size_t i = 0; i < count; ++i) {
      draw_strays(stretch, first + i, block.to[i], strays);
      walk(stretch, block, i, first + i, strays, events);
    }
  }

  void begin_pattern(const LightSegment& segment, size_t i, double exposure) {
    PhysicalPixel& pixel = pixels_[i];
    pixel.start = pixel.level;
    pixel.reference += std::exchange(pixel.pending, 0.0);
    pixel.noise_from = pixel.noise_to;
    if (was_black_ && !segment.is_black) draw_reference(segment, i);
    if (segment.is_black) {
      // In black, noise lowers the reference together with the level.
      pixel.noise_to = -constants()[kResetOffset];
      return;
    }
    const double deviation = std::sqrt(constants()[kNoise] * constants()[kNoise] +
                                       constants()[kShotNoise] * constants()[kShotNoise] / exposure);
    pixel.noise_to = 0.0;
    if (deviation == 0.0) return;
    const auto words = CounterRng(options_.seed, segment.pattern).bits(i);
    pixel.noise_to = deviation * normals_of(words[0], words[1])[0];
  }

  /// Without noise in black, events leave the reference less than an OFF threshold above the signal, and a dark scene
  /// leaves it unchanged. If a fit found another distribution (reset_span above 1), the reference is drawn as in the
  /// closed form. The noise is shifted by the same amount, so that the difference appears gradually during the next
  /// pattern and a pixel whose light returns at once has no OFF event due.
  void draw_reference(const LightSegment& segment, size_t i) {
    const double span = constants()[kResetSpan];
    if (span <= 1.0) return;
    PhysicalPixel& pixel = pixels_[i];
    const float draw = uniform_of(CounterRng(options_.seed, segment.pattern - 1).bits(i)[0]);
    const double drawn = pixel.level + pixel.noise_to + static_cast<double>(pixel.thresholds.off) * span * draw;
    pixel.noise_from += drawn - pixel.reference;
    pixel.reference = drawn;
  }

  /// Follows one pixel through a segment, from node to node and from spurious event to spurious event.
  void walk(const Stretch& stretch, const ReceptorBlock& block, size_t lane, size_t i,
            const std::vector<StrayEvent>& strays, PixelEventSink& events) {
    PhysicalPixel& pixel = pixels_[i];
    const double noise = pixel.noise_to - pixel.noise_from;
    const double leak_per_s = options_.defects.leak_rate_hz * static_cast<double>(pixel.thresholds.on);
    const double duration_s = stretch.receptor.duration_s;
    PixelSignal signal(stretch.receptor, block, lane, pixel.noise_from + noise * stretch.noise_begin,
                       noise * (stretch.noise_end - stretch.noise_begin) / duration_s + leak_per_s);
    auto stray = strays.begin();
    for (size_t node = 0; node + 1 < kReceptorNodes; ++node) {
      double from_s = stretch.receptor.time_s[node];
      const double to_s = stretch.receptor.time_s[node + 1];
      for (; stray != strays.end() && stray->time_s < to_s; ++stray) {
        cross({from_s, stray->time_s, signal.at(node, stray->time_s)}, node, signal, stretch, i, events);
        from_s = stray->time_s;
        if (!is_blind(stretch, pixel, from_s)) add_stray(*stray, signal.at(node, from_s), stretch, i, events);
      }
      cross({from_s, to_s, signal.at_node(node + 1)}, node, signal, stretch, i, events);
    }
    pixel.reference -= leak_per_s * duration_s;
    pixel.inverse = block.inverse[(kReceptorNodes - 1) * kReceptorBlock + lane];
    pixel.level = block.level[(kReceptorNodes - 1) * kReceptorBlock + lane];
  }

  struct Bracket {
    double from_s, to_s;
    double last;  ///< the signal at to_s
  };

  /// Adds the events of the thresholds that the signal crosses between two nodes.
  void cross(const Bracket& bracket, size_t node, const PixelSignal& signal, const Stretch& stretch, size_t i,
             PixelEventSink& events) {
    PhysicalPixel& pixel = pixels_[i];
    double from_s = bracket.from_s;
    for (;;) {
      if (pixel.is_blind) {
        if (is_blind(stretch, pixel, bracket.to_s)) return;
        from_s = std::max(from_s, since_begin_s(stretch, pixel.blind_until_us));
        pixel.reference = signal.at(node, from_s);
        pixel.is_blind = false;
      }
      const double up = pixel.reference + static_cast<double>(pixel.thresholds.on);
      const double down = pixel.reference - static_cast<double>(pixel.thresholds.off);
      const bool is_on = bracket.last >= up;
      if (!is_on && !(bracket.last <= down)) return;
      pixel.reference = is_on ? up : down;
      from_s = signal.find(node, from_s, bracket.to_s, pixel.reference, is_on);
      events.add(from_s * kUsPerS, i, is_on);
      go_blind(stretch, pixel, from_s);
    }
  }

  void go_blind(const Stretch& stretch, PhysicalPixel& pixel, double time_s) const {
    if (options_.defects.refractory_us == 0) return;
    pixel.is_blind = true;
    pixel.blind_until_us =
        static_cast<double>(stretch.segment.begin_us) + time_s * kUsPerS + options_.defects.refractory_us;
  }

  static double since_begin_s(const Stretch& stretch, double t_us) {
    return (t_us - static_cast<double>(stretch.segment.begin_us)) / kUsPerS;
  }
  static bool is_blind(const Stretch& stretch, const PhysicalPixel& pixel, double time_s) {
    return pixel.is_blind && since_begin_s(stretch, pixel.blind_until_us) > time_s;
  }

  void add_stray(const StrayEvent& stray, double signal, const Stretch& stretch, size_t i, PixelEventSink& events) {
    PhysicalPixel& pixel = pixels_[i];
    events.add(stray.time_s * kUsPerS, i, stray.is_on);
    if (stray.effect == StrayEffect::kLater) {
      pixel.pending += stray.is_on ? pixel.thresholds.on : -pixel.thresholds.off;
    }
    if (stray.effect != StrayEffect::kReset) return;
    pixel.reference = signal;
    go_blind(stretch, pixel, stray.time_s);
  }

  /// Draws the spurious events of this segment, in order of time.
  void draw_strays(const Stretch& stretch, size_t i, double exposure, std::vector<StrayEvent>& strays) const {
    strays.clear();
    if (constants()[kDarkOff] > 0 || constants()[kDarkOn] > 0) draw_dark(stretch, i, exposure, strays);
    const PixelDefects& defects = options_.defects;
    const double shot_hz = defects.shot_rate_hz / exposure, hot_hz = pixels_[i].is_hot ? defects.hot_rate_hz : 0.0;
    if (shot_hz + hot_hz > 0) {
      DrawSequence draws(options_.seed, sensor::kDefectStream + segment_number(), i);
      const double duration_s = stretch.receptor.duration_s;
      for (double t = draws.wait(shot_hz + hot_hz); t < duration_s; t += draws.wait(shot_hz + hot_hz)) {
        const double kind = draws.uniform() * (shot_hz + hot_hz);
        strays.push_back({t, kind < hot_hz || kind < hot_hz + shot_hz / 2,
                          kind < hot_hz ? StrayEffect::kNone : StrayEffect::kReset});
      }
    }
    std::sort(strays.begin(), strays.end(),
              [](const StrayEvent& a, const StrayEvent& b) { return a.time_s < b.time_s; });
  }

  /// Draws at most one event of each sign per pattern, at any time in it, and none in black, as in the closed form.
  void draw_dark(const Stretch& stretch, size_t i, double exposure, std::vector<StrayEvent>& strays) const {
    if (stretch.segment.is_black) return;
    const auto words = CounterRng(options_.seed, stretch.segment.pattern).bits(i);
    const double draw = uniform_of(words[2]) * exposure;
    const bool is_off = draw < constants()[kDarkOff], is_on = exposure - draw < constants()[kDarkOn];
    if (!is_off && !is_on) return;
    const double place = uniform_of(words[3]);
    if (!(place >= stretch.noise_begin && place < stretch.noise_end)) return;
    const double time_s = (place - stretch.noise_begin) / (stretch.noise_end - stretch.noise_begin);
    strays.push_back({time_s * stretch.receptor.duration_s, is_on, StrayEffect::kLater});
  }

  StreamOptions options_;
  void (*nodes_)(const ReceptorSegment&, ReceptorBlock&, size_t) = current_isa() == "scalar" ? reference_receptor_nodes
                                                                                             : receptor_nodes;
  bool was_black_ = false;  ///< in the previous segment
  std::vector<PhysicalPixel> pixels_;
};

}  // namespace

std::unique_ptr<StreamPixels> make_physical_pixels(const StreamOptions& options, const LightSegment& first) {
  return std::make_unique<PhysicalPixels>(options, first);
}

}  // namespace e2lf::streams
