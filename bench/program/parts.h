// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"
#include "e2lf/program/verb.h"
#include "e2lf/report/table.h"

/// The verbs of e2lf-bench, and what they share: options, output, timing, random networks and peers.
namespace e2lf::bench {

using program::Verb;

/// Each implements the verb of its name, and returns the exit code of the process.
int run_camera(const std::vector<std::string>& arguments);
int run_decode(const std::vector<std::string>& arguments);
int run_depth(const std::vector<std::string>& arguments);
int run_motion(const std::vector<std::string>& arguments);
int run_reconstruct(const std::vector<std::string>& arguments);
int run_rig(const std::vector<std::string>& arguments);
int run_simulate(const std::vector<std::string>& arguments);
int run_train(const std::vector<std::string>& arguments);
int run_video(const std::vector<std::string>& arguments);

/// Adds the options of the size of an image.
void add_size_options(Verb& verb, size_t& width, size_t& height);

/// The results of a benchmark as text and tables.
struct BenchReport {
  std::string title, about;                ///< about: sizes, threads, and the meaning of the figures
  std::vector<report::Table> tables = {};  ///< captions are only shown on the page
  std::string note = {};                   ///< below the tables
};

/// Runs the verb of a benchmark: opens the files of --report before the work, and shows the figures of `measure` as
/// `describe` states them, or as JSON with --json. The files must not be among `inputs`. Returns the exit code of the
/// process.
int run_bench(Verb& verb, const std::vector<std::string>& arguments, const std::function<Result<Json>()>& measure,
              const std::function<BenchReport(const Json&)>& describe,
              const std::function<std::vector<std::filesystem::path>()>& inputs = {});

/// Returns a cell with the number of this name, the median of a timing, or nothing if the row has none.
[[nodiscard]] report::Cell number_of(const Json& row, const char* name, int decimals, double factor = 1);

struct Timing {
  double median = 0.0, min = 0.0, max = 0.0;
};

/// Returns the statistics of at least one measured time.
[[nodiscard]] Timing timing_of(std::vector<double> seconds);
[[nodiscard]] Json to_json(const Timing& timing);

/// Returns random weights that preserve the magnitude of values from layer to layer.
[[nodiscard]] model::Weights random_weights(const model::Network& network);

/// Returns a function of the module with a peer (e2lf_torch_peer.so, e2lf_onednn_peer.so) beside the program. If there
/// is none, returns null, and `absent` states the reason.
[[nodiscard]] void* find_in_peer(const char* module, const char* function, std::string& absent);

/// Returns the seconds that `work` takes, which returns a Result. Fails as it does.
template <typename Work>
[[nodiscard]] Result<double> seconds_of(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  if (const auto result = work(); !result) return result.error();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Returns inputs for a network, multiples of 1/8 between -1 and 1.
[[nodiscard]] std::vector<float> noise_input(const model::Network& network, size_t height, size_t width);

/// A network's runs in libtorch on an image. States are carried from run to run.
struct TorchRuns {
  std::string absent;           ///< why there are none; otherwise empty
  std::string name;             ///< with the version of libtorch
  std::vector<double> seconds;  ///< of each run
};

/// Runs a network in float32 in the peer's module. `output` receives the result of the last run.
[[nodiscard]] TorchRuns run_libtorch(const model::Network& network, const model::Weights& weights, size_t height,
                                     size_t width, size_t runs, const std::vector<float>& input,
                                     std::vector<float>& output);

/// The peak arithmetic throughput of this machine in operations per second (a multiply-add is two), measured by loops
/// that do nothing else.
struct Peak {
  double float32_flops = 0.0;
  double bfloat16_flops = 0.0;  ///< 0 if the CPU has no bfloat16 products
};

/// Measures the peak with num_threads() threads and the instruction set in use, as the best of several short loops
/// (half a second in total).
[[nodiscard]] Peak measure_peak();

/// The largest motion within two cycles that scenes have room for, px.
constexpr size_t kMostMotionPx = 16;

/// Returns the middle rows of a scene, and its columns after it moved to the left by `motion_px`, which is at most
/// `most_px`. The result has at most size x size pixels. Fails with kShape if the scene is narrower than most_px + 17
/// px.
[[nodiscard]] Result<lightfield::LightField> in_view(const lightfield::LightField& scene, size_t size, size_t motion_px,
                                                     size_t most_px = kMostMotionPx);

/// Returns the largest PSNR of a light field against these scenes, dB. It is scaled by its least-squares factor for
/// each, so that a network that was trained for another camera does not lose by brightness alone. Fails with kShape.
[[nodiscard]] Result<double> best_psnr_db(const lightfield::LightField& field,
                                          const std::vector<lightfield::LightField>& scenes);

}  // namespace e2lf::bench
