// SPDX-License-Identifier: MIT
#include "e2lf/streams/event_stream.h"

#include <limits>

#include "e2lf/base/choice.h"
#include "e2lf/base/text.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::streams {
namespace {

constexpr Choice<StreamModel> kModels[] = {{"quantised", StreamModel::kQuantised},
                                           {"reference-aware", StreamModel::kReferenceAware},
                                           {"esim", StreamModel::kEsim},
                                           {"v2e", StreamModel::kV2e},
                                           {"pixel", StreamModel::kPixel}};

/// Returns the first of several checks that fails.
class Checks {
 public:
  Checks& in(const char* name, double value, double low, double high) {
    if (result_ && !(value >= low && value <= high)) {
      result_ = fail(ErrorCode::kInvalidValue, "", name, " is ", value, "; use a number from ", low, " to ", high);
    }
    return *this;
  }
  [[nodiscard]] Result<void> result() const { return result_; }

 private:
  Result<void> result_;
};

constexpr double kMost = 1e9;

Result<void> check_v2e(const V2eOptions& v2e) {
  const double least = static_cast<double>(sensor::kMinThreshold);
  return Checks()
      .in("pos_thres", v2e.pos_thres, least, kMost)
      .in("neg_thres", v2e.neg_thres, least, kMost)
      .in("sigma_thres", v2e.sigma_thres, 0, kMost)
      .in("cutoff_hz", v2e.cutoff_hz, 0, kMost)
      .in("leak_rate_hz", v2e.leak_rate_hz, 0, kMost)
      .in("leak_jitter_fraction", v2e.leak_jitter_fraction, 0, kMost)
      .in("noise_rate_cov_decades", v2e.noise_rate_cov_decades, 0, 10)
      .in("shot_noise_rate_hz", v2e.shot_noise_rate_hz, 0, kMost)
      .in("refractory_period_s", v2e.refractory_period_s, 0, kMost)
      .in("frame_us", static_cast<double>(v2e.frame_us), 1, kMost)
      .result();
}

Result<void> check_pixel(const StreamOptions& options) {
  using enum capture::PixelConstant;
  Checks checks;
  for (const auto constant : {kEps, kReceptorRate, kAmplifierRate, kThresholdOn, kThresholdOff}) {
    checks.in(capture::pixel_constant_key(constant), options.pixel[constant], 1e-6, kMost);
  }
  for (const auto constant : {kMismatch, kMismatchEach, kNoise, kShotNoise, kDarkOff, kDarkOn}) {
    checks.in(capture::pixel_constant_key(constant), options.pixel[constant], 0, kMost);
  }
  return checks.in("refractory_us", options.defects.refractory_us, 0, kMost)
      .in("leak_rate_hz", options.defects.leak_rate_hz, 0, 1e6)
      .in("shot_rate_hz", options.defects.shot_rate_hz, 0, 1e6)
      .in("hot_share", options.defects.hot_share, 0, 1)
      .in("hot_rate_hz", options.defects.hot_rate_hz, 0, 1e6)
      .result();
}

/// For segments longer than this, in us, a table with one entry per microsecond would be larger than it is worth.
constexpr int64_t kLongestTable = int64_t{1} << 20;

/// Returns the index of the first event of each microsecond.
std::vector<size_t> first_places(const std::vector<std::vector<PixelEvent>>& parts, size_t duration_us, size_t begin) {
  std::vector<size_t> places(duration_us);
  for (const auto& part : parts) {
    for (const PixelEvent event : part) ++places[event.offset_us()];
  }
  for (size_t& place : places) {
    const size_t count = place;
    place = begin;
    begin += count;
  }
  return places;
}

}  // namespace

Result<StreamModel> stream_model_from_name(const std::string& name) {
  return choice_of(name, kModels, "event model");
}

const char* stream_model_name(StreamModel model) {
  return word_of(model, kModels);
}

Result<V2eOptions> v2e_preset(const std::string& name) {
  V2eOptions preset;
  if (name == "default") return preset;
  preset.refractory_period_s = 0.0F;
  if (name == "noisy") {
    preset.sigma_thres = 0.05F;
    preset.cutoff_hz = 30.0F;
    preset.leak_rate_hz = 0.1F;
    preset.shot_noise_rate_hz = 5.0F;
    return preset;
  }
  if (name == "clean") {
    preset.sigma_thres = 0.02F;
    preset.cutoff_hz = preset.leak_rate_hz = preset.shot_noise_rate_hz = 0.0F;
    preset.leak_jitter_fraction = preset.noise_rate_cov_decades = 0.0F;
    return preset;
  }
  return fail(ErrorCode::kInvalidValue, "", "unknown preset \"", name, "\" of v2e; use default, noisy or clean");
}

Result<void> validate(const StreamOptions& options) {
  E2LF_RETURN_IF_ERROR(Checks()
                           .in("readout limit", options.readout.events_per_s, 0, 1e12)
                           .in("longest wait", options.readout.longest_us, 0, kMost)
                           .result());
  switch (options.model) {
    case StreamModel::kV2e:
      return check_v2e(options.v2e);
    case StreamModel::kPixel:
      return check_pixel(options);
    case StreamModel::kEsim:
      E2LF_RETURN_IF_ERROR(Checks().in("refractory_us", options.esim_refractory_us, 0, kMost).result());
      break;
    case StreamModel::kQuantised:
    case StreamModel::kReferenceAware:
      break;
  }
  sensor::EventModelOptions constants;
  constants.constants = options.constants;
  return sensor::validate(constants);
}

StreamOptions camera_stream(const capture::SensorProfile& camera, uint64_t seed) {
  StreamOptions options;
  // The names of camera files are those of the models here; read_camera() has checked them.
  options.model = stream_model_from_name(camera.event_model).value();
  options.constants = camera.constants;
  options.pixel = camera.pixel;
  options.seed = options.map_seed = seed;
  return options;
}

void append_in_time(const std::vector<std::vector<PixelEvent>>& parts, const LightSegment& segment, size_t width,
                    recordings::EventColumns& columns) {
  size_t place = columns.size(), count = 0;
  for (const auto& part : parts) count += part.size();
  columns.resize(place + count);
  const auto put = [&](size_t at, PixelEvent event) {
    columns.set(at, {static_cast<uint16_t>(event.pixel() % width), static_cast<uint16_t>(event.pixel() / width),
                     static_cast<uint8_t>(event.is_on()), segment.begin_us + event.offset_us()});
  };
  const int64_t duration_us = segment.end_us - segment.begin_us;
  if (duration_us <= kLongestTable) {
    std::vector<size_t> places = first_places(parts, static_cast<size_t>(duration_us), place);
    for (const auto& part : parts) {
      for (const PixelEvent event : part) put(places[event.offset_us()]++, event);
    }
    return;
  }
  std::vector<PixelEvent> sorted;
  sorted.reserve(count);
  for (const auto& part : parts) sorted.insert(sorted.end(), part.begin(), part.end());
  std::ranges::stable_sort(sorted, [](PixelEvent a, PixelEvent b) { return a.offset_us() < b.offset_us(); });
  for (const PixelEvent event : sorted) put(place++, event);
}

void SinglePixels::advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) {
  for_parts(count_, [&](size_t part, size_t begin, size_t end) {
    follow(segment, begin, end, PixelEventSink(parts[part], segment.end_us - segment.begin_us));
  });
  ++segment_number_;
}

void ReadoutQueue::pass(recordings::EventColumns& events, size_t begin) {
  if (interval_us_ == 0) return;
  size_t kept = begin;
  for (size_t i = begin; i < events.size(); ++i) {
    const auto t_us = static_cast<double>(events.t[i]);
    const double leaves_us = std::max(t_us, free_us_);
    if (leaves_us - t_us > longest_us_) {
      ++lost_;
      continue;
    }
    free_us_ = leaves_us + interval_us_;
    events.set(kept++, {events.x[i], events.y[i], events.p[i], static_cast<int64_t>(leaves_us)});
  }
  events.resize(kept);
}

Result<EventStream> EventStream::create(const StreamOptions& options, size_t height, size_t width) {
  E2LF_RETURN_IF_ERROR(validate(options));
  constexpr size_t kMostPixels = size_t{std::numeric_limits<uint16_t>::max()} + 1;
  if (height < 1 || width < 1 || height > kMostPixels || width > kMostPixels ||
      height * width > kMostPixels * kMostPixels - 1) {
    return fail(ErrorCode::kShape, "", "a sensor of ", width, "x", height, " pixels cannot be; use 1 to ", kMostPixels);
  }
  return EventStream(options, height, width);
}

EventStream::EventStream(const StreamOptions& options, size_t height, size_t width)
    : options_(options), height_(height), width_(width), readout_(options.readout) {}

std::unique_ptr<StreamPixels> EventStream::make_pixels(const LightSegment& first) const {
  switch (options_.model) {
    case StreamModel::kEsim:
      return make_esim_pixels(options_, first);
    case StreamModel::kV2e:
      return make_v2e_pixels(options_, first);
    case StreamModel::kPixel:
      return make_physical_pixels(options_, first);
    case StreamModel::kQuantised:
    case StreamModel::kReferenceAware:
      break;
  }
  return make_step_pixels(options_, first);
}

void EventStream::rest(const LightSegment& segment) {
  E2LF_REQUIRE(!pixels_, "pixels rest before they see anything");
  pixels_ = make_pixels(segment);
  now_us_ = segment.begin_us;
  parts_.resize((height_ * width_ + kPartPixels - 1) / kPartPixels);
}

void EventStream::advance(const LightSegment& segment, recordings::EventColumns& events) {
  const size_t count = height_ * width_;
  E2LF_REQUIRE(segment.from.size() == count && segment.to.size() == count, "a segment lights every pixel");
  const int64_t duration_us = segment.end_us - segment.begin_us;
  E2LF_REQUIRE(duration_us > 0 && duration_us < std::numeric_limits<int32_t>::max(), "a segment takes time");
  E2LF_REQUIRE(segment.pattern_begin_us <= segment.begin_us && segment.end_us <= segment.pattern_end_us,
               "a segment lies in its pattern");
  if (!pixels_) rest(segment);
  E2LF_REQUIRE(segment.begin_us == now_us_, "segments follow on each other");
  now_us_ = segment.end_us;
  for (auto& part : parts_) part.clear();
  pixels_->advance(segment, parts_);
  const size_t begin = events.size();
  append_in_time(parts_, segment, width_, events);
  readout_.pass(events, begin);
}

}  // namespace e2lf::streams
