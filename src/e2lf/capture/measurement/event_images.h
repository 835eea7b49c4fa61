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

/// The event images of one cycle: int16 [transition, y, x], row-major. Each value is the sum of the signed events (+1
/// ON, -1 OFF) of a pixel during one transition between patterns (Eq. 2). N patterns have N - 1 transitions.
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

/// The content of an EVENTS.npz file: one entry per cycle, all of the same shape, and the properties of the camera that
/// are known.
struct EventImageFile {
  std::vector<EventImages> cycles;
  std::optional<NpyArray> codes;       ///< [N, view_y, view_x]
  std::optional<NpyArray> camera;      ///< see camera_from_npy()
  std::optional<NpyArray> views = {};  ///< the orientation of the views; see views_from_npy()
};

/// Reads event images from
///  - an .npz file with `events` [cycles, N-1, y, x] or [N-1, y, x] (any integer type, or floats with integral values)
///  and optionally `codes`, `camera` and `views`;
///  - a .mat file before version 7.3 with the same arrays, whose axes are in MATLAB's order: events (y, x, N-1,
///  cycles), codes (view_y, view_x, N), camera and views (1, length);
///  - an .npy file of either shape;
///  - a folder of event_image_00000.npy, ... as the paper's software writes them, [y, x] or [y, x, 1], one per
///  transition.
/// Fails with kInvalidValue (NaN, fractions, or values beyond int16), kShape (images of different sizes), kNotFound (no
/// such file or array, or a missing number in a folder), kUnsupported (another extension) and as the readers of these
/// formats do.
[[nodiscard]] Result<EventImageFile> read_event_images(const std::filesystem::path& path);

/// Writes an .npz file with `events` int16 [cycles, N-1, y, x] and, if given, `codes`, `camera` and `views`. All cycles
/// must have the same shape. Fails with kIo.
[[nodiscard]] Result<void> write_event_images(const std::filesystem::path& path, const EventImageFile& file);

/// Writes a .mat file with the same arrays, in the axis order that read_event_images() describes. Fails with kIo, and
/// with kUnsupported (2 GiB or more, or codes of a type that MATLAB does not have).
[[nodiscard]] Result<void> write_event_images_mat(const std::filesystem::path& path, const EventImageFile& file);

}  // namespace e2lf::capture
