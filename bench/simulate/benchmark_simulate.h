// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/base/result.h"
#include "e2lf/sensor/event_model.h"

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

}  // namespace e2lf::bench
