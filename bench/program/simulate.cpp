// SPDX-License-Identifier: MIT
// e2lf-bench simulate: measures the simulation of events against the scalar reference.
#include <algorithm>
#include <ctime>

#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/streams/event_stream.h"
#include "testing/event_reference.h"

namespace e2lf::bench {
using namespace program;
namespace {

constexpr size_t kViews = 8;
constexpr size_t kPatterns =
    4;  ///< the first is black; in the others, about one cell in six is open, as in learned ones

struct SimulationBench {
  size_t height = 720, width = 1280;
  double seconds = 1.0;  ///< for each measured function, which runs at least twice
};

lightfield::LightField noise_light_field(size_t height, size_t width) {
  lightfield::LightField light_field({kViews, kViews, height, width});
  const CounterRng rng(0, 0);
  const auto data = light_field.data();
  parallel_for(data.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) data[i] = rng.uniform(i);
  });
  return light_field;
}

capture::Codes sparse_codes() {
  capture::Codes codes(kPatterns, kViews, kViews);
  const CounterRng rng(0, 1);
  for (size_t i = codes.pattern_size(); i < codes.values.size(); ++i) codes.values[i] = rng.below(i, 6) == 0 ? 1 : 0;
  return codes;
}

/// Returns megapixels per second of the fastest run of `work`, which returns a Result. They include all transitions of
/// a cycle.
template <typename Work>
Result<double> measure(const SimulationBench& options, const Work& work) {
  double best_s = 0, sum_s = 0;
  for (int run = 0; run < 2 || sum_s < options.seconds; ++run) {
    E2LF_ASSIGN_OR_RETURN(const double run_s, seconds_of(work));
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
    sum_s += run_s;
  }
  return static_cast<double>(options.height * options.width) * 1e-6 / best_s;
}

template <typename Work, typename Reference>
Result<Json> compare(const SimulationBench& options, const Work& work, const Reference& reference) {
  E2LF_ASSIGN_OR_RETURN(const double ours, measure(options, work));
  E2LF_ASSIGN_OR_RETURN(const double theirs, measure(options, reference));
  return Json{{"mpx_per_s", ours}, {"reference_mpx_per_s", theirs}, {"ratio", ours / theirs}};
}

/// Measures the simulation of an 8x8 light field of noise.
Result<Json> measure_images(const SimulationBench& options) {
  const lightfield::LightField light_field = noise_light_field(options.height, options.width);
  const capture::Codes codes = sparse_codes();
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities intensities, sensor::coded_intensities(codes, light_field));
  const sensor::EventModelOptions model;
  Json json;
  const auto reference_intensities = [&] { return sensor::reference_coded_intensities(codes, light_field); };
  E2LF_ASSIGN_OR_RETURN(
      json["coded_intensities"],
      compare(
          options, [&] { return sensor::coded_intensities(codes, light_field); }, reference_intensities));
  E2LF_ASSIGN_OR_RETURN(json["events"], compare(
                                            options, [&] { return sensor::simulate_events(intensities, model); },
                                            [&] { return sensor::reference_simulate_events(intensities, model); }));
  E2LF_ASSIGN_OR_RETURN(json["light_field_to_events"],
                        compare(
                            options, [&] { return sensor::simulate_events(codes, light_field, model); },
                            [&]() -> Result<capture::EventImages> {
                              E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities coded, reference_intensities());
                              return sensor::reference_simulate_events(coded, model);
                            }));
  return json;
}

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
double measure_stream(streams::EventStream stream, const std::vector<std::vector<float>>& images, double (*now_s)(),
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

/// Measures eight patterns of noise, event by event: the first half bright, then black, then dim ones, as in the
/// paper's cycle. A single thread is measured by its processor time, which depends little on the load of the machine.
Result<Json> measure_events(const streams::StreamOptions& options, size_t height, size_t width) {
  std::vector<std::vector<float>> images;
  for (const float brightness : kBrightness) {
    auto& image = images.emplace_back(height * width);
    const CounterRng rng(0, images.size());
    for (size_t i = 0; i < image.size(); ++i) image[i] = brightness * rng.uniform(i);
  }
  const auto stream = [&] { return streams::EventStream::create(options, height, width); };
  uint64_t events = 0;  // in one cycle
  E2LF_ASSIGN_OR_RETURN(streams::EventStream all_threads, stream());
  const double events_per_s = measure_stream(std::move(all_threads), images, clock_s, events);
  const ThreadCap one(1);
  E2LF_ASSIGN_OR_RETURN(streams::EventStream one_thread, stream());
  const double one_thread_events_per_s = measure_stream(std::move(one_thread), images, processor_s, events);
  E2LF_RETURN_IF_ERROR(set_max_isa("scalar"));
  E2LF_ASSIGN_OR_RETURN(streams::EventStream reference, stream());
  const double reference_events_per_s = measure_stream(std::move(reference), images, processor_s, events);
  E2LF_RETURN_IF_ERROR(set_max_isa(""));
  E2LF_RETURN_IF_ERROR(apply_isa_cap());
  return Json{{"events", events},
              {"events_per_s", events_per_s},
              {"one_thread_events_per_s", one_thread_events_per_s},
              {"reference_events_per_s", reference_events_per_s}};
}

BenchReport simulation_report(const Json& json) {
  report::Table table{"Millions of pixels per second; the reference runs on one thread.",
                      {{"simulation, M pixels/s"}, {"e2lf", true}, {"reference", true}, {"ratio", true}},
                      {}};
  for (const auto& [name, values] : json.items()) {
    if (!values.contains("mpx_per_s")) continue;
    table.rows.push_back({report::text_cell(name), number_of(values, "mpx_per_s", 1),
                          number_of(values, "reference_mpx_per_s", 2), number_of(values, "ratio", 1)});
  }
  report::Table by_event{
      "Event by event, physical pixels.",
      {{"event by event, M events/s"}, {"all threads", true}, {"one thread", true}, {"reference", true}},
      {}};
  const Json& stream = json["event_by_event"];
  by_event.rows.push_back({report::text_cell("physical pixels"), number_of(stream, "events_per_s", 2, 1e-6),
                           number_of(stream, "one_thread_events_per_s", 2, 1e-6),
                           number_of(stream, "reference_events_per_s", 2, 1e-6)});
  return {"Speed of simulation",
          cat(num_threads(), " threads, ", current_isa(), "; the scalar reference in the same run"),
          {table, by_event}};
}

}  // namespace

int run_simulate(const std::vector<std::string>& arguments) {
  Verb verb("simulate", "Measure the event simulation against the scalar reference on one thread, in the same run.",
            "e2lf-bench simulate --json");
  SimulationBench options;
  add_size_options(verb, options.width, options.height);
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  const auto measure_all = [&]() -> Result<Json> {
    RunRecord record(verb);
    E2LF_ASSIGN_OR_RETURN(const capture::SensorProfile camera, load_camera("evk4-lcos", record));
    E2LF_ASSIGN_OR_RETURN(Json json, measure_images(options));
    E2LF_ASSIGN_OR_RETURN(json["event_by_event"],
                          measure_events(streams::camera_stream(camera, 1), options.height, options.width));
    return json;
  };
  return run_bench(verb, arguments, measure_all, simulation_report);
}

}  // namespace e2lf::bench
