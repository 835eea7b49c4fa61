// SPDX-License-Identifier: MIT
#include "bench/program/parts.h"

#include <algorithm>
#include <cmath>
#include <dlfcn.h>

#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"

namespace e2lf::bench {

Timing timing_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  return {seconds[seconds.size() / 2], seconds.front(), seconds.back()};
}

Json to_json(const Timing& timing) {
  return {{"median", timing.median}, {"min", timing.min}, {"max", timing.max}};
}

model::Weights random_weights(const model::Network& network) {
  model::Weights weights;
  uint64_t stream = 0;
  for (const model::WeightShape& shape : model::weight_shapes(network)) {
    size_t size = 1;
    for (const size_t extent : shape.shape) size *= extent;
    const CounterRng rng(1, ++stream);
    const float scale = std::sqrt(6.0F * static_cast<float>(shape.shape[0]) / static_cast<float>(size));
    std::vector<float>& values = weights[shape.name];
    for (size_t i = 0; i < size; ++i) values.push_back((2.0F * rng.uniform(i) - 1.0F) * scale);
  }
  return weights;
}

void* find_torch_peer(const std::filesystem::path& module, const char* function, std::string& absent) {
  std::filesystem::path path = module;
  if (path.empty()) path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "e2lf_torch_peer.so";
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    absent = cat("no libtorch in this build (", ::dlerror(), ")");
    return nullptr;
  }
  void* const found = ::dlsym(library, function);
  if (found == nullptr) absent = cat(path.string(), " is not the peer's module");
  return found;
}

}  // namespace e2lf::bench
