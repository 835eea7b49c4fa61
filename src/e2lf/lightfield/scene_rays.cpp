// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/scene_rays.h"

#include <algorithm>
#include <utility>

namespace e2lf::lightfield {
namespace {

constexpr float kTooNear = 1e-4F;

Vec3 facing(const Vec3& normal, const Vec3& direction) {
  return dot(normal, direction) > 0 ? -1.0F * normal : normal;
}

/// Rotates a vector around the vertical axis.
Vec3 turned(const Vec3& a, float cosine, float sine) {
  return {cosine * a.x + sine * a.z, a.y, cosine * a.z - sine * a.x};
}

}  // namespace

SceneRays::SceneRays(const Scene& scene) : scene_(&scene) {
  for (const Quad& quad : scene.quads) {
    const Vec3 area = cross(quad.edge_u, quad.edge_v);
    const float scale = 1 / dot(area, area);
    const Vec3 half = 0.5F * (quad.edge_u + quad.edge_v), other_half = 0.5F * (quad.edge_u - quad.edge_v);
    const float radius = std::sqrt(std::max(dot(half, half), dot(other_half, other_half)));
    quad_frames_.push_back({normalised(area),
                            scale * cross(quad.edge_v, area),
                            scale * cross(area, quad.edge_u),
                            std::sqrt(dot(quad.edge_u, quad.edge_u)),
                            std::sqrt(dot(quad.edge_v, quad.edge_v)),
                            {quad.corner + half, radius}});
  }
  for (const Block& block : scene.blocks) {
    const float radius = std::sqrt(dot(block.half_size, block.half_size));
    block_frames_.push_back({std::cos(block.yaw), std::sin(block.yaw), {block.centre, radius}});
  }
}

/// Returns true if all rays within `spread` of this one miss a ball. The point of the ray nearest to its centre is at
/// t. Rays there are up to spread * t apart, and up to spread * radius more within the ball.
bool SceneRays::misses(const Ray& ray, const Ball& ball, float spread) {
  const Vec3 offset = ball.centre - ray.origin;
  const float length_squared = dot(ray.direction, ray.direction);
  const float t = dot(offset, ray.direction) / length_squared;
  const Vec3 beside = offset - t * ray.direction;
  const float reach = ball.radius + spread * (std::abs(t) + ball.radius / std::sqrt(length_squared));
  return dot(beside, beside) > reach * reach;
}

Candidates SceneRays::near(const Ray& middle, float spread) const {
  Candidates candidates;
  for (size_t i = 0; i < quad_frames_.size(); ++i) {
    if (!misses(middle, quad_frames_[i].ball, spread)) candidates.quads.push_back(i);
  }
  for (size_t i = 0; i < scene_->spheres.size(); ++i) {
    const Sphere& sphere = scene_->spheres[i];
    if (!misses(middle, {sphere.centre, sphere.radius}, spread)) candidates.spheres.push_back(i);
  }
  for (size_t i = 0; i < block_frames_.size(); ++i) {
    if (!misses(middle, block_frames_[i].ball, spread)) candidates.blocks.push_back(i);
  }
  return candidates;
}

void SceneRays::hit_quad(size_t index, const Ray& ray, Hit& nearest) const {
  const Quad& quad = scene_->quads[index];
  const QuadFrame& frame = quad_frames_[index];
  const float t = dot(quad.corner - ray.origin, frame.normal) / dot(ray.direction, frame.normal);
  if (!(t > kTooNear && t < nearest.t)) return;
  const Vec3 offset = ray.origin + t * ray.direction - quad.corner;
  const float a = dot(offset, frame.to_a), b = dot(offset, frame.to_b);
  if (a < 0 || a > 1 || b < 0 || b > 1) return;
  nearest = {t, facing(frame.normal, ray.direction), (a - 0.5F) * frame.length_u, (b - 0.5F) * frame.length_v,
             &quad.material};
}

void SceneRays::hit_sphere(size_t index, const Ray& ray, Hit& nearest) const {
  const Sphere& sphere = scene_->spheres[index];
  const Vec3 offset = ray.origin - sphere.centre;
  const float a = dot(ray.direction, ray.direction), b = dot(offset, ray.direction);
  const float discriminant = b * b - a * (dot(offset, offset) - sphere.radius * sphere.radius);
  if (discriminant < 0) return;
  const float t = (-b - std::sqrt(discriminant)) / a;
  if (!(t > kTooNear && t < nearest.t)) return;
  const Vec3 normal = (1 / sphere.radius) * (offset + t * ray.direction);
  const float longitude = std::atan2(normal.x, -normal.z), latitude = std::asin(std::clamp(normal.y, -1.0F, 1.0F));
  nearest = {t, normal, sphere.radius * longitude, sphere.radius * latitude, &sphere.material};
}

void SceneRays::hit_block(size_t index, const Ray& ray, Hit& nearest) const {
  const Block& block = scene_->blocks[index];
  const BlockFrame& frame = block_frames_[index];
  const Vec3 origin = turned(ray.origin - block.centre, frame.cosine, frame.sine);
  const Vec3 direction = turned(ray.direction, frame.cosine, frame.sine);
  const float origins[3] = {origin.x, origin.y, origin.z}, steps[3] = {direction.x, direction.y, direction.z};
  const float halves[3] = {block.half_size.x, block.half_size.y, block.half_size.z};

  // The ray is inside the box between the last slab that it enters and the first one that it leaves.
  float enter = -std::numeric_limits<float>::infinity(), leave = std::numeric_limits<float>::infinity();
  size_t axis = 0;
  for (size_t i = 0; i < 3; ++i) {
    const float inverse = 1 / steps[i];
    float near = (-halves[i] - origins[i]) * inverse, far = (halves[i] - origins[i]) * inverse;
    if (near > far) std::swap(near, far);
    if (near > enter) {
      enter = near;
      axis = i;
    }
    leave = std::min(leave, far);
  }
  if (!(enter <= leave && enter > kTooNear && enter < nearest.t)) return;

  const Vec3 place = origin + enter * direction;
  const float side = steps[axis] > 0 ? -1.0F : 1.0F;
  const Vec3 normal{axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
  const float u = axis == 0 ? -side * place.z : place.x, v = axis == 1 ? place.z : place.y;
  nearest = {enter, turned(normal, frame.cosine, -frame.sine), u, v, &block.material};
}

Hit SceneRays::first_hit(const Ray& ray, const Candidates& candidates) const {
  Hit nearest;
  for (size_t i : candidates.quads) hit_quad(i, ray, nearest);
  for (size_t i : candidates.spheres) hit_sphere(i, ray, nearest);
  for (size_t i : candidates.blocks) hit_block(i, ray, nearest);
  return nearest;
}

bool SceneRays::blocked(const Ray& ray) const {
  Hit hit;
  for (size_t i = 0; i < scene_->spheres.size() && hit.material == nullptr; ++i) hit_sphere(i, ray, hit);
  for (size_t i = 0; i < block_frames_.size() && hit.material == nullptr; ++i) {
    if (!misses(ray, block_frames_[i].ball, 0)) hit_block(i, ray, hit);
  }
  for (size_t i = 0; i < quad_frames_.size() && hit.material == nullptr; ++i) hit_quad(i, ray, hit);
  return hit.material != nullptr;
}

}  // namespace e2lf::lightfield
