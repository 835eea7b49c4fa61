// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/recordings/event.h"

namespace e2lf::streams {

/// The models that turn light into individual events.
enum class StreamModel {
  kQuantised,       ///< Eq. 8: events of a pattern count from the light at the end of the previous one
  kReferenceAware,  ///< Eq. 9, 10: a pixel remembers the log intensity of its last event
  kEsim,            ///< crossings found by linear interpolation of the log intensity
  kV2e,             ///< frame by frame: lin-log, low pass, mismatched thresholds, leak, shot noise
  kPixel,           ///< photoreceptor, amplifier, mismatched thresholds, noise: capture::PixelConstants
};

/// Parses "quantised", "reference-aware", "esim", "v2e" or "pixel". Fails with kInvalidValue for any other name.
[[nodiscard]] Result<StreamModel> stream_model_from_name(const std::string& name);
[[nodiscard]] const char* stream_model_name(StreamModel model);

/// The parameters of v2e, with the names and defaults of its command line.
struct V2eOptions {
  float pos_thres = 0.2F, neg_thres = 0.2F;  ///< mean thresholds, in natural logarithm
  float sigma_thres = 0.03F;                 ///< their standard deviation from pixel to pixel
  float cutoff_hz = 300.0F;                  ///< cutoff of the low pass in white light; 0 = no low pass
  float leak_rate_hz = 0.01F;                ///< ON events per pixel in constant light
  float leak_jitter_fraction = 0.1F;         ///< variation of the leak from frame to frame
  float noise_rate_cov_decades = 0.1F;       ///< spread of the leak from pixel to pixel
  float shot_noise_rate_hz = 0.001F;         ///< rate of both signs together, in the dark
  float refractory_period_s = 0.0005F;
  int64_t frame_us = 500;  ///< frame interval; v2e calls it timestamp_resolution
};

/// Returns the preset "noisy", "clean" or "default" of v2e. Fails with kInvalidValue for any other name.
[[nodiscard]] Result<V2eOptions> v2e_preset(const std::string& name);

/// Properties of a pixel of the model kPixel in addition to capture::PixelConstants. By default, there are none.
struct PixelDefects {
  double refractory_us = 0;  ///< blind time after an event, after which the pixel restarts from its level
  double leak_rate_hz = 0;   ///< ON events per pixel in constant light, due to a sinking reference
  double shot_rate_hz = 0;   ///< spurious events of either sign in the dark; decreases as eps / (I + eps)
  double hot_share = 0;      ///< share of pixels that fire permanently
  double hot_rate_hz = 1000;
};

/// The limited event rate of the readout. Events wait, and are lost if they would wait too long.
struct ReadoutLimit {
  double events_per_s = 0;   ///< 0 = no limit; 1.066e9 for a Prophesee EVK4
  double longest_us = 1000;  ///< an event that would wait longer is lost
};

struct StreamOptions {
  StreamModel model = StreamModel::kReferenceAware;
  /// For the models of the paper. kEsim uses eps, tau for both thresholds, and sigma_z for their spread from segment to
  /// segment.
  capture::SensorConstants constants = {};
  double esim_refractory_us = 0;
  V2eOptions v2e = {};
  capture::PixelConstants pixel = {};
  PixelDefects defects = {};
  ReadoutLimit readout = {};
  uint64_t seed = 1;      ///< seed of the noise
  uint64_t map_seed = 1;  ///< seed of the constant properties of a pixel: its thresholds and whether it is hot
};

/// Checks the options. Fails with kInvalidValue, naming the one that is not finite or out of range.
[[nodiscard]] Result<void> validate(const StreamOptions& options);

/// Returns the stream options for a camera file: its event model and constants. `seed` identifies a capture and also
/// selects the map of pixel properties.
[[nodiscard]] StreamOptions camera_stream(const capture::SensorProfile& camera, uint64_t seed);

/// A period in which the light on each pixel changes linearly, from `from` at begin_us to `to` at end_us. Both are
/// images [y, x] of intensities, where 1 is the white of the light field through an open aperture; they may be the same
/// span. Light may jump between segments. A pattern of the aperture is shown in one segment or in several consecutive
/// ones.
struct LightSegment {
  int64_t begin_us = 0, end_us = 0;
  std::span<const float> from, to;
  uint64_t pattern = 0;  ///< counted from the first pattern of the stream, not of its cycle
  int64_t pattern_begin_us = 0, pattern_end_us = 0;
  bool is_black = false;  ///< true if all cells of the pattern are closed

  [[nodiscard]] bool begins_pattern() const { return begin_us == pattern_begin_us; }
};

/// An event of a segment in eight bytes: microseconds since the beginning of the segment (31 bits), pixel number (32)
/// and sign (1).
class PixelEvent {
 public:
  PixelEvent() = default;
  PixelEvent(uint32_t offset_us, uint32_t pixel, bool is_on)
      : bits_(uint64_t{offset_us} << 33 | uint64_t{pixel} << 1 | uint64_t{is_on}) {}

  [[nodiscard]] uint32_t offset_us() const { return static_cast<uint32_t>(bits_ >> 33); }
  [[nodiscard]] uint32_t pixel() const { return static_cast<uint32_t>(bits_ >> 1); }
  [[nodiscard]] bool is_on() const { return (bits_ & 1) != 0; }

 private:
  uint64_t bits_ = 0;
};

/// Collects the events of one pixel after another.
class PixelEventSink {
 public:
  PixelEventSink(std::vector<PixelEvent>& events, int64_t duration_us)
      : events_(&events), last_us_(static_cast<double>(duration_us - 1)) {}

  /// Adds an event `offset_us` after the beginning of the segment. The time is rounded down and clamped to the segment.
  /// Consecutive events of one pixel are at least a microsecond apart, as a sensor cannot send two at once.
  void add(double offset_us, size_t pixel, bool is_on) {
    double clamped = offset_us > 0 ? offset_us : 0;
    if (pixel == pixel_ && clamped < next_us_) clamped = next_us_;
    const auto time_us = static_cast<uint32_t>(clamped < last_us_ ? clamped : last_us_);
    events_->emplace_back(time_us, static_cast<uint32_t>(pixel), is_on);
    pixel_ = pixel;
    next_us_ = time_us + 1.0;
  }

 private:
  std::vector<PixelEvent>* events_;
  double last_us_;
  size_t pixel_ = SIZE_MAX;  ///< of the last event
  double next_us_ = 0;       ///< the earliest time of another event of this pixel
};

/// Appends the events of one segment, given as consecutive parts, to `columns` in order of time. Events of the same
/// time keep their order.
void append_in_time(const std::vector<std::vector<PixelEvent>>& parts, const LightSegment& segment, size_t width,
                    recordings::EventColumns& columns);

/// The number of pixels that are processed together.
inline constexpr size_t kPartPixels = 4096;

/// Calls body(part, begin, end) in parallel for the pixels [begin, end) of each of the parts of `count` pixels.
template <typename Body>
void for_parts(size_t count, const Body& body) {
  parallel_for((count + kPartPixels - 1) / kPartPixels, 1, [&](size_t first, size_t last) {
    for (size_t part = first; part < last; ++part) {
      body(part, part * kPartPixels, std::min((part + 1) * kPartPixels, count));
    }
  });
}

/// The pixels of a sensor with their state, which is carried from segment to segment.
class StreamPixels {
 public:
  virtual ~StreamPixels() = default;

  /// Follows every pixel through a segment. parts[i] receives the events of pixels [i, i + 1) * kPartPixels, ordered by
  /// pixel or by time; those of one pixel are in order of time.
  virtual void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) = 0;
};

/// Pixels that are independent of each other: each is followed through the whole segment by itself.
class SinglePixels : public StreamPixels {
 public:
  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override;

 protected:
  explicit SinglePixels(size_t count) : count_(count) {}
  [[nodiscard]] size_t count() const { return count_; }
  /// Returns the number of segments before this one.
  [[nodiscard]] uint64_t segment_number() const { return segment_number_; }

  /// Follows the pixels [begin, end) of one part.
  virtual void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) = 0;

 private:
  size_t count_;
  uint64_t segment_number_ = 0;
};

/// Make pixels in the steady state for the light of `first`. Under the cap "scalar" of base/isa.h, physical pixels use
/// the plain arithmetic of the C library, as the reference for the fast ones.
[[nodiscard]] std::unique_ptr<StreamPixels> make_step_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_esim_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_v2e_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_physical_pixels(const StreamOptions& options,
                                                                 const LightSegment& first);

/// The readout of a sensor: events leave one after another, at least 1 / events_per_s apart, and get the time at which
/// they leave. An event that would wait longer than longest_us is lost.
class ReadoutQueue {
 public:
  explicit ReadoutQueue(const ReadoutLimit& limit)
      : interval_us_(limit.events_per_s > 0 ? 1e6 / limit.events_per_s : 0), longest_us_(limit.longest_us) {}

  /// Passes the events from `begin` on through the queue. They must be in order of time and not earlier than the
  /// previous ones.
  void pass(recordings::EventColumns& events, size_t begin);

  [[nodiscard]] uint64_t lost() const { return lost_; }

 private:
  double interval_us_, longest_us_;
  double free_us_ = -1e300;  ///< the time at which the next event can leave
  uint64_t lost_ = 0;
};

/// Simulates the individual events of an event camera from the light over time. Each event occurs at the microsecond in
/// which the signal of the pixel crosses its threshold. The state of the pixels (references, thresholds and noise) is
/// carried from segment to segment and thus from cycle to cycle. The result is identical, event for event, for any
/// number of threads.
///
///   auto stream = EventStream::create(options, height, width);
///   while (...) stream->advance(segment, events);
class EventStream {
 public:
  /// Fails as validate(StreamOptions) does, and with kShape (no pixels, or more than 65,536 in a row or column).
  [[nodiscard]] static Result<EventStream> create(const StreamOptions& options, size_t height, size_t width);

  /// Sets the pixels to the steady state for the light `from` of the segment, without events. It may only be called
  /// before the first segment, which begins with this light.
  void rest(const LightSegment& segment);

  /// Appends the events of the next segment, in order of time. Without rest(), the pixels begin in the steady state for
  /// the light `from` of the first segment. Segments must be contiguous and shorter than 35 minutes, or the contract is
  /// broken. With a readout limit, events may come after the end of the segment, but never after events of the next
  /// one.
  void advance(const LightSegment& segment, recordings::EventColumns& events);

  [[nodiscard]] uint64_t lost_events() const {
    return readout_.lost();
  }  ///< number of events lost to the readout limit

 private:
  EventStream(const StreamOptions& options, size_t height, size_t width);
  [[nodiscard]] std::unique_ptr<StreamPixels> make_pixels(const LightSegment& first) const;

  StreamOptions options_;
  size_t height_, width_;
  int64_t now_us_ = 0;
  std::unique_ptr<StreamPixels> pixels_;
  std::vector<std::vector<PixelEvent>> parts_;
  ReadoutQueue readout_;
};

}  // namespace e2lf::streams
