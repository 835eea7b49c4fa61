// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::streams {

/// A period in which the light on each pixel changes linearly, from `from` at begin_us to `to` at end_us. Both are
/// images [y, x] of intensities, where 1 is the white of the light field through an open aperture; they may be the same
/// span. Light may jump between segments. A pattern of the aperture is shown in one segment or in several consecutive
/// ones.
struct LightSegment {
  int64_t begin_us = 0, end_us = 0;
  std::span<const float> from, to;
  uint64_t pattern = 0;  ///< counted from the first pattern of the stream, not of its cycle
  int64_t pattern_begin_us = 0, pattern_end_us = 0;
  bool is_black = false;  ///< true if all cells of the pattern are closed

  [[nodiscard]] bool begins_pattern() const { return begin_us == pattern_begin_us; }
};

}  // namespace e2lf::streams
