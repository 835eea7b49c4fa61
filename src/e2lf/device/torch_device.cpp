// SPDX-License-Identifier: MIT
#include "e2lf/device/torch_device.h"

#include <algorithm>
#include <torch/torch.h>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/learn/run/torch_setup.h"

namespace e2lf::device {
namespace {

using engine::Precision;

/// Returns the device of torch with this name. Fails as learn::open_device() does.
Result<torch::Device> device_of(const std::string& name) {
  return learn::open_device(name == "torch-cpu" ? "cpu" : name);
}

/// Returns the type of the computation. Fails with kUnsupported.
Result<torch::ScalarType> type_of(const engine::EngineOptions& options, const torch::Device& device) {
  const bool is_checked = std::ranges::find(options.checked, Precision::kBfloat16) != options.checked.end();
  const bool is_half = options.precision == Precision::kFloat16 ||
                       (options.precision == Precision::kAuto && is_checked && device.is_cuda());
  if (options.precision == Precision::kInt16 || (is_half && !device.is_cuda())) {
    return fail(ErrorCode::kUnsupported, "", "the device ", options.device, " does not compute in ",
                word_of(options.precision, engine::kPrecisions), "; use precision auto");
  }
  if (is_half) return torch::kHalf;
  return options.precision == Precision::kBfloat16 ? torch::kBFloat16 : torch::kFloat;
}

class TorchNetwork : public engine::DeviceNetwork {
 public:
  TorchNetwork(const model::Network& network, const torch::Device& device, torch::ScalarType type)
      : module_(network, device), device_(device), type_(type), multiple_(model::size_multiple(network)) {}

  Result<void> take(const model::Weights& weights) {
    E2LF_RETURN_IF_ERROR(learn::load_weights(module_.parameters(), weights, ""));
    for (const auto& [name, tensor] : module_.parameters()) weights_[name] = tensor.detach().to(type_);
    // Fails here if torch lacks an operation, and not when the first image comes.
    const torch::InferenceMode without_gradients;
    const auto channels = static_cast<int64_t>(module_.network().input_channels);
    const auto side = static_cast<int64_t>(multiple_);
    static_cast<void>(module_.forward(torch::zeros({1, channels, side, side}).to(device_), type_, &weights_));
    return {};
  }

  [[nodiscard]] Result<void> run(std::span<const float> input, size_t height, size_t width,
                                 std::span<float> output) const override {
    E2LF_REQUIRE(height > 0 && width > 0 && height % multiple_ == 0 && width % multiple_ == 0,
                 cat("height and width must be multiples of ", multiple_));
    const size_t channels = module_.network().input_channels;
    E2LF_REQUIRE(input.size() == channels * height * width, "the input has another size");
    try {
      const torch::InferenceMode without_gradients;
      const auto image = torch::from_blob(
          const_cast<float*>(input.data()),
          {1, static_cast<int64_t>(channels), static_cast<int64_t>(height), static_cast<int64_t>(width)});
      const auto result = module_.forward(image.to(device_), type_, &weights_).to(torch::kCPU, torch::kFloat);
      E2LF_REQUIRE(static_cast<size_t>(result.numel()) == output.size(), "the output has another size");
      torch::from_blob(output.data(), result.sizes()).copy_(result);
      return {};
    } catch (const c10::Error& error) {
      return fail(ErrorCode::kInternal, "", "torch failed on ", device_.str(), ": ", error.what_without_backtrace());
    }
  }

  [[nodiscard]] Precision precision() const override {
    if (type_ == torch::kFloat) return Precision::kFloat32;
    return type_ == torch::kHalf ? Precision::kFloat16 : Precision::kBfloat16;
  }
  [[nodiscard]] std::vector<std::string> describe() const override {
    return {cat("torch ", TORCH_VERSION, " on ", device_.str(), ", ", word_of(precision(), engine::kPrecisions))};
  }

 private:
  learn::NetworkModule module_;
  torch::Device device_;
  torch::ScalarType type_;
  size_t multiple_;
  learn::NamedTensors weights_;  ///< in the type of the computation
};

Result<std::shared_ptr<const engine::DeviceNetwork>> open(const model::Network& network, const model::Weights& weights,
                                                          const engine::EngineOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const torch::Device device, device_of(options.device));
  E2LF_ASSIGN_OR_RETURN(const torch::ScalarType type, type_of(options, device));
  // The layout and the sizes are those that the engine accepts.
  E2LF_RETURN_IF_ERROR(model::infer_shapes(network));
  for (const model::Layer& layer : network.layers) {
    if (learn::has_operation(layer.op)) continue;
    return fail(ErrorCode::kUnsupported, "", "the device ", options.device, " does not have the operation ", layer.op,
                " of this network; use the device cpu, or a network without it");
  }
  try {
    auto opened = std::make_shared<TorchNetwork>(network, device, type);
    E2LF_RETURN_IF_ERROR(opened->take(weights));
    return std::shared_ptr<const engine::DeviceNetwork>(std::move(opened));
  } catch (const c10::Error& error) {
    return fail(ErrorCode::kInternal, "", "torch failed on ", options.device, ": ", error.what_without_backtrace());
  }
}

}  // namespace

void add_torch_devices() {
  // What is called float32 is computed in it.
  at::globalContext().setAllowTF32CuBLAS(false);
  at::globalContext().setAllowTF32CuDNN(false);
  for (const char* kind : {"cuda", "torch-cpu"}) {
    const auto check = [](const std::string& name) -> Result<void> {
      E2LF_RETURN_IF_ERROR(device_of(name));
      return {};
    };
    engine::add_device_kind(kind, {check, open});
  }
}

}  // namespace e2lf::device
