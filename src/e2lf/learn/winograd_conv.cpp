// SPDX-License-Identifier: MIT
#include "e2lf/learn/winograd_conv.h"

#include <algorithm>
#include <vector>

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/learn/winograd_conv.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/winograd-inl.h"

#ifndef E2LF_LEARN_WINOGRAD_CONV_ONCE
#define E2LF_LEARN_WINOGRAD_CONV_ONCE
namespace e2lf::learn {

using engine::kTileSize, engine::kWinogradMatrices, engine::kWinogradPoints, engine::padded_channels;

/// Tiles that go through all steps together, so that what lies between the steps stays in the cache.
constexpr size_t kBlockTiles = 24;

constexpr size_t kTaps = 3;

/// Where a tile's pixels are: images, then rows, then columns of tiles.
struct Tile {
  size_t image, y, x;
};

inline Tile tile_at(const ConvShape& shape, size_t index) {
  const size_t columns = (shape.width + kTileSize - 1) / kTileSize, in_image = index % tiles_per_image(shape);
  return {index / tiles_per_image(shape), in_image / columns * kTileSize, in_image % columns * kTileSize};
}

/// The pixels of a tile with `before` more above and to the left of it, kSide x kSide; null outside the image.
template <size_t kSide, class T>
struct Pixels {
  T* at[kSide][kSide];

  Pixels(const ConvShape& shape, T* tensor, size_t channels, const Tile& tile, size_t before) {
    for (size_t i = 0; i < kSide; ++i) {
      for (size_t j = 0; j < kSide; ++j) {
        const size_t y = tile.y + i - before, x = tile.x + j - before;  // wraps below zero
        const bool inside = tensor != nullptr && y < shape.height && x < shape.width;
        at[i][j] = inside ? tensor + ((tile.image * shape.height + y) * shape.width + x) * channels : nullptr;
      }
    }
  }
};

/// Calls run(first, count) for blocks of nearly the same size.
template <class Run>
void for_blocks(size_t first, size_t end, const Run& run) {
  const size_t count = end - first, blocks = (count + kBlockTiles - 1) / kBlockTiles;
  for (size_t block = 0; block < blocks; ++block) {
    const size_t begin = first + count * block / blocks;
    run(begin, first + count * (block + 1) / blocks - begin);
  }
}

}  // namespace e2lf::learn
#endif

HWY_BEFORE_NAMESPACE();
namespace e2lf::learn {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace en = engine::HWY_NAMESPACE;
using en::FloatTag, en::FloatVec, en::kA, en::kB, en::kGemmRows, en::kGemmVectors, en::kLanes;
using Square = FloatVec[kWinogradPoints][kWinogradPoints];

/// Access to kLanes channels of a pixel.
struct WholeVector {
  HWY_INLINE FloatVec load(const float* from) const { return hn::LoadU(FloatTag(), from); }
  HWY_INLINE void store(FloatVec value, float* to) const { hn::StoreU(value, FloatTag(), to); }
};

/// Access to fewer: the last channels. Masked loads read beyond where the instruction set has none.
struct PartOfVector {
  size_t count;
  HWY_INLINE FloatVec load(const float* from) const {
    alignas(64) float values[kLanes] = {};
    for (size_t i = 0; i < count; ++i) values[i] = from[i];
    return hn::Load(FloatTag(), values);
  }
  HWY_INLINE void store(FloatVec value, float* to) const {
    alignas(64) float values[kLanes];
    hn::Store(value, FloatTag(), values);
    for (size_t i = 0; i < count; ++i) to[i] = values[i];
  }
};

/// Calls run(first channel, access) for all channels.
template <class Run>
HWY_INLINE void for_channels(size_t channels, const Run& run) {
  size_t channel = 0;
  for (; channel + kLanes <= channels; channel += kLanes) run(channel, WholeVector());
  if (channel < channels) run(channel, PartOfVector{channels - channel});
}

template <class Access>
HWY_INLINE FloatVec load_pixel(const float* pixel, size_t channel, const Access& access) {
  return pixel == nullptr ? hn::Zero(FloatTag()) : access.load(pixel + channel);
}

/// A matrix read element by element: (row, column) is at data[row * row_step + column * column_step].
struct Factor {
  const float* data;
  size_t row_step, column_step;
};

/// `product` (rows `columns` wide) is set to the product of kRows rows of `a` and kVectors vectors of columns of b, or
/// has it added (kAdd). Rows of b are `columns` wide, too.
template <bool kAdd, size_t kRows, size_t kVectors>
HWY_INLINE void multiply_block(const Factor& a, size_t depth, const float* HWY_RESTRICT b, size_t columns,
                               float* HWY_RESTRICT product) {
  const FloatTag d;
  FloatVec sums[kRows][kVectors];
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j)
      sums[i][j] = kAdd ? hn::LoadU(d, product + i * columns + j * kLanes) : hn::Zero(d);
  }
  const float* HWY_RESTRICT from = a.data;
  for (size_t k = 0; k < depth; ++k) {
    FloatVec row[kVectors];
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) row[j] = hn::LoadU(d, b + j * kLanes);
    E2LF_UNROLL
    for (size_t i = 0; i < kRows; ++i) {
      const auto factor = hn::Set(d, from[i * a.row_step]);
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) sums[i][j] = hn::MulAdd(factor, row[j], sums[i][j]);
    }
    from += a.column_step;
    b += columns;
  }
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) hn::StoreU(sums[i][j], d, product + i * columns + j * kLanes);
  }
}

/// All rows, for kVectors vectors of columns.
template <bool kAdd, size_t kVectors>
HWY_INLINE void multiply_rows(Factor a, size_t rows, size_t depth, const float* b, size_t columns, float* product) {
  static_assert(kGemmRows == 6);
  for (; rows >= kGemmRows; rows -= kGemmRows) {
    multiply_block<kAdd, kGemmRows, kVectors>(a, depth, b, columns, product);
    a.data += kGemmRows * a.row_step;
    product += kGemmRows * columns;
  }
  if (rows == 1) multiply_block<kAdd, 1, kVectors>(a, depth, b, columns, product);
  if (rows == 2) multiply_block<kAdd, 2, kVectors>(a, depth, b, columns, product);
  if (rows == 3) multiply_block<kAdd, 3, kVectors>(a, depth, b, columns, product);
  if (rows == 4) multiply_block<kAdd, 4, kVectors>(a, depth, b, columns, product);
  if (rows == 5) multiply_block<kAdd, 5, kVectors>(a, depth, b, columns, product);
}

/// product = a b, or product += a b; a is [rows, depth], b [depth, columns], columns a multiple of 16.
template <bool kAdd>
void multiply(const Factor& a, size_t rows, size_t depth, const float* b, size_t columns, float* product) {
  size_t column = 0;
  for (; column + kGemmVectors * kLanes <= columns; column += kGemmVectors * kLanes) {
    multiply_rows<kAdd, kGemmVectors>(a, rows, depth, b + column, columns, product + column);
  }
  for (; column < columns; column += kLanes) {
    multiply_rows<kAdd, 1>(a, rows, depth, b + column, columns, product + column);
  }
}

/// Transforms the 6x6 pixels that a tile depends on; point p goes to `to` + p * step.
void transform_tile(const Pixels<kWinogradPoints, const float>& pixels, size_t channels, float* to, size_t step) {
  for_channels(channels, [&](size_t channel, const auto& access) HWY_ATTR {
    Square half;
    E2LF_UNROLL
    for (size_t j = 0; j < kWinogradPoints; ++j) {
      FloatVec column[kWinogradPoints], v[kWinogradPoints];
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) column[i] = load_pixel(pixels.at[i][j], channel, access);
      en::transform_input(column, v);
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) half[i][j] = v[i];
    }
    float* point = to + channel;
    E2LF_UNROLL
    for (size_t i = 0; i < kWinogradPoints; ++i) {
      FloatVec v[kWinogradPoints];
      en::transform_input(half[i], v);
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j, point += step) hn::StoreU(v[j], FloatTag(), point);
    }
  });
}

/// The 4x4 outputs of a tile from the sums at its points.
void finish_tile(const ConvShape& shape, const ConvForward& job, const Tile& tile, const float* sums, size_t step) {
  const Pixels<kTileSize, float> outputs(shape, job.y, shape.out_channels, tile, 0);
  const Pixels<kTileSize, const float> residuals(shape, job.residual, shape.out_channels, tile, 0);
  const FloatTag d;
  const auto floor = hn::Set(d, job.relu ? 0.0F : -std::numeric_limits<float>::infinity());
  for_channels(shape.out_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    FloatVec half[kTileSize][kWinogradPoints];
    const float* point = sums + channel;
    E2LF_UNROLL
    for (size_t i = 0; i < kWinogradPoints; ++i) {
      FloatVec row[kWinogradPoints], v[kTileSize];
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j, point += step) row[j] = hn::LoadU(d, point);
      en::transform_output(row, v);
      E2LF_UNROLL
      for (size_t j = 0; j < kTileSize; ++j) half[j][i] = v[j];
    }
    const auto bias = access.load(job.bias + channel);
    E2LF_UNROLL
    for (size_t j = 0; j < kTileSize; ++j) {
      FloatVec v[kTileSize];
      en::transform_output(half[j], v);
      E2LF_UNROLL
      for (size_t i = 0; i < kTileSize; ++i) {
        if (outputs.at[i][j] == nullptr) continue;
        const auto sum = hn::Add(hn::Add(v[i], bias), load_pixel(residuals.at[i][j], channel, access));
        access.store(hn::Max(sum, floor), outputs.at[i][j] + channel);
      }
    }
  });
}

/// A y: the adjoint of transform_output().
HWY_INLINE void spread_output(const FloatVec (&y)[kTileSize], FloatVec (&m)[kWinogradPoints]) {
  const FloatTag d;
  const auto even_a = hn::MulAdd(hn::Set(d, kA * kA), y[2], y[0]);
  const auto odd_a = hn::MulAdd(hn::Set(d, kA * kA * kA), y[3], hn::Mul(hn::Set(d, kA), y[1]));
  const auto even_b = hn::MulAdd(hn::Set(d, kB * kB), y[2], y[0]);
  const auto odd_b = hn::MulAdd(hn::Set(d, kB * kB * kB), y[3], hn::Mul(hn::Set(d, kB), y[1]));
  m[0] = y[0];
  m[1] = hn::Add(even_a, odd_a);
  m[2] = hn::Sub(even_a, odd_a);
  m[3] = hn::Add(even_b, odd_b);
  m[4] = hn::Sub(even_b, odd_b);
  m[5] = y[3];
}

/// B v: the adjoint of transform_input().
HWY_INLINE void spread_input(const FloatVec (&v)[kWinogradPoints], FloatVec (&x)[kWinogradPoints]) {
  const FloatTag d;
  const auto a2 = hn::Set(d, kA * kA), b2 = hn::Set(d, kB * kB);
  const auto a2b2 = hn::Set(d, kA * kA * kB * kB), a2_plus_b2 = hn::Set(d, kA * kA + kB * kB);
  const auto even_a = hn::Add(v[1], v[2]), even_b = hn::Add(v[3], v[4]);
  const auto odd_a = hn::Mul(hn::Set(d, kA), hn::Sub(v[1], v[2]));
  const auto odd_b = hn::Mul(hn::Set(d, kB), hn::Sub(v[3], v[4]));
  x[0] = hn::Mul(a2b2, v[0]);
  x[1] = hn::NegMulAdd(b2, odd_a, hn::NegMulAdd(a2, odd_b, hn::Mul(a2b2, v[5])));
  x[2] = hn::NegMulAdd(b2, even_a, hn::NegMulAdd(a2, even_b, hn::Neg(hn::Mul(a2_plus_b2, v[0]))));
  x[3] = hn::NegMulAdd(a2_plus_b2, v[5], hn::Add(odd_a, odd_b));
  x[4] = hn::Add(v[0], hn::Add(even_a, even_b));
  x[5] = v[5];
}

/// Spreads the gradient of a tile's outputs over its points, and adds it to the bias's.
void spread_tile(const ConvShape& shape, const ConvBackward& job, const Tile& tile, float* to, size_t step) {
  const Pixels<kTileSize, const float> gradients(shape, job.dy, shape.out_channels, tile, 0);
  const Pixels<kTileSize, const float> outputs(shape, job.y, shape.out_channels, tile, 0);
  const FloatTag d;
  for_channels(shape.out_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    FloatVec half[kWinogradPoints][kTileSize];
    auto sum = access.load(job.dbias + channel);
    E2LF_UNROLL
    for (size_t j = 0; j < kTileSize; ++j) {
      FloatVec column[kTileSize], m[kWinogradPoints];
      E2LF_UNROLL
      for (size_t i = 0; i < kTileSize; ++i) {
        column[i] = load_pixel(gradients.at[i][j], channel, access);
        if (outputs.at[i][j] != nullptr) {
          const auto output = access.load(outputs.at[i][j] + channel);
          column[i] = hn::IfThenElseZero(hn::Gt(output, hn::Zero(d)), column[i]);
        }
        sum = hn::Add(sum, column[i]);
      }
      spread_output(column, m);
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) half[i][j] = m[i];
    }
    access.store(sum, job.dbias + channel);
    float* point = to + channel;
    E2LF_UNROLL
    for (size_t i = 0; i < kWinogradPoints; ++i) {
      FloatVec m[kWinogradPoints];
      spread_output(half[i], m);
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j, point += step) hn::StoreU(m[j], d, point);
    }
  });
}

/// Adds to the gradient of the 6x6 pixels that a tile depends on what its points give.
void collect_tile(const ConvShape& shape, float* dx, const Tile& tile, const float* points, size_t step) {
  const Pixels<kWinogradPoints, float> pixels(shape, dx, shape.in_channels, tile, 1);
  const FloatTag d;
  for_channels(shape.in_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    Square half;
    const float* point = points + channel;
    E2LF_UNROLL
    for (size_t i = 0; i < kWinogradPoints; ++i) {
      FloatVec row[kWinogradPoints], x[kWinogradPoints];
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j, point += step) row[j] = hn::LoadU(d, point);
      spread_input(row, x);
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j) half[j][i] = x[j];
    }
    E2LF_UNROLL
    for (size_t j = 0; j < kWinogradPoints; ++j) {
      FloatVec x[kWinogradPoints];
      spread_input(half[j], x);
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        if (pixels.at[i][j] == nullptr) continue;
        float* to = pixels.at[i][j] + channel;
        access.store(hn::Add(access.load(to), x[i]), to);
      }
    }
  });
}

// What a matrix of the weights is of the taps, at the points in order: (g0 + point g1 + point^2 g2) * scale.
constexpr float kScaleZero = 1.0F / (kA * kA * kB * kB);
constexpr float kScaleA = 1.0F / (2.0F * kA * kA * (kA * kA - kB * kB));
constexpr float kScaleB = 1.0F / (2.0F * kB * kB * (kB * kB - kA * kA));

/// G g.
HWY_INLINE void transform_taps(const FloatVec (&g)[kTaps], FloatVec (&u)[kWinogradPoints]) {
  const FloatTag d;
  const auto pair = [&](float point, float scale, FloatVec& plus, FloatVec& minus) HWY_ATTR {
    const auto even = hn::Mul(hn::Set(d, scale), hn::MulAdd(hn::Set(d, point * point), g[2], g[0]));
    const auto odd = hn::Mul(hn::Set(d, scale * point), g[1]);
    plus = hn::Add(even, odd);
    minus = hn::Sub(even, odd);
  };
  u[0] = hn::Mul(hn::Set(d, kScaleZero), g[0]);
  pair(kA, kScaleA, u[1], u[2]);
  pair(kB, kScaleB, u[3], u[4]);
  u[5] = g[2];
}

/// G^T u: its adjoint.
HWY_INLINE void collect_taps(const FloatVec (&u)[kWinogradPoints], FloatVec (&g)[kTaps]) {
  const FloatTag d;
  const auto even_a = hn::Mul(hn::Set(d, kScaleA), hn::Add(u[1], u[2]));
  const auto even_b = hn::Mul(hn::Set(d, kScaleB), hn::Add(u[3], u[4]));
  g[0] = hn::MulAdd(hn::Set(d, kScaleZero), u[0], hn::Add(even_a, even_b));
  g[1] =
      hn::MulAdd(hn::Set(d, kScaleA * kA), hn::Sub(u[1], u[2]), hn::Mul(hn::Set(d, kScaleB * kB), hn::Sub(u[3], u[4])));
  g[2] = hn::MulAdd(hn::Set(d, kA * kA), even_a, hn::MulAdd(hn::Set(d, kB * kB), even_b, u[5]));
}

void TapsToMatrices(const float* taps, size_t rows, size_t columns, float* matrices) {
  const size_t width = padded_channels(columns), step = rows * width;
  for (size_t row = 0; row < rows; ++row) {
    for_channels(columns, [&](size_t column, const auto& access) HWY_ATTR {
      FloatVec half[kWinogradPoints][kTaps];
      E2LF_UNROLL
      for (size_t j = 0; j < kTaps; ++j) {
        FloatVec g[kTaps], u[kWinogradPoints];
        E2LF_UNROLL
        for (size_t i = 0; i < kTaps; ++i) g[i] = access.load(taps + ((i * kTaps + j) * rows + row) * columns + column);
        transform_taps(g, u);
        E2LF_UNROLL
        for (size_t i = 0; i < kWinogradPoints; ++i) half[i][j] = u[i];
      }
      float* to = matrices + row * width + column;
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        FloatVec u[kWinogradPoints];
        transform_taps(half[i], u);
        E2LF_UNROLL
        for (size_t j = 0; j < kWinogradPoints; ++j, to += step) hn::StoreU(u[j], FloatTag(), to);
      }
    });
  }
}

void MatricesToTaps(const float* matrices, size_t rows, size_t columns, float* taps) {
  const size_t width = padded_channels(columns), step = rows * width;
  for (size_t row = 0; row < rows; ++row) {
    for_channels(columns, [&](size_t column, const auto& access) HWY_ATTR {
      FloatVec half[kTaps][kWinogradPoints];
      const float* from = matrices + row * width + column;
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        FloatVec u[kWinogradPoints], g[kTaps];
        E2LF_UNROLL
        for (size_t j = 0; j < kWinogradPoints; ++j, from += step) u[j] = hn::LoadU(FloatTag(), from);
        collect_taps(u, g);
        E2LF_UNROLL
        for (size_t j = 0; j < kTaps; ++j) half[j][i] = g[j];
      }
      E2LF_UNROLL
      for (size_t j = 0; j < kTaps; ++j) {
        FloatVec g[kTaps];
        collect_taps(half[j], g);
        E2LF_UNROLL
        for (size_t i = 0; i < kTaps; ++i) access.store(g[i], taps + ((i * kTaps + j) * rows + row) * columns + column);
      }
    });
  }
}

/// Memory for the points of a block of tiles: [36, tile, padded channel].
struct BlockPoints {
  explicit BlockPoints(size_t channels)
      : width(padded_channels(channels)),
        step(kBlockTiles * width),
        memory(hwy::AllocateAligned<float>(kWinogradMatrices * step)) {}

  [[nodiscard]] float* tile(size_t index) const { return memory.get() + index * width; }
  [[nodiscard]] float* matrix(size_t point) const { return memory.get() + point * step; }

  size_t width, step;
  hwy::AlignedFreeUniquePtr<float[]> memory;
};

void transform_block(const ConvShape& shape, const float* x, size_t first, size_t count, const BlockPoints& points) {
  for (size_t i = 0; i < count; ++i) {
    const Pixels<kWinogradPoints, const float> pixels(shape, x, shape.in_channels, tile_at(shape, first + i), 1);
    transform_tile(pixels, shape.in_channels, points.tile(i), points.step);
  }
}

void Forward(const ConvShape& shape, const ConvForward& job, size_t first_tile, size_t end_tile) {
  const BlockPoints inputs(shape.in_channels), sums(shape.out_channels);
  for_blocks(first_tile, end_tile, [&](size_t first, size_t count) {
    transform_block(shape, job.x, first, count, inputs);
    for (size_t point = 0; point < kWinogradMatrices; ++point) {
      multiply<false>({inputs.matrix(point), inputs.width, 1}, count, shape.in_channels,
                      job.matrices + point * shape.in_channels * sums.width, sums.width, sums.matrix(point));
    }
    for (size_t i = 0; i < count; ++i) finish_tile(shape, job, tile_at(shape, first + i), sums.tile(i), sums.step);
  });
}

void Backward(const ConvShape& shape, const ConvBackward& job, size_t first_image, size_t end_image) {
  const BlockPoints inputs(shape.in_channels), outputs(shape.out_channels);
  const size_t tiles = tiles_per_image(shape);
  for_blocks(first_image * tiles, end_image * tiles, [&](size_t first, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      spread_tile(shape, job, tile_at(shape, first + i), outputs.tile(i), outputs.step);
    }
    transform_block(shape, job.x, first, count, inputs);
    for (size_t point = 0; point < kWinogradMatrices; ++point) {
      multiply<true>({inputs.matrix(point), 1, inputs.width}, shape.in_channels, count, outputs.matrix(point),
                     outputs.width, job.dmatrices + point * shape.in_channels * outputs.width);
      if (job.dx == nullptr) continue;
      multiply<false>({outputs.matrix(point), outputs.width, 1}, count, shape.out_channels,
                      job.matrices + point * shape.out_channels * inputs.width, inputs.width, inputs.matrix(point));
    }
    if (job.dx == nullptr) return;
    for (size_t i = 0; i < count; ++i) {
      collect_tile(shape, job.dx, tile_at(shape, first + i), inputs.tile(i), inputs.step);
    }
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace e2lf::learn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::learn {

HWY_EXPORT(TapsToMatrices);
HWY_EXPORT(MatricesToTaps);
HWY_EXPORT(Forward);
HWY_EXPORT(Backward);

size_t tiles_per_image(const ConvShape& shape) {
  return ((shape.height + kTileSize - 1) / kTileSize) * ((shape.width + kTileSize - 1) / kTileSize);
}

size_t winograd_matrices_size(size_t rows, size_t columns) {
  return kWinogradMatrices * rows * padded_channels(columns);
}

void to_winograd_matrices(const float* taps, size_t rows, size_t columns, float* matrices) {
  HWY_DYNAMIC_DISPATCH(TapsToMatrices)(taps, rows, columns, matrices);
}

void from_winograd_matrices(const float* matrices, size_t rows, size_t columns, float* taps) {
  HWY_DYNAMIC_DISPATCH(MatricesToTaps)(matrices, rows, columns, taps);
}

void conv_forward(const ConvShape& shape, const ConvForward& job, size_t first, size_t end) {
  HWY_DYNAMIC_DISPATCH(Forward)(shape, job, first, end);
}

void conv_backward(const ConvShape& shape, const ConvBackward& job, size_t first, size_t end) {
  HWY_DYNAMIC_DISPATCH(Backward)(shape, job, first, end);
}

}  // namespace e2lf::learn
#endif
