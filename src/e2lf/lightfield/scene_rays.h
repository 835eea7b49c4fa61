// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// A position on a surface, in units of the scene. On quads and blocks, it is measured from the middle of a face.
struct SurfacePoint {
  float u = 0, v = 0;
  float footprint = 0;  ///< width of a pixel there: finer detail is faded out, and edges have this width
};

/// Returns the albedo, in [0, 1], of a material at a position: dark + (bright - dark) * texture.
[[nodiscard]] float albedo(const Material& material, const SurfacePoint& point);

inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(float s, const Vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline float dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3 normalised(const Vec3& a) {
  return (1 / std::sqrt(dot(a, a))) * a;
}

/// The points origin + t * direction with t > 0. The direction may have any length.
struct Ray {
  Vec3 origin, direction;
};

/// The first intersection of a ray.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  Vec3 normal;                         ///< unit vector on the side from which the ray comes
  float u = 0, v = 0;                  ///< position on the surface, see SurfacePoint
  const Material* material = nullptr;  ///< null if the ray meets no surface
};

/// Indices of the surfaces that a bundle of rays can meet.
struct Candidates {
  std::vector<size_t> quads, spheres, blocks;
};

/// Intersects rays with the surfaces of a scene: finds the first one, or tests whether there is any.
class SceneRays {
 public:
  /// The scene must outlive this object.
  explicit SceneRays(const Scene& scene);

  /// Returns the surfaces that can be met by rays with the origin of `middle` and directions that differ from its own
  /// by vectors no longer than `spread`. The test uses bounding spheres, so that some of them may not be met by any
  /// ray.
  [[nodiscard]] Candidates near(const Ray& middle, float spread) const;

  [[nodiscard]] Hit first_hit(const Ray& ray, const Candidates& candidates) const;
  [[nodiscard]] bool blocked(const Ray& ray) const;

 private:
  struct Ball {
    Vec3 centre;
    float radius;
  };
  /// A quad as a plane with coordinates: a = dot(p - corner, to_a), and likewise b.
  struct QuadFrame {
    Vec3 normal, to_a, to_b;
    float length_u, length_v;
    Ball ball;
  };
  struct BlockFrame {
    float cosine, sine;
    Ball ball;
  };
  static bool misses(const Ray& ray, const Ball& ball, float spread);
  void hit_quad(size_t index, const Ray& ray, Hit& nearest) const;
  void hit_sphere(size_t index, const Ray& ray, Hit& nearest) const;
  void hit_block(size_t index, const Ray& ray, Hit& nearest) const;

  const Scene* scene_;
  std::vector<QuadFrame> quad_frames_;
  std::vector<BlockFrame> block_frames_;
};

}  // namespace e2lf::lightfield
