// SPDX-License-Identifier: MIT
#include "bench/simulate/benchmark_simulate.h"

#include <algorithm>
#include <chrono>

#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/reference.h"

namespace e2lf::bench {
namespace {

constexpr size_t kViews = 8;

lightfield::LightField noise_light_field(size_t height, size_t width) {
  lightfield::LightField light_field({kViews, kViews, height, width});
  const CounterRng rng(0, 0);
  const auto data = light_field.data();
  parallel_for(data.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) data[i] = rng.uniform(i);
  });
  return light_field;
}

capture::Codes sparse_codes(size_t num_patterns) {
  capture::Codes codes(num_patterns, kViews, kViews);
  const CounterRng rng(0, 1);
  for (size_t i = codes.pattern_size(); i < codes.values.size(); ++i) codes.values[i] = rng.below(i, 6) == 0 ? 1 : 0;
  return codes;
}

/// Returns megapixels per second of the fastest run of `work`, which returns a Result.
template <typename Work>
Result<double> measure(const SimulationBenchmarkOptions& options, const Work& work) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::duration time) { return std::chrono::duration<double>(time).count(); };
  const auto begin = Clock::now();
  double best_s = 0;
  for (int run = 0; run < 2 || seconds(Clock::now() - begin) < options.seconds; ++run) {
    const auto start = Clock::now();
    if (auto result = work(); !result) return result.error();
    const double run_s = seconds(Clock::now() - start);
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
  }
  return static_cast<double>(options.height * options.width) * 1e-6 / best_s;
}

}  // namespace

Result<SimulationBenchmark> benchmark_simulation(const SimulationBenchmarkOptions& options) {
  const lightfield::LightField light_field = noise_light_field(options.height, options.width);
  const capture::Codes codes = sparse_codes(options.num_patterns);
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities intensities, sensor::coded_intensities(codes, light_field));
  E2LF_RETURN_IF_ERROR(sensor::validate(options.model));

  const auto reference_intensities = [&] { return sensor::reference_coded_intensities(codes, light_field); };
  const auto reference_events = [&] { return sensor::reference_simulate_events(intensities, options.model); };
  const auto reference_simulate = [&]() -> Result<capture::EventImages> {
    E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities coded, reference_intensities());
    return sensor::reference_simulate_events(coded, options.model);
  };
  SimulationBenchmark result;
  E2LF_ASSIGN_OR_RETURN(result.intensities_mpx_per_s,
                        measure(options, [&] { return sensor::coded_intensities(codes, light_field); }));
  E2LF_ASSIGN_OR_RETURN(result.events_mpx_per_s,
                        measure(options, [&] { return sensor::simulate_events(intensities, options.model); }));
  E2LF_ASSIGN_OR_RETURN(result.simulate_mpx_per_s,
                        measure(options, [&] { return sensor::simulate_events(codes, light_field, options.model); }));
  E2LF_ASSIGN_OR_RETURN(result.reference_intensities_mpx_per_s, measure(options, reference_intensities));
  E2LF_ASSIGN_OR_RETURN(result.reference_events_mpx_per_s, measure(options, reference_events));
  E2LF_ASSIGN_OR_RETURN(result.reference_simulate_mpx_per_s, measure(options, reference_simulate));
  return result;
}

}  // namespace e2lf::bench
