// SPDX-License-Identifier: MIT
#pragma once

#include <ATen/core/Generator.h>
#include <cstddef>
#include <optional>
#include <span>
#include <torch/types.h>
#include <vector>

#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// The disparity of a plane in the central view: centre + slope . (position - centre of the image), px per view step.
struct Plane {
  double centre = 0, slope_y = 0, slope_x = 0;
  double offset_y = 0, offset_x = 0;  ///< how far the surface, with its maps and its slope, has moved, px
};

/// A textured plane, or a relief on one. The maps are float32 [side, side] around the centre of the image.
struct Surface {
  Plane plane;
  torch::Tensor brightness;
  torch::Tensor coverage;  ///< in [0, 1], clamped after interpolation; if undefined, the surface covers everything
  /// Deviations of the disparity from the plane in the central view, px per view step; undefined for planes. Where
  /// slopes are below 0.1, rays meet the surface to within 0.01 px.
  torch::Tensor relief = {};
};

/// Renders the 8x8 views of surfaces that are ordered back to front: float32 [64, size, size], slightly beyond the
/// range of the maps where the interpolation overshoots. The first surface, and only the first, has no coverage map;
/// all maps must have the same size and device, or the contract is broken. Maps are interpolated bicubically, because
/// bilinear interpolation blurs the finest detail wherever a view samples between pixels, and cameras do not. Beyond
/// the border, the values at the border are repeated. On CPUs, render_view() does the work on all threads if it was
/// built; otherwise views_of_reference() does.
[[nodiscard]] torch::Tensor views_of(const std::vector<Surface>& surfaces, int64_t size);

/// The viewpoint of a view, in view steps from the centre of the aperture.
struct ViewPoint {
  double y = 0, x = 0;
};

/// Returns the disparity that is seen from a viewpoint, float32 [size, size]: that of the nearest surface that covers
/// more than half of a pixel.
[[nodiscard]] torch::Tensor disparity_of(const std::vector<Surface>& surfaces, int64_t size, const ViewPoint& from);

/// Renders the same views with torch operations, on any device. render_view() differs from it by at most 0.002 on white
/// noise.
[[nodiscard]] torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size);

/// Number of steps in which the point is found where a ray meets a relief.
constexpr int kReliefSteps = 3;

/// Border by which maps are extended on every side for the taps of the interpolation, px.
constexpr size_t kMapBorder = 3;

/// A plane and its two maps, interleaved: [side + 2 kMapBorder, side + 2 kMapBorder, 2], brightness and coverage.
struct MappedPlane {
  Plane plane;
  const float* maps = nullptr;
  const float* relief = nullptr;  ///< [side, side], or null
  /// Whether a ray may be covered, by where it meets the plane: [side + kMapBorder, side + kMapBorder], from one px
  /// before the maps; null if rays are covered everywhere.
  const uint8_t* may_cover = nullptr;
};

/// Renders one view [size, size] of planes that are ordered back to front. Each pixel is composed front to back until
/// the remaining planes contribute less than a quarter of a grey level of 255. Positions in the maps are rounded to
/// 1/1024 px. Vector kernel, dispatched at run time.
void render_view(std::span<const MappedPlane> planes, size_t side, const ViewPoint& from, size_t size, float* view);

/// Returns a random brightness map in [0, 1], float32 [side, side]: a crop of a photograph, resized, with a random tone
/// curve.
[[nodiscard]] torch::Tensor photo_texture(const std::vector<torch::Tensor>& photos, int64_t side, Draws& draws);

/// Returns a random brightness map of stripes, noise of several octaves, smooth shading, or a constant.
/// Noise is drawn from `generator`, by default that of torch.
[[nodiscard]] torch::Tensor procedural_texture(int64_t side, Draws& draws, torch::Device device,
                                               const std::optional<at::Generator>& generator = {});

/// Returns a random coverage map in [0, 1], float32 [side, side], of a surface that occludes a part of the surfaces
/// behind it: half planes, ellipses, bars, blobs or the fine structure of `texture`. The edges are one to about eight
/// px wide. Noise is drawn from `generator`, by default that of torch.
[[nodiscard]] torch::Tensor coverage(const torch::Tensor& texture, Draws& draws,
                                     const std::optional<at::Generator>& generator = {});

/// Returns smooth noise of unit variance with features of about `feature_px`, float32 [side, side]. `generator` is one
/// of the CPU; by default, the noise is drawn from that of torch for the device.
[[nodiscard]] torch::Tensor smooth_noise(int64_t side, double feature_px, torch::Device device,
                                         const std::optional<at::Generator>& generator = {});

/// Returns a map of a few soft bright spots in [0, 1], float32 [side, side].
[[nodiscard]] torch::Tensor highlights(int64_t side, Draws& draws, torch::Device device);

struct SynthesiserOptions {
  int64_t size = 96;               ///< height and width of the light fields, px
  double max_disparity = 3.0;      ///< largest absolute disparity, px per view step
  int64_t max_layers = 6;          ///< largest number of surfaces: a background and occluders
  double slant_share = 0.5;        ///< share of surfaces whose disparity varies over the image
  double highlight_share = 0.2;    ///< share of scenes with reflections at a depth of their own
  double procedural_share = 0.25;  ///< share of surfaces with a procedural texture
  double motion_px_per_cycle = 0;  ///< largest speed of a surface
  double still_share = 0.5;        ///< share of scenes that stand still, if others move
};

/// A light field at several times.
struct MovingScene {
  torch::Tensor views;     ///< the scene at time 0, uint8 [64, size, size]
  torch::Tensor at_times;  ///< uint8 [times, 64, size, size]; undefined if the scene stands still
};

/// Synthesises a random light field: textured planes behind one another, slanted or not, with hard, soft and fine
/// occlusion edges, some with highlights. `textures` are photographs uint8 [y, x] of at least 64x64 px; if there are
/// none, all textures are procedural. The result depends only on `seed`, with which torch's generator is reseeded. If
/// there are `times`, in cycles, the surfaces move at constant velocities of up to options.motion_px_per_cycle, in one
/// direction together or each in its own.
[[nodiscard]] MovingScene synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                                     uint64_t seed, torch::Device device, const std::vector<double>& times = {});

}  // namespace e2lf::learn
