// SPDX-License-Identifier: MIT
#include "bench/simulate/benchmark_simulate.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/event_stream.h"
#include "testing/event_reference.h"

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

namespace {

constexpr float kBrightness[] = {0.6F, 0.5F, 0.5F, 0.5F, 0.0F, 0.12F, 0.12F, 0.12F};
constexpr int64_t kPatternUs = 10592;
constexpr int kRuns = 2;

/// Sets the number of threads during its lifetime.
class ThreadCap {
 public:
  explicit ThreadCap(int threads) : before_(num_threads()) { set_num_threads(threads); }
  ~ThreadCap() { set_num_threads(before_); }
  ThreadCap(const ThreadCap&) = delete;
  ThreadCap& operator=(const ThreadCap&) = delete;

 private:
  int before_;
};

double clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Returns the events per second of the fastest cycle; `count` receives their number.
double measure(streams::EventStream stream, const std::vector<std::vector<float>>& images, double (*now_s)(),
               uint64_t& count) {
  double best_s = 0;
  int64_t now_us = 0;
  uint64_t pattern = 0;
  for (int run = 0; run < kRuns; ++run) {
    recordings::EventColumns events;
    const double begin_s = now_s();
    for (const auto& image : images) {
      const bool is_black = image.front() == 0.0F;
      stream.advance({now_us, now_us + kPatternUs, image, image, pattern++, now_us, now_us + kPatternUs, is_black},
                     events);
      now_us += kPatternUs;
    }
    const double run_s = now_s() - begin_s;
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
    count = events.size();
  }
  return static_cast<double>(count) / best_s;
}

}  // namespace

Result<StreamBenchmark> benchmark_stream(const streams::StreamOptions& options, size_t height, size_t width) {
  std::vector<std::vector<float>> images;
  for (const float brightness : kBrightness) {
    auto& image = images.emplace_back(height * width);
    const CounterRng rng(0, images.size());
    for (size_t i = 0; i < image.size(); ++i) image[i] = brightness * rng.uniform(i);
  }
  const auto stream = [&] { return streams::EventStream::create(options, height, width); };
  StreamBenchmark result;
  E2LF_ASSIGN_OR_RETURN(streams::EventStream all_threads, stream());
  result.events_per_s = measure(std::move(all_threads), images, clock_s, result.events);
  const ThreadCap one(1);
  E2LF_ASSIGN_OR_RETURN(streams::EventStream one_thread, stream());
  result.one_thread_events_per_s = measure(std::move(one_thread), images, processor_s, result.events);
  E2LF_RETURN_IF_ERROR(set_max_isa("scalar"));
  E2LF_ASSIGN_OR_RETURN(streams::EventStream reference, stream());
  result.reference_events_per_s = measure(std::move(reference), images, processor_s, result.events);
  E2LF_RETURN_IF_ERROR(set_max_isa(""));
  E2LF_RETURN_IF_ERROR(apply_isa_cap());
  return result;
}

}  // namespace e2lf::bench
