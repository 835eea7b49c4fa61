// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::streams {

/// A stretch of time in which the light of each pixel changes linearly, from `from` at begin_us to `to` at end_us. Both
/// are images [y, x] of intensities, 1 = the light field's white through an open aperture; they may be the same. Light
/// may jump between segments. A pattern of the aperture is shown in one segment or in several that follow on each
/// other.
struct LightSegment {
  int64_t begin_us = 0, end_us = 0;
  std::span<const float> from, to;
  uint64_t pattern = 0;  ///< counted from the first one of the stream, not from the first of its cycle
  int64_t pattern_begin_us = 0, pattern_end_us = 0;
  bool is_black = false;  ///< all cells of the pattern are closed

  [[nodiscard]] bool begins_pattern() const { return begin_us == pattern_begin_us; }
};

}  // namespace e2lf::streams
