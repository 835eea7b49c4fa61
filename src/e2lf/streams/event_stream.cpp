// SPDX-License-Identifier: MIT
#include "e2lf/streams/event_stream.h"

#include <algorithm>
#include <limits>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf::streams {

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
  constexpr size_t kMost = size_t{std::numeric_limits<uint16_t>::max()} + 1;
  if (height < 1 || width < 1 || height > kMost || width > kMost || height * width > kMost * kMost - 1) {
    return fail(ErrorCode::kShape, "", "a sensor of ", width, "x", height, " pixels cannot be; use 1 to ", kMost);
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
