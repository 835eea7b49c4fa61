// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// A point or direction of a scene: x points to the right, y down, and z away from the camera. The aperture lies in z =
/// 0.
struct Vec3 {
  float x = 0, y = 0, z = 0;
};

enum class TextureKind {
  kPlain,    ///< fine grain only
  kNoise,    ///< blobs of all sizes
  kChecks,   ///< a chess board
  kStripes,  ///< bars across u
  kBricks,   ///< staggered bricks with joints, each its own brightness
  kWood,     ///< planks along v with grain
  kDots,     ///< discs on a grid
  kMarks,    ///< lines of letter-like signs
  kStar      ///< wedges around the middle of a quad, with detail of every size
};

/// The appearance of a surface: its albedo varies between `dark` and `bright` according to the texture.
struct Material {
  TextureKind texture = TextureKind::kPlain;
  float dark = 0.2F, bright = 0.8F;
  float period = 0.1F;  ///< period of the texture, in units of the scene
  float specular = 0;   ///< strength of the specular highlight
  float grain = 0.2F;   ///< share of fine noise in the albedo
  uint32_t seed = 0;    ///< seed of all randomness in the texture
};

/// A position on a surface, in units of the scene. On quads and blocks, it is measured from the middle of a face.
struct SurfacePoint {
  float u = 0, v = 0;
  float footprint = 0;  ///< width of a pixel there: finer detail is faded out, and edges have this width
};

/// Returns the albedo, in [0, 1], of a material at a position: dark + (bright - dark) * texture.
[[nodiscard]] float albedo(const Material& material, const SurfacePoint& point);

/// The parallelogram corner + a * edge_u + b * edge_v with a and b in [0, 1], visible from both sides.
struct Quad {
  Vec3 corner, edge_u, edge_v;
  Material material;
};

struct Sphere {
  Vec3 centre;
  float radius = 0;
  Material material;
};

/// A box with a horizontal top, rotated by `yaw` (radians) around the vertical axis through its centre.
struct Block {
  Vec3 centre, half_size;
  float yaw = 0;
  Material material;
};

/// A distant lamp and ambient light.
struct Light {
  Vec3 direction{-0.45F, -0.8F, -0.55F};  ///< towards the lamp; any length
  float intensity = 0.85F;
  float ambient = 0.3F;
  float softness = 0.06F;  ///< angular width of the lamp, which blurs the edges of shadows
};

/// An array of pinholes on the plane z = 0 that all see the same rectangle at the focus depth, which fills their
/// pictures.
struct SceneCamera {
  float focus_depth = 1;               ///< z of the plane with disparity 0
  float field_width = 0.8F;            ///< width of the visible rectangle at the focus depth
  float centre_y = 0;                  ///< y of the middle of the picture at the focus depth
  float disparity_at_infinity_px = 4;  ///< fixes the distance of the pinholes, at any picture size
};

struct ProceduralScene {
  SceneCamera camera;
  Light light;
  std::vector<Quad> quads;
  std::vector<Sphere> spheres;
  std::vector<Block> blocks;
};

/// Returns the disparity at depth z: disparity_at_infinity_px * (1 - focus_depth / z). It is smaller for nearer points.
[[nodiscard]] float disparity_at_depth(const SceneCamera& camera, float z);

/// One picture to render. The position of the pinhole is in view steps from the middle of the aperture: view (r, c) of
/// a grid is at y = r - (views_y - 1) / 2, x = c - (views_x - 1) / 2.
struct ViewRequest {
  size_t height = 0, width = 0;
  float view_y = 0, view_x = 0;
  size_t samples_per_pixel = 4;  ///< must be even
};

/// Renders the grey picture [y, x] with values in [0, 1]. Pixel (y, x) covers [y, y + 1) x [x, x + 1). The samples have
/// the same pattern in every pixel of every view, so that a shift by whole pixels is exact. The result does not depend
/// on the number of threads.
[[nodiscard]] Image render_view(const ProceduralScene& scene, const ViewRequest& request);

/// Renders the disparity, in px per view step, of the surface at the centre of each pixel. It is
/// disparity_at_infinity_px in the background.
[[nodiscard]] Image render_disparity(const ProceduralScene& scene, const ViewRequest& request);

/// Renders all views of the grid in `shape` (one channel) as a light field in the convention of light_field.h.
[[nodiscard]] LightField render_light_field(const ProceduralScene& scene, const Shape& shape,
                                            size_t samples_per_pixel = 4);

/// Returns a still life for demonstrations and for tests without data: balls, boxes, books and a test chart on a table
/// in front of a brick wall. Its disparities range from about -2 px (a rod in front) to 1.5 px (the wall), with fine
/// texture everywhere and grey values over the whole range. It suits pictures with an aspect ratio of about 4:3. The
/// seed slightly varies the textures and positions.
[[nodiscard]] ProceduralScene demo_scene(uint64_t seed = 1);

/// Returns a still life on a square table in front of a wall. The table and everything on it are rotated by `turn`
/// radians around its middle, so that the motion is known exactly. The balls move on circles and do not spin. The seed
/// varies the textures.
[[nodiscard]] ProceduralScene turntable_scene(float turn, uint64_t seed = 1);

}  // namespace e2lf::lightfield
