// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::cli {

/// A full-screen window on a display of this computer. Only in builds with SDL.
class Screen {
 public:
  using Clock = std::chrono::steady_clock;

  /// Opens a window that covers a display, counted from 0. Fails with kNotFound (no such display) and kIo (no
  /// graphics).
  [[nodiscard]] static Result<Screen> open(int display);
  Screen(Screen&& other) noexcept;
  Screen& operator=(Screen&& other) = delete;
  ~Screen();

  [[nodiscard]] size_t width_px() const;
  [[nodiscard]] size_t height_px() const;
  [[nodiscard]] double refresh_us() const;

  /// Returns true if show() waits for the refresh of the display; otherwise, it returns immediately.
  [[nodiscard]] bool is_synchronised() const;

  /// Loads grey pictures that have the size of the display. Fails with kIo.
  [[nodiscard]] Result<void> load(const std::vector<lightfield::ByteImage>& pictures);

  /// Shows one of the pictures from the next refresh on, with a white or black square of `corner_px` in the lower right
  /// corner. Returns the time at which it was shown. Fails with kIo.
  [[nodiscard]] Result<Clock::time_point> show(size_t picture, int corner_px, bool is_corner_white);

  /// Returns true if the user closed the window or pressed Escape.
  [[nodiscard]] bool is_closed();

 private:
  struct Parts;
  explicit Screen(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace e2lf::cli
