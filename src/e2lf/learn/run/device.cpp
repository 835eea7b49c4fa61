// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/device.h"

#include <torch/cuda.h>

#include "e2lf/base/text.h"

namespace e2lf::learn {

Result<c10::Device> open_device(const std::string& name) {
  const bool is_cuda = name == "cuda" || (name.starts_with("cuda:") && name.size() > 5 && name.size() < 8 &&
                                          name.find_first_not_of("0123456789", 5) == std::string::npos);
  if (name != "cpu" && !is_cuda) {
    return Error{ErrorCode::kInvalidValue, cat("there is no device \"", name, "\"; use cpu, cuda or cuda:1"), "device"};
  }
  if (!is_cuda) return c10::Device("cpu");
  const size_t number = name == "cuda" ? 0 : std::stoul(name.substr(5));
  if (number >= torch::cuda::device_count()) {
    return Error{ErrorCode::kUnsupported,
                 cat("torch sees ", torch::cuda::device_count(), " CUDA devices; use another device, or cpu"),
                 "device"};
  }
  return c10::Device(c10::kCUDA, static_cast<c10::DeviceIndex>(number));
}

}  // namespace e2lf::learn
