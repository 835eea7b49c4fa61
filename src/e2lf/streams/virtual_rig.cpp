// SPDX-License-Identifier: MIT
#include "e2lf/streams/virtual_rig.h"

#include <algorithm>
#include <limits>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::streams {
namespace {

constexpr size_t kLeastPixels = 4096;  // the fewest per thread

/// Computes values = (1 - share) * values + share * others.
void blend(std::vector<float>& values, const std::vector<float>& others, float share) {
  parallel_for(values.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) values[i] += share * (others[i] - values[i]);
  });
}

Result<void> check(const RigOptions& options) {
  E2LF_RETURN_IF_ERROR(cycles::validate(options.schedule, "schedule"));
  int64_t shortest_us = std::numeric_limits<int64_t>::max();
  for (const cycles::ScheduledPattern& pattern : options.schedule.patterns) {
    shortest_us = std::min(shortest_us, pattern.interval_us());
  }
  if (options.rise_us < 0 || options.rise_us >= shortest_us || options.trigger_width_us < 0 ||
      options.trigger_width_us >= shortest_us) {
    return fail(ErrorCode::kInvalidValue, "", "a rise of ", options.rise_us, " us and a trigger of ",
                options.trigger_width_us, " us do not fit into a pattern of ", shortest_us, " us; use shorter ones");
  }
  if (!(options.gain >= 0.0F && options.gain <= std::numeric_limits<float>::max())) {
    return fail(ErrorCode::kInvalidValue, "", "a gain of ", options.gain, " is not a brightness; use zero or more");
  }
  return {};
}

}  // namespace

ShownLight::ShownLight(const capture::Codes& codes, const capture::SensorProfile& camera, float gain, size_t height,
                       size_t width)
    : codes_(capture::with_open_aperture(codes)),
      transmission_(codes.num_patterns - 1),
      gain_(gain),
      leak_(camera.pixel[capture::PixelConstant::kLeak]) {
  const float middle_x = 0.5F * static_cast<float>(width), middle_y = 0.5F * static_cast<float>(height);
  for (size_t n = 0; n < transmission_.size(); ++n) {
    transmission_[n].resize(height * width);
    parallel_for(height, kLeastPixels / width + 1, [&](size_t begin, size_t end) {
      for (size_t y = begin; y < end; ++y) {
        const float place_y = (static_cast<float>(y) + 0.5F - middle_y) / middle_x;
        for (size_t x = 0; x < width; ++x) {
          const float place_x = (static_cast<float>(x) + 0.5F - middle_x) / middle_x;
          transmission_[n][y * width + x] = capture::transmission_at(camera, n, place_x, place_y);
        }
      }
    });
  }
}

void ShownLight::image(const capture::CodedIntensities& intensities, ShownPattern shown,
                       std::vector<float>& light) const {
  const auto open = intensities.image(shown.code), full = intensities.image(intensities.count - 1);
  light.resize(open.size());
  parallel_for(light.size(), kLeastPixels, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float passed = std::max(open[i], 0.0F) * (shown.code == 0 ? 1.0F : transmission_[shown.code - 1][i]);
      const float all = std::max(full[i], 0.0F), closed = all - std::max(open[i], 0.0F);
      light[i] = gain_ * (shown.is_inverse ? std::max(all - passed, 0.0F) : passed + leak_ * closed);
    }
  });
}

bool ShownLight::is_black(ShownPattern shown) const {
  const auto pattern = codes_.pattern(shown.code);
  const float closed = shown.is_inverse ? 1.0F : 0.0F;
  return std::all_of(pattern.begin(), pattern.end(), [=](float cell) { return cell == closed; });
}

Result<VirtualRig> VirtualRig::create(const capture::Codes& codes, const capture::SensorProfile& camera,
                                      const StreamOptions& stream, const RigOptions& options, MovingScene scene,
                                      size_t height, size_t width) {
  E2LF_RETURN_IF_ERROR(check(options));
  E2LF_ASSIGN_OR_RETURN(EventStream events, EventStream::create(stream, height, width));
  const capture::Codes shown = capture::codes_of_whole_cycle(codes).value_or(codes);
  VirtualRig rig(shown, camera, std::move(events), options, std::move(scene), height, width);
  E2LF_ASSIGN_OR_RETURN(rig.shown_, cycles::shown_patterns(options.schedule, shown.num_patterns));
  return rig;
}

VirtualRig::VirtualRig(const capture::Codes& codes, const capture::SensorProfile& camera, EventStream stream,
                       const RigOptions& options, MovingScene scene, size_t height, size_t width)
    : options_(options),
      aperture_(codes, camera, options.gain, height, width),
      stream_(std::move(stream)),
      scene_(std::move(scene)),
      height_(height),
      width_(width),
      now_us_(options.begin_us),
      cycle_begin_us_(options.begin_us) {}

Result<recordings::EventBatch> VirtualRig::play_cycle() {
  recordings::EventBatch batch;
  std::swap(batch.events, late_);
  late_.clear();
  const size_t first = options_.schedule.first_of_cycle();
  const auto show_pattern = [&](size_t i) {
    cycles::add_pulse(now_us_, options_.trigger_channel, options_.trigger_width_us, batch.triggers);
    return show(shown_[i], now_us_ + options_.schedule.patterns[i].interval_us(), batch.events);
  };
  for (size_t i = 0; i < first && pattern_ < first; ++i) E2LF_RETURN_IF_ERROR(show_pattern(i));
  cycle_begin_us_ = now_us_;
  for (size_t i = 0; i < shown_.size(); ++i) E2LF_RETURN_IF_ERROR(show_pattern((first + i) % shown_.size()));
  const auto& times = batch.events.t;
  const auto kept = static_cast<size_t>(std::lower_bound(times.begin(), times.end(), now_us_) - times.begin());
  late_.append(batch.events, kept, batch.events.size());
  batch.events.resize(kept);
  return batch;
}

capture::EventImages VirtualRig::sum_windows(const recordings::EventBatch& batch) const {
  capture::EventImages images(options_.schedule.num_images(), height_, width_);
  int64_t begin_us = cycle_begin_us_;
  const size_t first_pattern = options_.schedule.first_of_cycle();
  for (size_t i = 0; i < shown_.size(); ++i) {
    const cycles::ScheduledPattern& pattern = options_.schedule.patterns[(first_pattern + i) % shown_.size()];
    const auto& times = batch.events.t;
    const auto first = std::lower_bound(times.begin(), times.end(), begin_us);
    const auto last = std::lower_bound(first, times.end(), begin_us += pattern.interval_us());
    if (!pattern.image) continue;
    const auto image = images.image(*pattern.image);
    for (auto event = static_cast<size_t>(first - times.begin()); event < static_cast<size_t>(last - times.begin());
         ++event) {
      int16_t& count = image[batch.events.y[event] * width_ + batch.events.x[event]];
      count = capture::saturated(count + (batch.events.p[event] != 0 ? 1 : -1));
    }
  }
  return images;
}

/// Shows one pattern, from stop to stop; a stop is a knot of the scene or the end of the rise.
Result<void> VirtualRig::show(ShownPattern shown, int64_t end_us, recordings::EventColumns& events) {
  const int64_t begin_us = now_us_;
  LightSegment segment;
  segment.pattern = pattern_;
  segment.pattern_begin_us = begin_us;
  segment.pattern_end_us = end_us;
  segment.is_black = aperture_.is_black(shown);
  if (!before_) E2LF_RETURN_IF_ERROR(rest_before(shown));
  while (now_us_ < end_us) {
    if (stop_requested())
      return fail(ErrorCode::kCancelled, "", "the cycle was not simulated to its end; run it again");
    E2LF_RETURN_IF_ERROR(reach_knot(now_us_));
    const bool rises = is_rising(begin_us), moves = rises || scene_.knot_us > 0;
    segment.begin_us = now_us_;
    segment.end_us = next_stop(begin_us, end_us);
    light_of_rise(now_us_, begin_us, shown, from_);
    if (moves) light_of_rise(segment.end_us, begin_us, shown, to_);
    segment.from = from_;
    segment.to = moves ? to_ : from_;
    stream_.advance(segment, events);
    now_us_ = segment.end_us;
  }
  before_ = shown;
  ++pattern_;
  return {};
}

/// Sets the pixels to rest: before the first cycle, the display has shown its last pattern for a long time, or black if
/// the cycle begins with black.
Result<void> VirtualRig::rest_before(ShownPattern first) {
  before_ = aperture_.is_black(first) ? first : shown_.back();
  E2LF_RETURN_IF_ERROR(reach_knot(now_us_));
  light_at(now_us_, *before_, from_);
  LightSegment segment;
  segment.begin_us = now_us_;
  segment.from = segment.to = from_;
  stream_.rest(segment);
  return {};
}

int64_t VirtualRig::next_stop(int64_t pattern_begin_us, int64_t end_us) const {
  int64_t stop_us = end_us;
  if (is_rising(pattern_begin_us)) stop_us = std::min(stop_us, pattern_begin_us + options_.rise_us);
  if (scene_.knot_us > 0) {
    const int64_t last_us = options_.begin_us + static_cast<int64_t>(num_knots_ - 1) * scene_.knot_us;
    stop_us = std::min(stop_us, last_us);
  }
  return stop_us;
}

/// Requests knots from the scene until one lies after this time.
Result<void> VirtualRig::reach_knot(int64_t t_us) {
  const auto is_enough = [&] {
    if (scene_.knot_us == 0) return num_knots_ >= 1;
    return num_knots_ >= 2 && options_.begin_us + static_cast<int64_t>(num_knots_ - 1) * scene_.knot_us > t_us;
  };
  while (!is_enough()) {
    E2LF_ASSIGN_OR_RETURN(const lightfield::LightField field, scene_.at(num_knots_));
    if (field.shape().height != height_ || field.shape().width != width_) {
      return fail(ErrorCode::kShape, "", "a light field of ", field.shape().width, "x", field.shape().height,
                  " px follows one of ", width_, "x", height_, "; use fields of one size");
    }
    knot_ = std::move(next_);
    E2LF_ASSIGN_OR_RETURN(next_, sensor::coded_intensities(aperture_.codes(), field));
    ++num_knots_;
  }
  return {};
}

/// Computes the light through a pattern without the transition of the display.
void VirtualRig::light_at(int64_t t_us, ShownPattern shown, std::vector<float>& light) {
  if (scene_.knot_us == 0) return aperture_.image(next_, shown, light);
  const int64_t last_us = options_.begin_us + static_cast<int64_t>(num_knots_ - 1) * scene_.knot_us;
  const float share = 1.0F - static_cast<float>(last_us - t_us) / static_cast<float>(scene_.knot_us);
  std::vector<float> next;
  aperture_.image(knot_, shown, light);
  aperture_.image(next_, shown, next);
  blend(light, next, share);
}

/// Computes the light during and after the transition of the display from the previous pattern.
void VirtualRig::light_of_rise(int64_t t_us, int64_t pattern_begin_us, ShownPattern shown, std::vector<float>& light) {
  light_at(t_us, shown, light);
  const int64_t left_us = pattern_begin_us + options_.rise_us - t_us;
  if (left_us <= 0) return;
  light_at(t_us, *before_, other_);
  blend(light, other_, static_cast<float>(left_us) / static_cast<float>(options_.rise_us));
}

}  // namespace e2lf::streams
