// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/lightfield/scene.h"

namespace e2lf::depth {

/// Returns a matte material with noise as its texture, which has no grain.
inline lightfield::Material noise_material(uint32_t seed) {
  lightfield::Material material{lightfield::TextureKind::kNoise, 0.0F, 1.0F, 0.2F};
  material.grain = 0;
  material.seed = seed;
  return material;
}

}  // namespace e2lf::depth
