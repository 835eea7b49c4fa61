// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/scene.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/threads.h"
#include "e2lf/lightfield/scene_rays.h"

namespace e2lf::lightfield {
namespace {

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
  ViewRenderer(const Scene& scene, const ViewRequest& request)
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

  const Scene& scene_;
  SceneRays rays_;
  std::vector<Sample> samples_;
  float pixel_ = 0;  ///< width of a pixel at the focus depth
  float middle_y_ = 0, middle_x_ = 0;
  Vec3 pinhole_, to_lamp_, lamp_x_, lamp_y_;
};

/// Renders a picture in short runs of pixels, each of which meets only a few surfaces of the scene.
Image render_in_runs(const Scene& scene, const ViewRequest& request,
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

Image render_view(const Scene& scene, const ViewRequest& request) {
  return render_in_runs(scene, request, &ViewRenderer::render_grey);
}

Image render_disparity(const Scene& scene, const ViewRequest& request) {
  return render_in_runs(scene, request, &ViewRenderer::render_disparity);
}

LightField render_light_field(const Scene& scene, const Shape& shape, size_t samples_per_pixel) {
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
