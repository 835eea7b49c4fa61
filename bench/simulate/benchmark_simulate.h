// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::bench {

struct SimulationBenchmarkOptions {
  size_t height = 720, width = 1280;
  size_t num_patterns = 4;  ///< the first is black; in the others, about one cell in six is open, as in learned ones
  double seconds = 1.0;     ///< for each measured function, which runs at least twice
  sensor::EventModelOptions model = {};
};

/// Millions of sensor pixels per second, including all transitions of a cycle; the best of all runs.
struct SimulationBenchmark {
  double intensities_mpx_per_s = 0;            ///< coded_intensities()
  double events_mpx_per_s = 0;                 ///< simulate_events() from coded intensities
  double simulate_mpx_per_s = 0;               ///< simulate_events() from the light field
  double reference_intensities_mpx_per_s = 0;  ///< the scalar reference on one thread
  double reference_events_mpx_per_s = 0;
  double reference_simulate_mpx_per_s = 0;  ///< both references in sequence
};

/// Measures the simulation of an 8x8 light field of noise. Fails as simulate_events() does.
[[nodiscard]] Result<SimulationBenchmark> benchmark_simulation(const SimulationBenchmarkOptions& options);

/// The speed of simulating individual events, in events per second, as the best of two cycles. A single thread is
/// measured by its processor time, which depends little on the load of the machine.
struct StreamBenchmark {
  uint64_t events = 0;      ///< in one cycle
  double events_per_s = 0;  ///< with all threads
  double one_thread_events_per_s = 0;
  double reference_events_per_s = 0;  ///< of the scalar reference on one thread
};

/// Measures eight patterns of noise: the first half bright, then black, then dim ones, as in the paper's cycle. Fails
/// as streams::EventStream::create() does.
[[nodiscard]] Result<StreamBenchmark> benchmark_stream(const streams::StreamOptions& options, size_t height,
                                                       size_t width);

}  // namespace e2lf::bench
