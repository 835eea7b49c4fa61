// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/engine/plan.h"
#include "e2lf/engine/row_memory.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

enum class Precision {
  kAuto,  ///< float32, or the fastest of EngineOptions::checked that the CPU supports; see Engine::precision()
  kFloat32,
  kBfloat16,  ///< bfloat16 products with float32 sums; kUnsupported if the CPU lacks them
  kFloat16,   ///< on devices other than the CPU: everything in half precision
  kInt16,     ///< convolutions with 16-bit integer products, all else in float32; kUnsupported if not faster
};

/// Their names in options and results.
inline constexpr Choice<Precision> kPrecisions[] = {{"auto", Precision::kAuto},
                                                    {"float32", Precision::kFloat32},
                                                    {"bfloat16", Precision::kBfloat16},
                                                    {"float16", Precision::kFloat16},
                                                    {"int16", Precision::kInt16}};

struct EngineOptions {
  Precision precision = Precision::kAuto;
  /// The precisions that kAuto may choose for this network, because someone measured what it loses, in this order.
  std::vector<Precision> checked = {};
  /// "cpu", or a device whose kind add_device_kind() of device.h made known, such as "cuda:1". There, kAuto is float16
  /// if bfloat16, which rounds more, was checked.
  std::string device = "cpu";
};

/// Runs a convolutional network on whole images, on the CPU unless EngineOptions::device says otherwise. The image
/// streams through the network in strips of a few rows, and each layer keeps only the rows that its successors still
/// need. Thus nothing is computed twice, the live data stay in the cache, and memory does not grow with the height of
/// the image. Zero padding is exact at the borders. Recurrent networks keep their states for the whole image; networks
/// with attention keep its inputs, and neighbouring tensors until it is done. The number of threads is that of
/// base/threads.h. An Engine does not change after create(): any number of threads may run it at once, each run with
/// memory of its own, and all share its weights.
class Engine {
 public:
  /// Prepares kernels and weights. Fails with kUnsupported (a precision that the CPU lacks or that E2LF_MAX_ISA
  /// excludes), with kMissingDependency (a device that is not there), as model::infer_shapes() does, with kShape (an
  /// output that is not at the resolution of the input, or weights of another size) and with kNotFound (missing
  /// weights).
  [[nodiscard]] static Result<Engine> create(const model::Network& network, const model::Weights& weights,
                                             const EngineOptions& options = {});

  /// Runs the network on one image. `input` is float32 [input_channels, height, width], `output` is float32
  /// [output_channels, height, width], both row-major. Sizes that do not match break the contract; height and width
  /// must be multiples of model::size_multiple(). Fails with kCancelled if a stop is requested meanwhile.
  [[nodiscard]] Result<void> run(std::span<const float> input, size_t height, size_t width, std::span<float> output,
                                 const ProgressFn& progress = {}) const;

  /// Runs the network on one frame with a state that is carried from frame to frame; run() begins at rest each time.
  [[nodiscard]] Result<void> run_frame(std::span<const float> input, size_t height, size_t width, FrameState& state,
                                       std::span<float> output, const ProgressFn& progress = {}) const;

  /// Returns an engine with the same kernels that computes only these channels of the output, bit-identically, and does
  /// not change the other planes of the output. Returns nothing if its last layer cannot compute some channels alone.
  [[nodiscard]] std::optional<Engine> with_outputs(std::vector<size_t> channels) const;

  /// Returns the precision in use, to which kAuto was resolved.
  [[nodiscard]] Precision precision() const { return precision_; }

  /// Returns one line per layer with the kernel chosen for it, for logs and benchmarks.
  [[nodiscard]] std::vector<std::string> describe() const;

 private:
  Engine() = default;

  Plan plan_;
  std::shared_ptr<const class DeviceNetwork> device_;  // replaces the plan if it is not null
  Precision precision_ = Precision::kFloat32;
  std::vector<size_t> planes_;  // see with_outputs()
  size_t num_planes_ = 0;       // of the output
};

/// A network on a device other than the CPU. Any number of threads may run it at once.
class DeviceNetwork {
 public:
  DeviceNetwork() = default;
  DeviceNetwork(const DeviceNetwork&) = delete;
  DeviceNetwork& operator=(const DeviceNetwork&) = delete;
  virtual ~DeviceNetwork() = default;

  /// Computes what Engine::run() computes.
  [[nodiscard]] virtual Result<void> run(std::span<const float> input, size_t height, size_t width,
                                         std::span<float> output) const = 0;
  [[nodiscard]] virtual Precision precision() const = 0;
  /// Returns the lines of Engine::describe().
  [[nodiscard]] virtual std::vector<std::string> describe() const = 0;
};

/// The devices of one kind, such as "cuda" for "cuda" and "cuda:1".
struct DeviceKind {
  /// Fails with kMissingDependency if this machine has no device of the name.
  std::function<Result<void>(const std::string& name)> check;
  /// Prepares a network on EngineOptions::device. Fails as Engine::create() does.
  std::function<Result<std::shared_ptr<const DeviceNetwork>>(const model::Network&, const model::Weights&,
                                                             const EngineOptions&)>
      open;
};

/// Makes a kind of devices known to Engine::create(). A name that is taken breaks the contract.
void add_device_kind(const std::string& kind, DeviceKind devices);

/// Returns whether the kind of a device is known. "cpu" always is.
[[nodiscard]] bool is_known_device(const std::string& name);

/// Fails with kMissingDependency if the kind of a device is not known or if this machine has no such device.
[[nodiscard]] Result<void> check_device(const std::string& name);

}  // namespace e2lf::engine
