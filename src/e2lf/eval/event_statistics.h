// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::eval {

/// What turns event counts into time and data rate; the defaults are the paper's: a Prophesee EVK4, and 29 bits for
/// each event in coordinate (COO) form.
struct EventRateOptions {
  double sensor_events_per_s = 1.066e9;  ///< throughput of the whole sensor
  size_t sensor_width = 1280, sensor_height = 720;
  double bits_per_event = 29;
  size_t num_views = 64;  ///< of the light field that the events stand for
};

/// What a measurement costs in events, time and data.
struct EventStatistics {
  std::vector<double> events_per_pixel;     ///< mean of |E| for each transition
  double total_events_per_pixel = 0;        ///< their sum
  double min_measurement_ms = 0;            ///< total / (throughput per pixel): no sensor of this rate can be faster
  double bits_per_sensor_pixel = 0;         ///< total * bits per event
  double bits_per_light_field_pixel = 0;    ///< the same divided by the number of views
  double events_per_light_field_pixel = 0;  ///< total / number of views
};

/// Counts the events of one cycle. An event image holds the sum of signed events, so ON and OFF events that cancel at a
/// pixel within one transition are not seen: the figures are lower bounds for noisy recordings. No pixels or rates
/// that are not positive break the contract.
[[nodiscard]] EventStatistics event_statistics(const capture::EventImages& images,
                                               const EventRateOptions& options = {});

/// The mean of |a - b| over pixels and transitions. Images of different shapes break the contract.
[[nodiscard]] double mean_event_difference(const capture::EventImages& a, const capture::EventImages& b);

/// Time and data rate for a known number of events per pixel; `events_per_pixel` is left empty.
[[nodiscard]] EventStatistics event_cost(double total_events_per_pixel, const EventRateOptions& options = {});

}  // namespace e2lf::eval
