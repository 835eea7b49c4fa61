// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// Event images of one cycle: int16 [transition, y, x], row-major; each value is the sum of the signed events (+1 ON,
/// -1 OFF) of a pixel in one pattern transition (Eq. 2). N patterns make N - 1 transitions.
struct EventImages {
  size_t transitions = 0, height = 0, width = 0;
  std::vector<int16_t> counts;

  EventImages() = default;
  EventImages(size_t transitions_, size_t height_, size_t width_)
      : transitions(transitions_), height(height_), width(width_), counts(transitions_ * height_ * width_) {}

  [[nodiscard]] size_t image_size() const { return height * width; }
  [[nodiscard]] std::span<int16_t> image(size_t transition) {
    return std::span(counts).subspan(transition * image_size(), image_size());
  }
  [[nodiscard]] std::span<const int16_t> image(size_t transition) const {
    return std::span(counts).subspan(transition * image_size(), image_size());
  }
  bool operator==(const EventImages&) const = default;
};

/// What an EVENTS.npz holds: one entry per cycle, all of one shape, and what is known of how they came about.
struct EventImageFile {
  std::vector<EventImages> cycles;
  std::optional<NpyArray> codes;       ///< [N, view_y, view_x]
  std::optional<NpyArray> camera;      ///< see camera_from_npy()
  std::optional<NpyArray> views = {};  ///< how the views come out; see views_from_npy()
};

/// Reads event images from
///  - an .npz with `events` [cycles, N-1, y, x] or [N-1, y, x] (any integer type, or float with whole values) and maybe
///  `codes`, `camera` and `views`;
///  - a .mat before version 7.3 with the same arrays, their axes in MATLAB's order: events (y, x, N-1, cycles), codes
///  (view_y, view_x, N), camera and views (1, length);
///  - an .npy of either shape;
///  - a folder of event_image_00000.npy ... as the paper's software writes them, [y, x] or [y, x, 1] each, one per
///  transition.
/// NaN, fractions and values beyond int16 are kInvalidValue, different sizes or a missing number kShape / kNotFound.
[[nodiscard]] Result<EventImageFile> read_event_images(const std::filesystem::path& path);

/// Writes `events` int16 [cycles, N-1, y, x], and `codes`, `camera` and `views` when given, as an .npz. All cycles must
/// have one shape. Fails with kIo.
[[nodiscard]] Result<void> write_event_images(const std::filesystem::path& path, const EventImageFile& file);

/// The same as a .mat, with its axes as read_event_images() says. Fails with kIo, and with kUnsupported (2 GiB or more,
/// codes of a type that MATLAB has not).
[[nodiscard]] Result<void> write_event_images_mat(const std::filesystem::path& path, const EventImageFile& file);

}  // namespace e2lf::capture
