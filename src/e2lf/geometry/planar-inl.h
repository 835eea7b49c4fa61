// SPDX-License-Identifier: MIT
// Rows whose channels lie one after another, which shifts read, and their conversion. This file is included once per
// instruction set, after <hwy/highway.h>.
#if defined(E2LF_GEOMETRY_PLANAR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_GEOMETRY_PLANAR_INL_H_
#undef E2LF_GEOMETRY_PLANAR_INL_H_
#else
#define E2LF_GEOMETRY_PLANAR_INL_H_
#endif

#include <algorithm>
#include <string>

#include "e2lf/engine/conv.h"
#include "e2lf/engine/pixel_kernel-inl.h"
#include "e2lf/geometry/shift.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::geometry {
namespace HWY_NAMESPACE {

using namespace engine::HWY_NAMESPACE;
using namespace engine;

// A block is the part of a row that is this wide, so that its lines stay in the cache.
inline constexpr size_t kChunk = 256;

HWY_INLINE size_t chunks_of(const Strip& strip) {
  return (strip.width + kChunk - 1) / kChunk;
}

/// Part of a row: columns [begin, begin + count) of row y, which has `width` columns.
struct Chunk {
  ptrdiff_t y;
  size_t begin, count, width;

  Chunk(const Strip& strip, size_t block)
      : y(static_cast<ptrdiff_t>(strip.begin + block / chunks_of(strip))),
        begin(block % chunks_of(strip) * kChunk),
        count(HWY_MIN(kChunk, strip.width - begin)),
        width(strip.width) {}
};

/// Returns the number of floats of a line that holds a chunk with `reach` pixels on each side of it.
HWY_INLINE size_t line_size(size_t reach) {
  return round_up(kChunk + 2 * reach + 2 * kLanes, kChannelMultiple);
}

/// Fills `line`, whose element 0 is column begin - reach, with vectors of `at(column)`, which may read beyond the last
/// column. Columns outside of the image repeat the one at the edge, or are zero.
template <class At>
HWY_INLINE void fill_line(const Chunk& chunk, size_t reach, bool repeats_edges, float* line, const At& at) {
  const size_t left = chunk.begin < reach ? reach - chunk.begin : 0;
  const size_t end = HWY_MIN(chunk.width + reach - chunk.begin, chunk.count + 2 * reach);
  const ptrdiff_t offset = static_cast<ptrdiff_t>(chunk.begin) - static_cast<ptrdiff_t>(reach);
  for (size_t i = left; i < end; i += kLanes) store_floats(at(offset + static_cast<ptrdiff_t>(i)), line + i);
  std::fill_n(line, left, repeats_edges ? line[left] : 0.0F);
  std::fill(line + end, line + line_size(reach), repeats_edges ? line[end - 1] : 0.0F);
}

/// Sums rows, which begin at column 0, with weights into a line as above.
template <size_t kRows>
HWY_INLINE void blend_rows(const float* const (&rows)[kRows], const float* weights, const Chunk& chunk, size_t reach,
                           bool repeats_edges, float* line) {
  const FloatTag d;
  fill_line(chunk, reach, repeats_edges, line, [&](ptrdiff_t column) HWY_ATTR {
    auto sum = hn::Zero(d);
    for (size_t n = 0; n < kRows; ++n) sum = hn::MulAdd(hn::Set(d, weights[n]), load_floats(rows[n] + column), sum);
    return sum;
  });
}

/// Copies `count` values, which may be fewer than kLanes, without touching those after them.
HWY_INLINE void store_some(FloatVec value, size_t count, float* to) {
  if (count >= kLanes) return store_floats(value, to);
  float values[kLanes];
  store_floats(value, values);
  std::copy_n(values, count, to);
}

/// Interleaves the channels of a chunk, which are kChunk floats apart, into a row of pixels. Padding becomes zero.
template <class Element>
HWY_INLINE void store_pixels(const float* planes, size_t channels, const Chunk& chunk, Element* row) {
  const size_t step = padded_channels(channels);
  row += chunk.begin * step;
  for (size_t x = 0; x < chunk.count; ++x, row += step) {
    for (size_t c = 0; c < channels; ++c) assign(planes[c * kChunk + x], row[c]);
    std::fill(row + channels, row + step, Element{});
  }
}

/// Makes rows of planes of float32 from rows of pixels, with a sigmoid of the first `opacities` channels, of which the
/// last one becomes 1. One block is one row.
template <class Element>
class PlanarKernel final : public Kernel {
 public:
  PlanarKernel(size_t channels, size_t opacities) : channels_(channels), opacities_(opacities) {}

  std::string describe() const override { return std::string("planes ") + hwy::TargetName(HWY_TARGET); }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const auto y = static_cast<ptrdiff_t>(strip.begin + block);
    const size_t step = padded_channels(channels_);
    const auto* from = strip.inputs[0].row<const Element>(y);
    auto* to = strip.output.row<float>(y);
    for (size_t c = 0; c < channels_; ++c, to += strip.width) {
      for (size_t x = 0; x < strip.width; ++x) to[x] = to_float(from[x * step + c]);
      if (c < opacities_) make_opacity(strip.width, c + 1 == opacities_, to);
    }
  }

 private:
  static HWY_INLINE void make_opacity(size_t width, bool is_opaque, float* to) {
    if (is_opaque) {
      std::fill_n(to, width, 1.0F);
      return;
    }
    for (size_t x = 0; x < width; x += kLanes) store_some(sigmoid(load_floats(to + x)), width - x, to + x);
  }

  size_t channels_, opacities_;
};

inline std::unique_ptr<Kernel> make_planar(size_t channels, size_t opacities, ElementType type) {
  return for_element(type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<PlanarKernel<decltype(element)>>(channels, opacities);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::geometry
HWY_AFTER_NAMESPACE();

#endif
