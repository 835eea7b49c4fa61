// SPDX-License-Identifier: MIT
#include "e2lf/compare/view_scan.h"

#include <chrono>

#include "e2lf/base/text.h"
#include "e2lf/cycles/event_windows.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::compare {
namespace {

constexpr size_t kSide = 8, kViews = kSide * kSide;
constexpr int64_t kViewUs = 10000;  // for which each view is shown
constexpr int64_t kFrameUs = 1000;  // the frame interval of v2e

/// The line and the position in it at step `i` of a back-and-forth path along lines of 8.
struct Place {
  size_t line, step;
};

Place to_and_fro(size_t i) {
  const size_t line = i / kSide, step = i % kSide;
  return {line, line % 2 == 0 ? step : kSide - 1 - step};
}

Result<streams::EventStream> make_stream(const ScanOptions& options, const lightfield::Shape& shape) {
  streams::StreamOptions stream;
  stream.model = streams::StreamModel::kV2e;
  stream.v2e.pos_thres = stream.v2e.neg_thres = options.tau;
  stream.v2e.frame_us = kFrameUs;
  stream.seed = stream.map_seed = options.seed;
  return streams::EventStream::create(stream, shape.height, shape.width);
}

/// Records the events of a view that is shown, by a camera in the steady state for the first one.
recordings::EventColumns show(const lightfield::LightField& scene, const ScanOptions& options, size_t number,
                              size_t view, streams::EventStream& stream) {
  const size_t size = scene.shape().view_size();
  const auto values = std::span(scene.data()).subspan(view * size, size);
  std::vector<float> light(size);
  for (size_t i = 0; i < size; ++i) light[i] = options.gain * values[i];
  streams::LightSegment segment;
  segment.begin_us = segment.pattern_begin_us = static_cast<int64_t>(number) * kViewUs;
  segment.end_us = segment.pattern_end_us = segment.begin_us + kViewUs;
  segment.from = segment.to = light;
  segment.pattern = number;
  recordings::EventColumns events;
  stream.advance(segment, events);
  return events;
}

}  // namespace

std::vector<size_t> scan_order() {
  std::vector<size_t> order;
  for (size_t i = 0; i < kViews; ++i) {
    const Place place = to_and_fro(i);
    order.push_back(place.line * kSide + place.step);
  }
  // The first scan ends at the left of the last row. The columns begin there, upwards.
  for (size_t i = 1; i < kViews; ++i) {
    const Place place = to_and_fro(i);
    order.push_back((kSide - 1 - place.step) * kSide + place.line);
  }
  return order;
}

Result<ScanResult> scan_to_light_field(const video::VideoModel& model, const lightfield::LightField& scene,
                                       const ScanOptions& options, const ProgressFn& progress) {
  const lightfield::Shape& shape = scene.shape();
  if (shape.views_y != kSide || shape.views_x != kSide || shape.channels != 1) {
    return fail(ErrorCode::kShape, "", "a scan of views requires 8x8 grey views, but the light field has ",
                shape.views_y, "x", shape.views_x, " of ", shape.channels, " channels; convert it first");
  }
  E2LF_ASSIGN_OR_RETURN(streams::EventStream stream, make_stream(options, shape));
  E2LF_ASSIGN_OR_RETURN(auto video, video::EventVideo::create(model, shape.height, shape.width));
  ScanResult result;
  result.light_field = lightfield::LightField(shape);
  const std::vector<size_t> order = scan_order();
  const size_t second_begin = order.size() - kViews;
  size_t num_events = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (progress) progress(i, order.size());
    const recordings::EventColumns events = show(scene, options, i, order[i], stream);
    num_events += events.size();
    if (i == 0) continue;  // nothing has changed yet
    const auto begin = std::chrono::steady_clock::now();
    E2LF_ASSIGN_OR_RETURN(std::vector<float> frame,
                          video.next(cycles::voxelise(events, model.bins, shape.height, shape.width)));
    result.reconstruct_s += seconds_since(begin);
    if (i < second_begin) continue;
    video::apply_frame_tone(model.tone, frame);
    std::copy(frame.begin(), frame.end(),
              result.light_field.data().begin() + static_cast<std::ptrdiff_t>(order[i] * frame.size()));
  }
  result.events_per_pixel = static_cast<double>(num_events) / static_cast<double>(shape.view_size());
  result.measurement_ms = static_cast<double>(order.size()) * static_cast<double>(kViewUs) / 1000;
  return result;
}

}  // namespace e2lf::compare
