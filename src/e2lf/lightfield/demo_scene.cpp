// SPDX-License-Identifier: MIT
#include <cmath>

#include "e2lf/base/rng.h"
#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {
namespace {

constexpr float kFloor = 0.3F;  ///< y of the table
constexpr float kWall = 1.5F;   ///< z of the wall

/// A table whose top is at y = `top`. Objects are placed by their position on it, relative to (0, middle_z), around
/// which it is rotated by `turn`. Materials get textures that depend on the seed.
class Table {
 public:
  Table(float top, float middle_z, float turn, uint64_t seed)
      : top_(top), middle_z_(middle_z), turn_(turn), cosine_(std::cos(turn)), sine_(std::sin(turn)), rng_(seed, 1) {}

  Material material(TextureKind texture, float dark, float bright, float period) {
    Material material{texture, dark, bright, period};
    material.seed = rng_.bits(count_++)[0];
    return material;
  }

  [[nodiscard]] Vec3 direction(float x, float z) const { return {cosine_ * x - sine_ * z, 0, cosine_ * z + sine_ * x}; }
  [[nodiscard]] Vec3 place(float x, float y, float z) const {
    const Vec3 turned = direction(x, z);
    return {turned.x, y, middle_z_ + turned.z};
  }

  /// Places objects such that their lower edge is on the table.
  [[nodiscard]] Block block(float x, float z, const Vec3& half_size, float yaw, const Material& material) const {
    return {place(x, top_ - half_size.y, z), half_size, yaw + turn_, material};
  }
  [[nodiscard]] Sphere ball(float x, float z, float radius, const Material& material) const {
    return {place(x, top_ - radius, z), radius, material};
  }
  /// Returns a square top.
  [[nodiscard]] Quad top(float half_side, const Material& material) const {
    return {place(-half_side, top_, -half_side), direction(2 * half_side, 0), direction(0, 2 * half_side), material};
  }

 private:
  float top_, middle_z_, turn_, cosine_, sine_;
  CounterRng rng_;
  uint64_t count_ = 0;
};

Material shiny(Material material) {
  material.specular = 0.35F;
  return material;
}

Material grainy(Material material) {
  material.grain = 0.35F;
  return material;
}

void add_room(ProceduralScene& scene, Table& table) {
  scene.quads.push_back({{-1.5F, -1.2F, kWall},
                         {3, 0, 0},
                         {0, 2.4F, 0},
                         grainy(table.material(TextureKind::kBricks, 0.15F, 1.0F, 0.16F))});
  scene.quads.push_back(
      {{-1.5F, kFloor, 0.3F}, {3, 0, 0}, {0, 0, kWall}, table.material(TextureKind::kWood, 0.12F, 0.8F, 0.17F)});
  // A poster on the wall.
  scene.quads.push_back(
      {{0.0F, -0.25F, 1.49F}, {0.34F, 0, 0}, {0, 0.24F, 0}, table.material(TextureKind::kMarks, 0.03F, 0.95F, 0.035F)});
}

/// Rotates the upright objects and shifts the balls on the table a little.
void rearrange(ProceduralScene& scene, uint64_t seed) {
  constexpr float kTurn = 0.25F, kRoll = 0.04F;
  const CounterRng rng(seed, 2);
  uint64_t draws = 0;
  for (Block& block : scene.blocks) block.yaw += kTurn * (rng.uniform(draws++) - 0.5F);
  for (Sphere& sphere : scene.spheres) {
    const bool on_the_table = sphere.centre.y + sphere.radius > kFloor - 1e-3F;
    if (on_the_table) sphere.centre.x += kRoll * (rng.uniform(draws++) - 0.5F);
  }
}

void add_blocks(ProceduralScene& scene, Table& table) {
  using enum TextureKind;
  scene.blocks = {
      table.block(0.31F, 1.28F, {0.085F, 0.17F, 0.06F}, 0.5F, grainy(table.material(kNoise, 0.03F, 1.0F, 0.035F))),
      table.block(0.02F, 1.16F, {0.085F, 0.06F, 0.075F}, -0.45F, table.material(kChecks, 0.04F, 0.95F, 0.05F)),
      table.block(-0.38F, 1.3F, {0.03F, 0.16F, 0.07F}, 0.15F, table.material(kMarks, 0.1F, 0.7F, 0.03F)),
      table.block(-0.30F, 1.3F, {0.035F, 0.13F, 0.07F}, 0.15F, table.material(kStripes, 0.2F, 0.95F, 0.035F)),
      table.block(0.01F, 0.86F, {0.075F, 0.012F, 0.055F}, 0.35F, table.material(kMarks, 0.03F, 0.98F, 0.014F)),
      table.block(-0.235F, 0.7F, {0.006F, 0.11F, 0.006F}, 0.6F, table.material(kChecks, 0.05F, 0.95F, 0.025F)),
  };
}

void add_spheres(ProceduralScene& scene, Table& table) {
  using enum TextureKind;
  scene.spheres = {
      table.ball(-0.2F, 1.04F, 0.095F, shiny(table.material(kStripes, 0.06F, 0.9F, 0.045F))),
      table.ball(0.2F, 0.98F, 0.06F, shiny(table.material(kDots, 0.12F, 0.98F, 0.03F))),
      table.ball(-0.14F, 0.8F, 0.035F, shiny(table.material(kNoise, 0.1F, 0.95F, 0.03F))),
      {{0.02F, kFloor - 0.12F - 0.055F, 1.16F}, 0.055F, shiny(table.material(kNoise, 0.02F, 0.6F, 0.05F))},
  };
}

}  // namespace

ProceduralScene demo_scene(uint64_t seed) {
  ProceduralScene scene;
  scene.camera.disparity_at_infinity_px = 4.6F;
  scene.camera.centre_y = 0.1F;
  scene.light.direction = {-0.55F, -0.75F, -0.75F};
  scene.light.intensity = 0.95F;
  scene.light.ambient = 0.34F;
  Table table(kFloor, 0, 0, seed);
  add_room(scene, table);
  add_blocks(scene, table);
  add_spheres(scene, table);
  rearrange(scene, seed);
  // A test chart that leans backwards.
  scene.quads.push_back({{0.19F, kFloor - 0.13F, 0.86F},
                         {0.11F, 0, -0.03F},
                         {0, 0.13F, -0.04F},
                         table.material(TextureKind::kStar, 0.03F, 0.95F, 0.14F)});
  return scene;
}

ProceduralScene turntable_scene(float turn, uint64_t seed) {
  using enum TextureKind;
  constexpr float kTop = 0.26F, kHalfSide = 0.27F, kMiddleZ = 0.95F;  // of the table
  ProceduralScene scene;
  scene.camera.disparity_at_infinity_px = 4.6F;
  scene.camera.centre_y = 0.1F;
  scene.light.direction = {-0.55F, -0.75F, -0.75F};
  Table table(kTop, kMiddleZ, turn, seed);
  scene.quads = {
      {{-1.5F, -1.2F, kWall}, {3, 0, 0}, {0, 2.4F, 0}, table.material(kBricks, 0.15F, 0.9F, 0.16F)},
      {{-1.5F, kTop + 0.04F, 0.3F}, {3, 0, 0}, {0, 0, kWall}, table.material(kPlain, 0.1F, 0.3F, 0.2F)},
      table.top(kHalfSide, table.material(kWood, 0.12F, 0.8F, 0.12F)),
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
