// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::eval {

/// The properties of a sensor that relate event counts to time and data rate. The defaults are those of the paper: a
/// Prophesee EVK4, and 29 bits per event in coordinate (COO) form.
struct EventRateOptions {
  double sensor_events_per_s = 1.066e9;  ///< throughput of the whole sensor
  size_t sensor_width = 1280, sensor_height = 720;
  double bits_per_event = 29;
  size_t num_views = 64;  ///< views of the light field that the events encode
};

/// The cost of a measurement in events, time and data.
struct EventStatistics {
  std::vector<double> events_per_pixel;  ///< mean of |E| for each transition
  double total_events_per_pixel = 0;     ///< their sum
  double min_measurement_ms = 0;  ///< total / (throughput per pixel), the lower limit for a sensor of this throughput
  double bits_per_sensor_pixel = 0;         ///< total * bits per event
  double bits_per_light_field_pixel = 0;    ///< bits_per_sensor_pixel / number of views
  double events_per_light_field_pixel = 0;  ///< total / number of views
};

/// Counts the events of one cycle. An event image holds the sum of signed events, in which ON and OFF events of a pixel
/// within one transition cancel. The figures are therefore lower bounds for noisy recordings. Images without pixels and
/// rates that are not positive break the contract.
[[nodiscard]] EventStatistics event_statistics(const capture::EventImages& images,
                                               const EventRateOptions& options = {});

/// Returns the mean of |a - b| over pixels and transitions. Images of different shapes break the contract.
[[nodiscard]] double mean_event_difference(const capture::EventImages& a, const capture::EventImages& b);

/// Computes time and data rate for a known number of events per pixel. `events_per_pixel` is left empty.
[[nodiscard]] EventStatistics event_cost(double total_events_per_pixel, const EventRateOptions& options = {});

}  // namespace e2lf::eval
