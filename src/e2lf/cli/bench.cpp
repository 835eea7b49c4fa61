// SPDX-License-Identifier: MIT
// e2lf bench reconstruct | decode | simulate
#include <cstdio>

#include "e2lf/cli/verb.h"
#include "e2lf/sensor/benchmark.h"

namespace e2lf::cli {
namespace {

int run_bench_simulate(const std::vector<std::string>& arguments) {
  Verb verb("bench simulate",
            "Measure the event simulation against the scalar reference on one thread, in the same run.",
            "e2lf bench simulate --json");
  sensor::SimulationBenchmarkOptions options;
  verb.app().add_option("--width", options.width)->capture_default_str();
  verb.app().add_option("--height", options.height)->capture_default_str();
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const sensor::SimulationBenchmark result, sensor::benchmark_simulation(options));
    const auto row = [](double ours, double reference) {
      return Json{{"mpx_per_s", ours}, {"reference_mpx_per_s", reference}, {"ratio", ours / reference}};
    };
    const Json json = {{"coded_intensities", row(result.intensities_mpx_per_s, result.reference_intensities_mpx_per_s)},
                       {"events", row(result.events_mpx_per_s, result.reference_events_mpx_per_s)},
                       {"light_field_to_events", row(result.simulate_mpx_per_s, result.reference_simulate_mpx_per_s)}};
    if (verb.common().json) {
      std::printf("%s\n", json.dump(2).c_str());
      return {};
    }
    std::printf("%-24s %12s %12s %8s\n", "simulation, M pixels/s", "e2lf", "reference", "ratio");
    for (const auto& [name, values] : json.items()) {
      std::printf("%-24s %12.1f %12.2f %8.1f\n", name.c_str(), values["mpx_per_s"].get<double>(),
                  values["reference_mpx_per_s"].get<double>(), values["ratio"].get<double>());
    }
    return {};
  });
}

}  // namespace

int run_bench(const std::vector<std::string>& arguments) {
  return run_subverb("bench", {{"simulate", "the event simulation, against the scalar reference", run_bench_simulate}},
                     arguments);
}

}  // namespace e2lf::cli
