// SPDX-License-Identifier: MIT
#include "bench/program/parts.h"

#include <algorithm>
#include <cmath>
#include <dlfcn.h>

#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/lightfield/views.h"

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

void* find_in_peer(const char* module, const char* function, std::string& absent) {
  const std::string path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / module;
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    absent = cat("not in this build (", ::dlerror(), ")");
    return nullptr;
  }
  void* const found = ::dlsym(library, function);
  if (found == nullptr) absent = cat(path, " is not the peer's module");
  return found;
}

using lightfield::LightField;

Result<LightField> in_view(const LightField& scene, size_t size, size_t motion_px, size_t most_px) {
  const size_t margin = most_px + 1;
  const lightfield::Shape& shape = scene.shape();
  if (shape.width < margin + 16) {
    return Error{ErrorCode::kShape, cat("the views are narrower than ", margin + 16, " px; use larger ones"), ""};
  }
  const size_t height = std::min(size, shape.height);
  const size_t width = std::min(size, shape.width - margin);
  const size_t x = (shape.width - margin - width) / 2 + motion_px;
  return lightfield::crop(scene, {(shape.height - height) / 2, x, height, width});
}

Result<double> best_psnr_db(const LightField& field, const std::vector<LightField>& scenes) {
  double best = 0;
  for (const LightField& scene : scenes) {
    LightField fitted = field;
    const float gain = eval::best_gain(scene, field);
    for (float& value : fitted.data()) value *= gain;
    E2LF_ASSIGN_OR_RETURN(const auto metrics, eval::compare(scene, fitted));
    best = std::max(best, metrics.mean.psnr_db);
  }
  return best;
}

}  // namespace e2lf::bench
