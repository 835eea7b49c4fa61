// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/turntable_scene.h"

#include <cmath>

#include "e2lf/base/rng.h"

namespace e2lf::lightfield {
namespace {

constexpr float kTable = 0.26F;     // y of its top
constexpr float kHalfSide = 0.27F;  // of the table
constexpr float kMiddleZ = 0.95F;   // of its middle; x = 0
constexpr float kBackWall = 1.5F;   // z

/// Places objects on the rotated table by their position on it.
class Table {
 public:
  Table(float turn, uint64_t seed) : turn_(turn), cosine_(std::cos(turn)), sine_(std::sin(turn)), rng_(seed, 1) {}

  Material material(TextureKind texture, float dark, float bright, float period) {
    Material material{texture, dark, bright, period};
    material.seed = rng_.bits(count_++)[0];
    return material;
  }

  [[nodiscard]] Vec3 direction(float x, float z) const { return {cosine_ * x - sine_ * z, 0, cosine_ * z + sine_ * x}; }
  [[nodiscard]] Vec3 place(float x, float y, float z) const {
    const Vec3 turned = direction(x, z);
    return {turned.x, y, kMiddleZ + turned.z};
  }

  [[nodiscard]] Block block(float x, float z, const Vec3& half_size, float yaw, const Material& material) const {
    return {place(x, kTable - half_size.y, z), half_size, yaw + turn_, material};
  }
  [[nodiscard]] Sphere ball(float x, float z, float radius, const Material& material) const {
    return {place(x, kTable - radius, z), radius, material};
  }
  [[nodiscard]] Quad top(const Material& material) const {
    return {place(-kHalfSide, kTable, -kHalfSide), direction(2 * kHalfSide, 0), direction(0, 2 * kHalfSide), material};
  }

 private:
  float turn_, cosine_, sine_;
  CounterRng rng_;
  uint64_t count_ = 0;
};

}  // namespace

Scene turntable_scene(float turn, uint64_t seed) {
  using enum TextureKind;
  Scene scene;
  scene.camera.disparity_at_infinity_px = 4.6F;
  scene.camera.centre_y = 0.1F;
  scene.light.direction = {-0.55F, -0.75F, -0.75F};
  Table table(turn, seed);
  scene.quads = {
      {{-1.5F, -1.2F, kBackWall}, {3, 0, 0}, {0, 2.4F, 0}, table.material(kBricks, 0.15F, 0.9F, 0.16F)},
      {{-1.5F, kTable + 0.04F, 0.3F}, {3, 0, 0}, {0, 0, kBackWall}, table.material(kPlain, 0.1F, 0.3F, 0.2F)},
      table.top(table.material(kWood, 0.12F, 0.8F, 0.12F)),
  };
  scene.blocks = {
      table.block(0.13F, 0.1F, {0.07F, 0.12F, 0.05F}, 0.5F, table.material(kChecks, 0.04F, 0.95F, 0.05F)),
      table.block(-0.12F, 0.12F, {0.03F, 0.09F, 0.06F}, 0.15F, table.material(kStripes, 0.2F, 0.95F, 0.035F)),
      table.block(-0.02F, -0.16F, {0.06F, 0.012F, 0.045F}, 0.35F, table.material(kMarks, 0.03F, 0.98F, 0.014F)),
  };
  scene.spheres = {
      table.ball(-0.13F, -0.08F, 0.06F, table.material(kDots, 0.06F, 0.9F, 0.03F)),
      table.ball(0.15F, -0.1F, 0.045F, table.material(kNoise, 0.1F, 0.95F, 0.03F)),
  };
  return scene;
}

}  // namespace e2lf::lightfield
