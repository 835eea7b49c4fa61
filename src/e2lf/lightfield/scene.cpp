// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "e2lf/base/threads.h"

namespace e2lf::lightfield {
namespace {

Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3 operator*(float s, const Vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
float dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 normalised(const Vec3& a) {
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

constexpr float kTooNear = 1e-4F;

Vec3 facing(const Vec3& normal, const Vec3& direction) {
  return dot(normal, direction) > 0 ? -1.0F * normal : normal;
}

/// Rotates a vector around the vertical axis.
Vec3 turned(const Vec3& a, float cosine, float sine) {
  return {cosine * a.x + sine * a.z, a.y, cosine * a.z - sine * a.x};
}

/// Intersects rays with the surfaces of a scene: finds the first one, or tests whether there is any.
class SceneRays {
 public:
  /// The scene must outlive this object.
  explicit SceneRays(const ProceduralScene& scene) : scene_(&scene) {
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

  /// Returns the surfaces that can be met by rays with the origin of `middle` and directions that differ from its own
  /// by vectors no longer than `spread`. The test uses bounding spheres, so that some of them may not be met by any
  /// ray.
  [[nodiscard]] Candidates near(const Ray& middle, float spread) const {
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

  [[nodiscard]] Hit first_hit(const Ray& ray, const Candidates& candidates) const {
    Hit nearest;
    for (size_t i : candidates.quads) hit_quad(i, ray, nearest);
    for (size_t i : candidates.spheres) hit_sphere(i, ray, nearest);
    for (size_t i : candidates.blocks) hit_block(i, ray, nearest);
    return nearest;
  }

  [[nodiscard]] bool blocked(const Ray& ray) const {
    Hit hit;
    for (size_t i = 0; i < scene_->spheres.size() && hit.material == nullptr; ++i) hit_sphere(i, ray, hit);
    for (size_t i = 0; i < block_frames_.size() && hit.material == nullptr; ++i) {
      if (!misses(ray, block_frames_[i].ball, 0)) hit_block(i, ray, hit);
    }
    for (size_t i = 0; i < quad_frames_.size() && hit.material == nullptr; ++i) hit_quad(i, ray, hit);
    return hit.material != nullptr;
  }

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

  /// Returns true if all rays within `spread` of this one miss a ball. The point of the ray nearest to its centre is at
  /// t. Rays there are up to spread * t apart, and up to spread * radius more within the ball.
  static bool misses(const Ray& ray, const Ball& ball, float spread) {
    const Vec3 offset = ball.centre - ray.origin;
    const float length_squared = dot(ray.direction, ray.direction);
    const float t = dot(offset, ray.direction) / length_squared;
    const Vec3 beside = offset - t * ray.direction;
    const float reach = ball.radius + spread * (std::abs(t) + ball.radius / std::sqrt(length_squared));
    return dot(beside, beside) > reach * reach;
  }

  void hit_quad(size_t index, const Ray& ray, Hit& nearest) const {
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

  void hit_sphere(size_t index, const Ray& ray, Hit& nearest) const {
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

  void hit_block(size_t index, const Ray& ray, Hit& nearest) const {
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

  const ProceduralScene* scene_;
  std::vector<QuadFrame> quad_frames_;
  std::vector<BlockFrame> block_frames_;
};

/// A position in a pixel and one on the lamp.
struct Sample {
  float y, x;
  float lamp_y, lamp_x;
};

/// Returns the binary digits of i mirrored at the point: 0, 1/2, 1/4, 3/4, ...
float radical_inverse(size_t i) {
  float value = 0;
  for (float digit = 0.5F; i > 0; i >>= 1, digit *= 0.5F) {
    if ((i & 1) != 0) value += digit;
  }
  return value;
}

/// Returns half of a Hammersley set, in which each point is followed by its mirror image at the centre of the pixel.
/// The points are evenly distributed in y, in x and in the square, and each pair is centred by itself.
std::vector<Sample> make_samples(size_t count) {
  std::vector<Sample> samples;
  const auto n = static_cast<float>(count);
  for (size_t i = 0; samples.size() < count; ++i) {
    const float y = (static_cast<float>(i) + 0.5F) / n, x = radical_inverse(i) + 0.5F / n;
    samples.push_back({y, x, y - 0.5F, x - 0.5F});
    samples.push_back({1 - y, 1 - x, 0.5F - y, 0.5F - x});
  }
  return samples;
}

/// Renders pictures of one scene from one pinhole.
class ViewRenderer {
 public:
  ViewRenderer(const ProceduralScene& scene, const ViewRequest& request)
      : scene_(scene), rays_(scene), samples_(make_samples(request.samples_per_pixel)) {
    E2LF_REQUIRE(request.height > 0 && request.width > 0, "a picture needs pixels");
    E2LF_REQUIRE(request.samples_per_pixel > 0 && request.samples_per_pixel % 2 == 0, "samples come in pairs");
    const SceneCamera& camera = scene.camera;
    pixel_ = camera.field_width / static_cast<float>(request.width);
    const float view_step = camera.disparity_at_infinity_px * pixel_;
    pinhole_ = {request.view_x * view_step, request.view_y * view_step, 0};
    middle_y_ = static_cast<float>(request.height) / 2;
    middle_x_ = static_cast<float>(request.width) / 2;
    to_lamp_ = normalised(scene.light.direction);
    const Vec3 elsewhere = std::abs(to_lamp_.z) < 0.9F ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    lamp_x_ = normalised(cross(to_lamp_, elsewhere));
    lamp_y_ = cross(to_lamp_, lamp_x_);
  }

  /// Renders the pixels [begin_x, end_x) of row y.
  void render_grey(size_t y, size_t begin_x, size_t end_x, float* out) const {
    const Candidates candidates = candidates_for(y, begin_x, end_x);
    std::vector<Ray> rays(samples_.size());
    std::vector<Hit> hits(samples_.size());
    for (size_t x = begin_x; x < end_x; ++x) {
      for (size_t i = 0; i < samples_.size(); ++i) {
        rays[i] = ray_through(static_cast<float>(y) + samples_[i].y, static_cast<float>(x) + samples_[i].x);
        hits[i] = rays_.first_hit(rays[i], candidates);
      }
      *out++ = std::clamp(mean_grey(rays, hits), 0.0F, 1.0F);
    }
  }

  void render_disparity(size_t y, size_t begin_x, size_t end_x, float* out) const {
    const SceneCamera& camera = scene_.camera;
    const Candidates candidates = candidates_for(y, begin_x, end_x);
    for (size_t x = begin_x; x < end_x; ++x) {
      const Ray ray = ray_through(static_cast<float>(y) + 0.5F, static_cast<float>(x) + 0.5F);
      const Hit hit = rays_.first_hit(ray, candidates);
      *out++ = hit.material == nullptr ? camera.disparity_at_infinity_px
                                       : disparity_at_depth(camera, hit.t * camera.focus_depth);
    }
  }

 private:
  /// Returns the mean over the samples. If all of them lie on one smooth surface and the first pair agrees, that pair
  /// suffices, because textures have no detail finer than a pixel.
  [[nodiscard]] float mean_grey(const std::vector<Ray>& rays, const std::vector<Hit>& hits) const {
    constexpr float kAgreement = 0.06F;
    const float first = shade(rays[0], hits[0], samples_[0]), second = shade(rays[1], hits[1], samples_[1]);
    const bool one_surface = std::all_of(hits.begin(), hits.end(), [&](const Hit& hit) {
      return hit.material == hits[0].material && dot(hit.normal, hits[0].normal) > 0.9F;
    });
    if (one_surface && std::abs(first - second) < kAgreement) return 0.5F * (first + second);
    float sum = first + second;
    for (size_t i = 2; i < hits.size(); ++i) sum += shade(rays[i], hits[i], samples_[i]);
    return sum / static_cast<float>(hits.size());
  }

  /// Returns the ray from the pinhole to a position in the picture; t = 1 is the focus depth.
  [[nodiscard]] Ray ray_through(float y, float x) const {
    const SceneCamera& camera = scene_.camera;
    const Vec3 target{(x - middle_x_) * pixel_, (y - middle_y_) * pixel_ + camera.centre_y, camera.focus_depth};
    return {pinhole_, target - pinhole_};
  }

  [[nodiscard]] Candidates candidates_for(size_t y, size_t begin_x, size_t end_x) const {
    const float half_width = static_cast<float>(end_x - begin_x) / 2;
    const Ray middle = ray_through(static_cast<float>(y) + 0.5F, static_cast<float>(begin_x) + half_width);
    return rays_.near(middle, pixel_ * (half_width + 1));
  }

  [[nodiscard]] float shade(const Ray& ray, const Hit& hit, const Sample& sample) const {
    if (hit.material == nullptr) return 0;
    const Light& light = scene_.light;
    const Vec3 place = ray.origin + hit.t * ray.direction;
    const Vec3 to_eye = normalised(-1.0F * ray.direction);
    // A pixel is pixel_ * t wide on a surface that faces the camera. On a slanted one, it is stretched along one axis
    // only; the square root distributes this over both axes.
    const float towards_eye = dot(hit.normal, to_eye);
    const float slope = (1 - hit.normal.z * hit.normal.z) / std::max(towards_eye * towards_eye, 1e-6F);
    const float stretch = std::sqrt(std::min(std::sqrt(1 + slope), 10.0F));
    const float colour = albedo(*hit.material, {hit.u, hit.v, pixel_ * hit.t * stretch});

    // Ambient light is stronger from above.
    float value = colour * light.ambient * (0.75F - 0.25F * hit.normal.y);
    const Vec3 to_lamp = normalised(to_lamp_ + light.softness * (sample.lamp_x * lamp_x_ + sample.lamp_y * lamp_y_));
    const float facing = dot(hit.normal, to_lamp);
    if (facing <= 0 || rays_.blocked({place + 1e-3F * hit.normal, to_lamp})) return value;
    value += colour * light.intensity * facing;
    if (hit.material->specular > 0) {
      const float gloss = std::max(0.0F, dot(hit.normal, normalised(to_lamp + to_eye)));
      const float gloss4 = gloss * gloss * gloss * gloss, gloss16 = gloss4 * gloss4 * gloss4 * gloss4;
      value += hit.material->specular * gloss16 * gloss16;
    }
    return value;
  }

  const ProceduralScene& scene_;
  SceneRays rays_;
  std::vector<Sample> samples_;
  float pixel_ = 0;  ///< width of a pixel at the focus depth
  float middle_y_ = 0, middle_x_ = 0;
  Vec3 pinhole_, to_lamp_, lamp_x_, lamp_y_;
};

/// Renders a picture in short runs of pixels, each of which meets only a few surfaces of the scene.
Image render_in_runs(const ProceduralScene& scene, const ViewRequest& request,
                     void (ViewRenderer::*render)(size_t y, size_t begin_x, size_t end_x, float* out) const) {
  constexpr size_t kRun = 16;
  const ViewRenderer renderer(scene, request);
  Image image(request.width, request.height, 1);
  parallel_for(request.height, 1, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      for (size_t x = 0; x < request.width; x += kRun) {
        (renderer.*render)(y, x, std::min(x + kRun, request.width), &image.pixels[y * request.width + x]);
      }
    }
  });
  return image;
}

}  // namespace

float disparity_at_depth(const SceneCamera& camera, float z) {
  return camera.disparity_at_infinity_px * (1 - camera.focus_depth / z);
}

Image render_view(const ProceduralScene& scene, const ViewRequest& request) {
  return render_in_runs(scene, request, &ViewRenderer::render_grey);
}

Image render_disparity(const ProceduralScene& scene, const ViewRequest& request) {
  return render_in_runs(scene, request, &ViewRenderer::render_disparity);
}

LightField render_light_field(const ProceduralScene& scene, const Shape& shape, size_t samples_per_pixel) {
  E2LF_REQUIRE(shape.channels == 1, "scenes are grey");
  LightField light_field(shape);
  for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
    for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
      ViewRequest request{shape.height, shape.width, 0, 0, samples_per_pixel};
      request.view_y = static_cast<float>(view_y) - static_cast<float>(shape.views_y - 1) / 2;
      request.view_x = static_cast<float>(view_x) - static_cast<float>(shape.views_x - 1) / 2;
      const Image image = render_view(scene, request);
      std::copy(image.pixels.begin(), image.pixels.end(), light_field.view(view_y, view_x).begin());
    }
  }
  return light_field;
}

}  // namespace e2lf::lightfield
