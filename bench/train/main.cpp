// SPDX-License-Identifier: MIT
// e2lf-bench-train BATCH STEPS: the program that `e2lf-bench train` starts, so that only it needs torch. Prints JSON.
#include <ATen/Parallel.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <map>

#include "bench/peers/torch_peer.h"
#include "e2lf/files/options.h"
#include "e2lf/learn/data/synthesiser.h"
#include "e2lf/learn/run/torch_setup.h"
#include "e2lf/learn/run/trainer.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::learn {
namespace {

struct BenchmarkOptions {
  uint64_t batch = 4;  ///< number of samples of 64x64x8x8
  uint64_t steps = 5;  ///< measured steps, after two that warm up; the figure is their median
};

constexpr uint64_t kWarmUpSteps = 2, kPatch = 64;

/// Returns true if the CPU multiplies bfloat16 numbers. Otherwise, torch's emulation takes minutes per step.
bool has_bfloat16() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512bf16") != 0;
#else
  return true;
#endif
}

/// Returns the speed, given the seconds of each step.
double samples_per_s(uint64_t batch, std::vector<double> seconds) {
  seconds.erase(seconds.begin(), seconds.begin() + kWarmUpSteps);
  std::sort(seconds.begin(), seconds.end());
  return static_cast<double>(batch) / seconds[seconds.size() / 2];
}

Json row_of(const std::string& job, const std::string& name, const std::string& precision, uint64_t batch,
            const std::vector<double>& seconds) {
  return {{"job", job}, {"name", name}, {"precision", precision}, {"samples_per_s", samples_per_s(batch, seconds)}};
}

/// Returns the seconds of each step, including those that warm up.
template <typename Step>
Result<std::vector<double>> time_steps(uint64_t steps, const Step& step) {
  std::vector<double> seconds;
  for (uint64_t i = 0; i < steps + kWarmUpSteps; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    E2LF_RETURN_IF_ERROR(step());
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return seconds;
}

/// Runs the peer beside this program. Returns no rows if it was not built.
Result<Json> run_peer(const BenchmarkOptions& options) {
  std::error_code status;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", status);
  const auto path = (program.parent_path() / "e2lf_torch_peer.so").string();
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return Json::array();
  const auto train = reinterpret_cast<decltype(&e2lf_torch_training)>(::dlsym(module, "e2lf_torch_training"));
  std::vector<double> seconds(options.steps + kWarmUpSteps);
  const E2lfTorchTraining job{options.batch, kPatch, seconds.size(), seconds.data()};
  if (const char* problem = train == nullptr ? "it has another version" : train(&job)) {
    return Error{ErrorCode::kInternal, cat("the peer failed: ", problem, "; rebuild it"), path};
  }
  return Json::array({row_of("training", "paper's network, plain libtorch", "float32", options.batch, seconds)});
}

Result<Json> run_trainer(const BenchmarkOptions& options, const std::string& name, const Config& config) {
  E2LF_ASSIGN_OR_RETURN(auto trainer, Trainer::create(config));
  E2LF_ASSIGN_OR_RETURN(const auto seconds, time_steps(options.steps, [&] { return trainer.train_step(); }));
  return row_of("training", name, config.precision, options.batch, seconds);
}

/// Returns four surfaces, one behind another, as synthesise() makes them without photographs.
std::vector<Surface> random_surfaces(uint64_t seed, int64_t side) {
  Draws draws(seed, 0);
  torch::manual_seed(seed);
  std::vector<Surface> surfaces;
  for (const double disparity : {2.0, 0.7, -0.3, -1.5}) {
    const auto brightness = procedural_texture(side, draws, torch::kCPU);
    surfaces.push_back({{.centre = disparity, .slope_x = 0.01},
                        brightness,
                        surfaces.empty() ? torch::Tensor() : coverage(brightness, draws)});
  }
  return surfaces;
}

Result<void> append_synthesis(const BenchmarkOptions& options, Json& rows) {
  constexpr uint64_t kScenes = 16;
  constexpr int64_t kSize = 96, kSide = 118;
  std::vector<std::vector<Surface>> scenes;
  for (uint64_t seed = 0; seed < kScenes; ++seed) scenes.push_back(random_surfaces(seed, kSide));
  for (const auto& [name, render] : {std::pair{"torch's sampling", &views_of_reference}, {"e2lf", &views_of}}) {
    E2LF_ASSIGN_OR_RETURN(const auto seconds, time_steps(options.steps, [&, render = render]() -> Result<void> {
                            for (const auto& surfaces : scenes) (void)render(surfaces, kSize);
                            return {};
                          }));
    rows.push_back(row_of("synthesis", name, "float32", kScenes, seconds));
  }
  return {};
}

/// Measures two jobs. Training: whole steps on synthesised samples of 64x64x8x8 with a plain libtorch loop of the
/// paper's networks (the peer, omitted if its module is not beside the program), and with this trainer for the same
/// networks and for the default configuration, in float32 and, if the CPU supports it, bfloat16. Synthesis: the views
/// (96x96x8x8) of procedural surfaces with torch's sampling (the peer) and with e2lf. Fails as Trainer::create() does.
Result<Json> benchmark_training(const BenchmarkOptions& options, const ProgressFn& progress) {
  std::vector<const char*> precisions = {"float32"};
  if (has_bfloat16()) precisions.push_back("bfloat16");
  const uint64_t loops = 2 + 2 * precisions.size();
  E2LF_ASSIGN_OR_RETURN(auto rows, run_peer(options));
  progress(1, loops);
  uint64_t done = 1;
  for (const char* network : {"recnet", "unet"}) {
    for (const char* precision : precisions) {
      Config config;
      config.precision = precision;
      config.data.synthetic_share = 1.0;
      config.patterns.begin_step = 0;
      config.train.batch = options.batch;
      config.train.patch = kPatch;
      config.network.type = network;
      const bool paper = config.network.type == "recnet";
      if (paper) {
        config.input = {{model::InputKind::kCounts, 0.125F}};
        config.train.optimiser = "adam";  // as in the plain loop
      }
      E2LF_ASSIGN_OR_RETURN(auto row, run_trainer(options, paper ? "paper's network, e2lf" : "U-Net, e2lf", config));
      rows.push_back(std::move(row));
      progress(++done, loops);
    }
  }
  E2LF_RETURN_IF_ERROR(append_synthesis(options, rows));
  progress(++done, loops);
  std::map<std::string, double> firsts;  // of each job
  for (Json& row : rows) {
    const double speed = row["samples_per_s"].get<double>();
    row["ratio"] = speed / firsts.try_emplace(row["job"].get<std::string>(), speed).first->second;
  }
  return Json{{"batch", options.batch}, {"threads", at::get_num_threads()}, {"rows", std::move(rows)}};
}

}  // namespace
}  // namespace e2lf::learn

int main(int argc, char** argv) {
  const uint64_t batch = argc == 3 ? std::strtoull(argv[1], nullptr, 10) : 0;
  const uint64_t steps = argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 0;
  if (batch == 0 || steps == 0) {
    std::fputs("usage: e2lf-bench-train BATCH STEPS\n", stderr);
    return 2;
  }
  e2lf::ProgressBar bar("bench", false);
  const auto json = e2lf::learn::guarded("e2lf-bench-train", [&]() -> e2lf::Result<e2lf::Json> {
    return e2lf::learn::benchmark_training({.batch = batch, .steps = steps}, bar.callback());
  });
  e2lf::hide_progress();
  if (!json) {
    std::fprintf(stderr, "e2lf-bench-train: %s\n", json.error().text().c_str());
    return 1;
  }
  std::printf("%s", e2lf::json_text(*json).c_str());
  return 0;
}
