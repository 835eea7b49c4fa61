// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/live/pace.h"

namespace e2lf::live {

/// The parameters for rendering a light field. Viewpoints are in view steps from the centre of the grid, as in the
/// viewer.
struct RenderSettings {
  float x = 0.5F, y = 0.5F;  ///< viewpoint, to the right and downwards; by default one of the four central views
  float focus = 0;           ///< disparity of the plane in focus, in px of the full resolution per view step
  float radius = 0;          ///< radius of the round aperture, in view steps; 0 = only the viewpoint
  std::optional<uint32_t> row = {}, column = {};  ///< EPIs to cut, in px of the full resolution; empty = none
  bool operator==(const RenderSettings&) const = default;
};

/// A pattern cycle as the camera delivered it.
struct LiveCycle : cycles::Cycle {
  size_t cycles = 1;               ///< the number of cycles, of which it is the last one, that `images` sums
  capture::FusedCycles fused;      ///< `images`, fused with those of the cycles before; empty if they are not
  double fused_cycles = 0;         ///< mean of the number of cycles over the pixels of `fused`
  double cycle_s = 0;              ///< time from the previous cycle to this one; 0 = unknown
  Clock::time_point last_event{};  ///< arrival of its last event at this host
};

/// The light field of a cycle.
struct LiveField {
  lightfield::LightField light_field;  ///< upright, as computed by the network; see `black` and `gain`
  std::vector<size_t> views;           ///< numbers of the views that are set, in order; empty = all
  RenderSettings settings;             ///< the parameters that determined the views
  LiveCycle cycle;                     ///< always in full resolution
  QualityLevel level;
  float black = 0, gain = 1;  ///< displayed values are gain * (value - black)
  double reconstruct_s = 0;
  uint64_t serial = 0;  ///< counts the light fields from 1

  /// Returns a copy without the light field.
  [[nodiscard]] LiveField without_views() const {
    return {{}, {}, settings, cycle, level, black, gain, reconstruct_s, serial};
  }

  /// Sets all views by make(*this). If this fails, those of `views` are still the only ones that are set.
  template <typename Make>
  Result<void> complete(const Make& make) {
    const std::vector<size_t> set = std::exchange(views, {});
    Result<void> made = make(*this);
    if (!made) views = set;
    return made;
  }
};

/// The images of a light field that are sent to the browser.
struct Picture {
  lightfield::ByteImage image;
  lightfield::ByteImage row_epi, column_epi;  ///< [view_x, x] and [y, view_y]; empty if not requested
};

/// Returns the numbers of the views that render() needs, in order; empty = all.
[[nodiscard]] std::vector<size_t> views_of(const lightfield::Shape& shape, const RenderSettings& settings);

/// Returns whether a light field contains these views, given as by views_of().
[[nodiscard]] bool has_views(const LiveField& field, const std::vector<size_t>& views);

/// Renders the light field with the parameters `settings` to 8 bits: round(255 * clamp(gain * (value - black))).
[[nodiscard]] Picture render(const LiveField& field, const RenderSettings& settings);

/// Returns the disparity from -5 to 5, in px per view step of the full size, at which the views agree best around a
/// point (px of the full size).
[[nodiscard]] float disparity_at(const LiveField& field, float x, float y);

/// Returns a light field whose pixels are repeated to blocks until it has this size, of which its own size is a part:
/// the inverse of sum_blocks(). The last pixels also fill a rest.
[[nodiscard]] lightfield::LightField enlarged(const lightfield::LightField& light_field, size_t height, size_t width);

}  // namespace e2lf::live
