// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {
namespace {

/// Returns 32 well-mixed bits for a cell of a texture.
uint32_t hash_cell(int32_t column, int32_t row, uint32_t seed) {
  uint32_t h = static_cast<uint32_t>(column) * 0x9E3779B1U + static_cast<uint32_t>(row) * 0x85EBCA77U + seed;
  h ^= h >> 15;
  h *= 0xD168AAADU;
  h ^= h >> 13;
  h *= 0xAF723597U;
  return h ^ (h >> 16);
}

float unit(uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24F;
}

/// Returns floor() as an integer. std::floor is a function call on the oldest CPUs, and this is the innermost loop.
int32_t cell_of(float position) {
  const auto truncated = static_cast<int32_t>(position);
  return truncated - (position < static_cast<float>(truncated) ? 1 : 0);
}

float fraction(float position) {
  return position - static_cast<float>(cell_of(position));
}

/// Interpolates as std::lerp does, but without its branches for exact ends.
float mix(float a, float b, float t) {
  return a + t * (b - a);
}

/// Returns an edge of width `width`: 0 far below and 1 far above `distance` 0.
float soft_step(float distance, float width) {
  return std::clamp(distance / std::max(width, 1e-6F) + 0.5F, 0.0F, 1.0F);
}

/// Returns the scalar product of the random gradient of a grid point and the offset from it.
float gradient_dot(int32_t column, int32_t row, uint32_t seed, float dx, float dy) {
  const uint32_t bits = hash_cell(column, row, seed);
  const float gx = static_cast<float>(static_cast<int32_t>(bits & 0xFFFFU) - 0x8000) * 0x1p-15F;
  const float gy = static_cast<float>(static_cast<int32_t>(bits >> 16) - 0x8000) * 0x1p-15F;
  return gx * dx + gy * dy;
}

/// Returns gradient noise with features of size 1, in about [-0.7, 0.7].
float gradient_noise(float u, float v, uint32_t seed) {
  const int32_t column = cell_of(u), row = cell_of(v);
  const float x = u - static_cast<float>(column), y = v - static_cast<float>(row);
  const float sx = x * x * x * (x * (x * 6 - 15) + 10), sy = y * y * y * (y * (y * 6 - 15) + 10);
  const float top = mix(gradient_dot(column, row, seed, x, y), gradient_dot(column + 1, row, seed, x - 1, y), sx);
  const float bottom =
      mix(gradient_dot(column, row + 1, seed, x, y - 1), gradient_dot(column + 1, row + 1, seed, x - 1, y - 1), sx);
  return mix(top, bottom, sy);
}

/// Returns octaves of noise from features of `size` down to the footprint, in about [-1, 1]. An octave whose features
/// approach the width of a pixel fades out, because it would only alias.
float fractal_noise(float u, float v, float size, float footprint, uint32_t seed) {
  constexpr int kOctaves = 6;
  constexpr float kGainPerOctave = 0.65F;
  float sum = 0, amplitude = 1.2F;
  for (int octave = 0; octave < kOctaves; ++octave, size *= 0.5F, amplitude *= kGainPerOctave) {
    const float fade = std::clamp(size / (1.5F * footprint) - 1, 0.0F, 1.0F);
    if (fade == 0) break;
    sum += fade * amplitude * gradient_noise(u / size, v / size, seed + static_cast<uint32_t>(octave) * 0x6C8E9CF5U);
  }
  return sum;
}

/// Returns a square wave of period 1 in [-1, 1], with edges of width `width`.
float square_wave(float position, float width) {
  const float t = fraction(position) - 0.5F;
  return 2 * soft_step(0.25F - std::abs(t), width) - 1;
}

float checks(float u, float v, float width) {
  return 0.5F + 0.5F * square_wave(u, width) * square_wave(v, width);
}

float bricks(float u, float v, float width, uint32_t seed) {
  constexpr float kAspect = 0.42F, kJoint = 0.035F;
  const int32_t row = cell_of(v / kAspect);
  const float shifted = u + ((row & 1) != 0 ? 0.5F : 0.0F) + 0.04F * unit(hash_cell(row, 7, seed));
  const float x = std::abs(fraction(shifted) - 0.5F), y = std::abs(fraction(v / kAspect) - 0.5F) * kAspect;
  const float inside = std::min(soft_step(0.5F - kJoint - x, width), soft_step(0.5F * kAspect - kJoint - y, width));
  return mix(0.95F, 0.15F + 0.55F * unit(hash_cell(cell_of(shifted), row, seed)), inside);
}

float wood(float u, float v, float width, uint32_t seed) {
  const int32_t plank = cell_of(u);
  const float offset = 17 * unit(hash_cell(plank, 3, seed));
  // The grain is noise stretched along the plank and folded into rings.
  const float warp = fractal_noise(3 * u, 0.35F * v + offset, 1, width, seed);
  const float rings = 0.5F + 0.5F * std::sin(14 * warp + 9 * u);
  const float joint = soft_step(std::min(fraction(u), 1 - fraction(u)) - 0.012F, width);
  return joint * (0.25F + 0.3F * unit(hash_cell(plank, 5, seed)) + 0.45F * rings);
}

float dots(float u, float v, float width) {
  return soft_step(0.33F - std::hypot(fraction(u) - 0.5F, fraction(v) - 0.5F), width);
}

float distance_to_segment(float x, float y, const std::array<float, 4>& segment) {
  const float dx = segment[2] - segment[0], dy = segment[3] - segment[1];
  const float along = std::clamp(((x - segment[0]) * dx + (y - segment[1]) * dy) / (dx * dx + dy * dy), 0.0F, 1.0F);
  return std::hypot(x - segment[0] - along * dx, y - segment[1] - along * dy);
}

/// Returns the ink of one sign in its cell, which consists of some of a few strokes.
float sign(float x, float y, float width, uint32_t bits) {
  constexpr std::array<std::array<float, 4>, 8> kStrokes{{{0.2F, 0.2F, 0.2F, 0.8F},
                                                          {0.75F, 0.2F, 0.75F, 0.8F},
                                                          {0.2F, 0.2F, 0.75F, 0.2F},
                                                          {0.2F, 0.5F, 0.75F, 0.5F},
                                                          {0.2F, 0.8F, 0.75F, 0.8F},
                                                          {0.2F, 0.8F, 0.75F, 0.2F},
                                                          {0.2F, 0.5F, 0.75F, 0.8F},
                                                          {0.48F, 0.2F, 0.48F, 0.8F}}};
  float distance = 1;
  for (size_t i = 0; i < kStrokes.size(); ++i) {
    if (((bits >> (3 * i)) & 7U) < 3) distance = std::min(distance, distance_to_segment(x, y, kStrokes[i]));
  }
  return soft_step(0.07F - distance, width);
}

/// Returns 1 for paper and 0 for ink. A line of text has height 1. Some signs and whole lines are left out.
float marks(float u, float v, float width, uint32_t seed) {
  constexpr float kAdvance = 0.6F;
  const int32_t line = cell_of(v), column = cell_of(u / kAdvance);
  const uint32_t line_bits = hash_cell(line, 11, seed), bits = hash_cell(column, line, seed);
  const bool empty_line = line_bits % 7 == 0, space = bits % 6 == 0;
  if (empty_line || space) return 1;
  return 1 - sign(fraction(u / kAdvance), fraction(v), width, bits >> 4);
}

float star(float u, float v, float width) {
  constexpr float kWedges = 24;
  const float radius = std::hypot(u, v);
  const float position = std::atan2(v, u) * kWedges / (2 * std::numbers::pi_v<float>);
  // A pair of wedges is 2 pi radius / kWedges long; below two pixels it turns grey.
  const float pair = 2 * std::numbers::pi_v<float> * radius / kWedges;
  const float contrast = std::clamp(pair / std::max(2 * width, 1e-6F) - 0.5F, 0.0F, 1.0F);
  const float wedges = 0.5F + 0.5F * contrast * square_wave(position, width / std::max(pair, 1e-6F));
  return mix(wedges, 0.9F, soft_step(radius - 0.46F, width));
}

float texture(const Material& material, const SurfacePoint& point) {
  const float u = point.u / material.period, v = point.v / material.period, width = point.footprint / material.period;
  switch (material.texture) {
    case TextureKind::kPlain:
      return 0.5F;
    case TextureKind::kNoise:
      return 0.5F + 0.5F * fractal_noise(u, v, 1, width, material.seed);
    case TextureKind::kChecks:
      return checks(u, v, width);
    case TextureKind::kStripes:
      return 0.5F + 0.5F * square_wave(u, width);
    case TextureKind::kBricks:
      return bricks(u, v, width, material.seed);
    case TextureKind::kWood:
      return wood(u, v, width, material.seed);
    case TextureKind::kDots:
      return dots(u, v, width);
    case TextureKind::kMarks:
      return marks(u, v, width, material.seed);
    case TextureKind::kStar:
      return star(u, v, width);
  }
  return 0.5F;
}

}  // namespace

float albedo(const Material& material, const SurfacePoint& point) {
  constexpr float kGrainSize = 0.02F;
  float t = texture(material, point);
  if (material.grain > 0) {
    t += material.grain * fractal_noise(point.u, point.v, kGrainSize, point.footprint, material.seed ^ 0x5BD1E995U);
  }
  return material.dark + (material.bright - material.dark) * std::clamp(t, 0.0F, 1.0F);
}

}  // namespace e2lf::lightfield
