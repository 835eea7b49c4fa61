// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

enum class Precision {
  kAuto,  ///< the fastest that keeps the picture: see Engine::precision()
  kFloat32,
  kBfloat16,  ///< bfloat16 products with float32 sums; fails with kUnsupported where the CPU has none
};

[[nodiscard]] Result<Precision> precision_from_name(const std::string& name);  ///< "auto", "float32", "bfloat16"
[[nodiscard]] const char* precision_name(Precision precision);

struct EngineOptions {
  Precision precision = Precision::kAuto;
};

/// What a recurrent network remembers of the frames before; empty, it begins at rest. Of one engine and one size of
/// image: another one breaks the contract.
class FrameState {
 public:
  FrameState();
  FrameState(FrameState&&) noexcept;
  FrameState& operator=(FrameState&&) noexcept;
  ~FrameState();

 private:
  friend class Engine;
  std::unique_ptr<struct FrameMemory> memory_;
};

/// Runs a convolutional network over whole images on the CPU. The image streams through the network in strips of a few
/// rows; each layer keeps just the rows its successors still need, so nothing is computed twice, what is live stays in
/// cache and memory does not grow with the height of the image. Zero padding is exact at the borders. Recurrent
/// networks keep what they remember of whole images; networks with attention what it looks at, and what stands around
/// it until it is done. Thread count: base/threads.h. One run at a time per Engine.
class Engine {
 public:
  /// Prepares kernels and weights. Fails with kUnsupported (a precision this CPU lacks or E2LF_MAX_ISA leaves out), as
  /// model::infer_shapes() does, with kShape (an output that is not at the input's resolution, weights of another size)
  /// and kNotFound (missing weights).
  [[nodiscard]] static Result<Engine> create(const model::Network& network, const model::Weights& weights,
                                             const EngineOptions& options = {});
  Engine(Engine&&) noexcept;
  Engine& operator=(Engine&&) noexcept;
  ~Engine();

  /// input: float32 [input_channels, height, width], output: float32 [output_channels, height, width], both row-major.
  /// Sizes that do not fit break the contract; height and width must be multiples of model::size_multiple().
  [[nodiscard]] Result<void> run(std::span<const float> input, size_t height, size_t width, std::span<float> output,
                                 const ProgressFn& progress = {}) const;

  /// The same with a state that goes from frame to frame; run() above begins at rest each time.
  [[nodiscard]] Result<void> run_frame(std::span<const float> input, size_t height, size_t width, FrameState& state,
                                       std::span<float> output, const ProgressFn& progress = {}) const;

  /// What kAuto became.
  [[nodiscard]] Precision precision() const;

  /// One line per layer with the kernel chosen for it, for logs and benchmarks.
  [[nodiscard]] std::vector<std::string> describe() const;

 private:
  struct Impl;
  explicit Engine(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::engine
