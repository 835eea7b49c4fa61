// SPDX-License-Identifier: MIT
#include "e2lf/streams/pixel_events.h"

#include <algorithm>

namespace e2lf::streams {
namespace {

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

void append_in_time(const std::vector<std::vector<PixelEvent>>& parts, const LightSegment& segment, size_t width,
                    recordings::EventColumns& columns) {
  size_t place = columns.size(), count = 0;
  for (const auto& part : parts) count += part.size();
  columns.resize(place + count);
  const auto put = [&](size_t at, PixelEvent event) {
    columns.x[at] = static_cast<uint16_t>(event.pixel() % width);
    columns.y[at] = static_cast<uint16_t>(event.pixel() / width);
    columns.p[at] = static_cast<uint8_t>(event.is_on());
    columns.t[at] = segment.begin_us + event.offset_us();
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
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](PixelEvent a, PixelEvent b) { return a.offset_us() < b.offset_us(); });
  for (const PixelEvent event : sorted) put(place++, event);
}

}  // namespace e2lf::streams
