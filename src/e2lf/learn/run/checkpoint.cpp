// SPDX-License-Identifier: MIT
// The part of Trainer that writes and reads checkpoints.
#include <charconv>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

constexpr const char* kVersion = "1";

void add_tensors(Safetensors& file, const std::string& prefix, const NamedTensors& tensors) {
  for (const auto& [name, tensor] : tensors) {
    const auto values = tensor.detach().to(torch::kCPU, torch::kFloat).contiguous();
    std::vector<size_t> shape(values.sizes().begin(), values.sizes().end());
    file.tensors[prefix + name] =
        make_npy<float>(shape, std::span<const float>(values.data_ptr<float>(), static_cast<size_t>(values.numel())));
  }
}

Result<void> take_tensors(const Safetensors& file, const std::string& prefix, const NamedTensors& tensors,
                          const std::string& location) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : tensors) {
    E2LF_ASSIGN_OR_RETURN(const e2lf::Tensor* stored, file.find(prefix + name, location));
    if (static_cast<int64_t>(stored->num_elements()) != tensor.numel()) {
      return fail(ErrorCode::kShape, location, "\"", prefix, name,
                  "\" has another shape; resume with the network of the run");
    }
    E2LF_ASSIGN_OR_RETURN(const auto values, stored->to_float(location));
    auto target = tensor;
    target.copy_(torch::tensor(at::ArrayRef<float>(values)).reshape(tensor.sizes()));
  }
  return {};
}

}  // namespace

std::vector<std::pair<const char*, const NamedTensors*>> Trainer::state() const {
  return {{"weights/", &parameters()},
          {"average/", &average_},
          {"momentum/", &muon_.momenta()},
          {"first/", &adam_.first_moments()},
          {"second/", &adam_.second_moments()},
          {"", &pattern_parameters_},
          {"first/", &pattern_adam_.first_moments()},
          {"second/", &pattern_adam_.second_moments()}};
}

Result<void> Trainer::save_checkpoint(const std::filesystem::path& path) const {
  Safetensors file;
  for (const auto& [prefix, tensors] : state()) add_tensors(file, prefix, *tensors);
  file.metadata = {{"version", kVersion}, {"step", std::to_string(step_)}, {"config", json_line(to_json(config_))}};
  return write_safetensors(path, file);
}

Result<void> Trainer::load_checkpoint(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto file, read_safetensors(path));
  const auto version = file.metadata.find("version"), step = file.metadata.find("step");
  if (version == file.metadata.end() || version->second != kVersion || step == file.metadata.end()) {
    return fail(ErrorCode::kFormat, path, "this is not a training checkpoint of this version; choose another file");
  }
  const std::string location = path.string();
  for (const auto& [prefix, tensors] : state()) {
    E2LF_RETURN_IF_ERROR(take_tensors(file, prefix, *tensors, location));
  }
  const std::string& number = step->second;
  if (std::from_chars(number.data(), number.data() + number.size(), step_).ec != std::errc()) {
    return fail(ErrorCode::kFormat, location, "the step of this checkpoint is not a number; choose another checkpoint");
  }
  return {};
}

}  // namespace e2lf::learn
