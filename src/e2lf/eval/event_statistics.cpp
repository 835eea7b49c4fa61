// SPDX-License-Identifier: MIT
#include "e2lf/eval/event_statistics.h"

#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "e2lf/base/contract.h"

namespace e2lf::eval {

EventStatistics event_cost(double total_events_per_pixel, const EventRateOptions& options) {
  E2LF_REQUIRE(options.sensor_events_per_s > 0 && options.sensor_width * options.sensor_height > 0,
               "the sensor needs pixels and a throughput");
  E2LF_REQUIRE(options.num_views > 0, "a light field needs views");
  const auto sensor_pixels = static_cast<double>(options.sensor_width * options.sensor_height);
  const double events_per_pixel_per_s = options.sensor_events_per_s / sensor_pixels;
  const auto views = static_cast<double>(options.num_views);

  EventStatistics statistics;
  statistics.total_events_per_pixel = total_events_per_pixel;
  statistics.min_measurement_ms = 1e3 * total_events_per_pixel / events_per_pixel_per_s;
  statistics.bits_per_sensor_pixel = total_events_per_pixel * options.bits_per_event;
  statistics.bits_per_light_field_pixel = statistics.bits_per_sensor_pixel / views;
  statistics.events_per_light_field_pixel = total_events_per_pixel / views;
  return statistics;
}

EventStatistics event_statistics(const capture::EventImages& images, const EventRateOptions& options) {
  E2LF_REQUIRE(images.image_size() > 0, "event images need pixels");
  std::vector<double> events_per_pixel;
  for (size_t transition = 0; transition < images.count; ++transition) {
    uint64_t events = 0;
    for (int16_t count : images.image(transition)) events += static_cast<uint64_t>(std::abs(int{count}));
    events_per_pixel.push_back(static_cast<double>(events) / static_cast<double>(images.image_size()));
  }
  auto statistics = event_cost(std::accumulate(events_per_pixel.begin(), events_per_pixel.end(), 0.0), options);
  statistics.events_per_pixel = std::move(events_per_pixel);
  return statistics;
}

double mean_event_difference(const capture::EventImages& a, const capture::EventImages& b) {
  E2LF_REQUIRE(a.count == b.count && a.height == b.height && a.width == b.width && !a.values.empty(),
               "event images of one shape");
  uint64_t sum = 0;
  for (size_t i = 0; i < a.values.size(); ++i) {
    sum += static_cast<uint64_t>(std::abs(int{a.values[i]} - int{b.values[i]}));
  }
  return static_cast<double>(sum) / static_cast<double>(a.values.size());
}

}  // namespace e2lf::eval
