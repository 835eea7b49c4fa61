// SPDX-License-Identifier: MIT
#include "bench/train/benchmark.h"

#include <algorithm>
#include <chrono>
#include <dlfcn.h>

#include "bench/peers/torch_training.h"
#include "e2lf/learn/data/synthesiser.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

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

/// Sets the ratios of the rows from `first` on, relative to row `first`.
void compare(std::vector<BenchmarkRow>& rows, size_t first) {
  for (size_t i = first; i < rows.size(); ++i) rows[i].ratio = rows[i].samples_per_s / rows[first].samples_per_s;
}

/// Runs the peer beside this program. Returns no rows if it was not built.
Result<std::vector<BenchmarkRow>> run_peer(const BenchmarkOptions& options) {
  std::error_code status;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", status);
  const auto path = (program.parent_path() / "e2lf_torch_peer.so").string();
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return std::vector<BenchmarkRow>{};
  const auto train = reinterpret_cast<decltype(&e2lf_torch_training)>(::dlsym(module, "e2lf_torch_training"));
  std::vector<double> seconds(options.steps + kWarmUpSteps);
  const E2lfTorchTraining job{options.batch, kPatch, seconds.size(), seconds.data()};
  if (const char* problem = train == nullptr ? "it has another version" : train(&job)) {
    return Error{ErrorCode::kInternal, cat("the peer failed: ", problem, "; rebuild it"), path};
  }
  return std::vector<BenchmarkRow>{
      {"training", "paper's network, plain libtorch", "float32", samples_per_s(options.batch, seconds)}};
}

Result<BenchmarkRow> run_trainer(const BenchmarkOptions& options, const std::string& name, const Config& config) {
  E2LF_ASSIGN_OR_RETURN(auto trainer, Trainer::create(config));
  E2LF_ASSIGN_OR_RETURN(const auto seconds, time_steps(options.steps, [&] { return trainer.train_step(); }));
  return BenchmarkRow{"training", name, config.precision, samples_per_s(options.batch, seconds)};
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

Result<void> append_synthesis(const BenchmarkOptions& options, std::vector<BenchmarkRow>& rows) {
  constexpr uint64_t kScenes = 16;
  constexpr int64_t kSize = 96, kSide = 118;
  std::vector<std::vector<Surface>> scenes;
  for (uint64_t seed = 0; seed < kScenes; ++seed) scenes.push_back(random_surfaces(seed, kSide));
  const size_t first = rows.size();
  for (const auto& [name, render] : {std::pair{"torch's sampling", &views_of_reference}, {"e2lf", &views_of}}) {
    E2LF_ASSIGN_OR_RETURN(const auto seconds, time_steps(options.steps, [&, render = render]() -> Result<void> {
                            for (const auto& surfaces : scenes) (void)render(surfaces, kSize);
                            return {};
                          }));
    rows.push_back({"synthesis", name, "float32", samples_per_s(kScenes, seconds)});
  }
  compare(rows, first);
  return {};
}

}  // namespace

Result<std::vector<BenchmarkRow>> benchmark_training(const BenchmarkOptions& options, const ProgressFn& progress) {
  std::vector<const char*> precisions = {"float32"};
  if (has_bfloat16()) precisions.push_back("bfloat16");
  const uint64_t loops = 2 + 2 * precisions.size();
  E2LF_ASSIGN_OR_RETURN(auto rows, run_peer(options));
  if (progress) progress(1, loops);
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
      if (progress) progress(++done, loops);
    }
  }
  compare(rows, 0);
  E2LF_RETURN_IF_ERROR(append_synthesis(options, rows));
  if (progress) progress(++done, loops);
  return rows;
}

}  // namespace e2lf::learn
