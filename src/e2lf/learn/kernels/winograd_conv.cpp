// SPDX-License-Identifier: MIT
#include "e2lf/learn/kernels/winograd_conv.h"

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/learn/kernels/winograd_conv.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/kernels/winograd-inl.h"

#ifndef E2LF_LEARN_WINOGRAD_CONV_ONCE
#define E2LF_LEARN_WINOGRAD_CONV_ONCE
namespace e2lf::learn {

using kernels::kTileSize, kernels::kWinogradMatrices, kernels::kWinogradPoints, kernels::padded_channels;

/// Number of tiles that pass through all steps together, so that the intermediate results stay in the cache.
constexpr size_t kBlockTiles = 24;

/// The position of a tile. Tiles are ordered by image, row and column.
struct Tile {
  size_t image, y, x;
};

inline Tile tile_at(const ConvShape& shape, size_t index) {
  const size_t columns = (shape.width + kTileSize - 1) / kTileSize, in_image = index % tiles_per_image(shape);
  return {index / tiles_per_image(shape), in_image / columns * kTileSize, in_image % columns * kTileSize};
}

/// Pointers to the kSide x kSide pixels of a tile, with `before` additional ones above and to the left; null outside
/// the image.
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
namespace kn = kernels::HWY_NAMESPACE;

using kn::FloatTag, kn::FloatVec, kn::kGemmRows, kn::kGemmVectors, kn::kLanes, kn::kTaps;

// Products of small matrices.

/// A matrix that is read element by element: (row, column) is at data[row * row_step + column * column_step].
struct Factor {
  const float* data;
  size_t row_step, column_step;
};

/// Computes the product of kRows rows of `a` and kVectors vectors of columns of `b`, and stores it in `product` or adds
/// it (kAdd). The rows of `b`, which is aligned, and of `product` have `columns` elements.
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
  kn::multiply_accumulate<kn::FloatProducts>(a.data, a.row_step, b, columns, depth, sums, a.column_step);
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) hn::StoreU(sums[i][j], d, product + i * columns + j * kLanes);
  }
}

/// Computes the product of all rows for kVectors vectors of columns.
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

/// Computes product = a b, or product += a b (kAdd), where `a` is [rows, depth], `b` is [depth, columns], and `columns`
/// is a multiple of 16.
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

// Transforms of tiles.

/// Access to kLanes channels of a pixel.
struct WholeVector {
  HWY_INLINE FloatVec load(const float* from) const { return hn::LoadU(FloatTag(), from); }
  HWY_INLINE void store(FloatVec value, float* to) const { hn::StoreU(value, FloatTag(), to); }
};

/// Access to the last channels, which are fewer. Masked loads read beyond them where the instruction set has none.
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

/// A transform of winograd-inl.h as an object.
#define E2LF_TRANSFORM(name) [](const auto& line, auto& transformed) HWY_ATTR { kn::name(line, transformed); }

/// Transforms the 6x6 pixels that a tile depends on; point p goes to `to` + p * step.
void transform_tile(const Pixels<kWinogradPoints, const float>& pixels, size_t channels, float* to, size_t step) {
  for_channels(channels, [&](size_t channel, const auto& access) HWY_ATTR {
    kn::transform_square<kWinogradPoints, kWinogradPoints>(
        E2LF_TRANSFORM(transform_input),
        [&](size_t i, size_t j) HWY_ATTR { return load_pixel(pixels.at[i][j], channel, access); },
        [&](size_t i, size_t j, FloatVec value)
            HWY_ATTR { hn::StoreU(value, FloatTag(), to + channel + (i * kWinogradPoints + j) * step); });
  });
}

/// Computes the 4x4 outputs of a tile from the sums at its points.
void finish_tile(const ConvShape& shape, const ConvForward& job, const Tile& tile, const float* sums, size_t step) {
  const Pixels<kTileSize, float> outputs(shape, job.y, shape.out_channels, tile, 0);
  const Pixels<kTileSize, const float> residuals(shape, job.residual, shape.out_channels, tile, 0);
  const FloatTag d;
  const auto floor = hn::Set(d, job.relu ? 0.0F : -std::numeric_limits<float>::infinity());
  for_channels(shape.out_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    const auto bias = access.load(job.bias + channel);
    kn::transform_square<kWinogradPoints, kTileSize>(
        E2LF_TRANSFORM(transform_output),
        [&](size_t j, size_t i) HWY_ATTR { return hn::LoadU(d, sums + channel + (i * kWinogradPoints + j) * step); },
        [&](size_t j, size_t i, FloatVec value) HWY_ATTR {
          if (outputs.at[i][j] == nullptr) return;
          const auto sum = hn::Add(hn::Add(value, bias), load_pixel(residuals.at[i][j], channel, access));
          access.store(hn::Max(sum, floor), outputs.at[i][j] + channel);
        });
  });
}

/// Transforms the gradient of a tile's outputs to its points, and adds it to the gradient of the bias.
void spread_tile(const ConvShape& shape, const ConvBackward& job, const Tile& tile, float* to, size_t step) {
  const Pixels<kTileSize, const float> gradients(shape, job.dy, shape.out_channels, tile, 0);
  const Pixels<kTileSize, const float> outputs(shape, job.y, shape.out_channels, tile, 0);
  const FloatTag d;
  for_channels(shape.out_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    auto sum = access.load(job.dbias + channel);
    kn::transform_square<kTileSize, kWinogradPoints>(
        E2LF_TRANSFORM(spread_output),
        [&](size_t i, size_t j) HWY_ATTR {
          auto gradient = load_pixel(gradients.at[i][j], channel, access);
          if (outputs.at[i][j] != nullptr) {
            const auto output = access.load(outputs.at[i][j] + channel);
            gradient = hn::IfThenElseZero(hn::Gt(output, hn::Zero(d)), gradient);
          }
          sum = hn::Add(sum, gradient);
          return gradient;
        },
        [&](size_t i, size_t j, FloatVec value)
            HWY_ATTR { hn::StoreU(value, d, to + channel + (i * kWinogradPoints + j) * step); });
    access.store(sum, job.dbias + channel);
  });
}

/// Adds the contribution of a tile's points to the gradient of the 6x6 pixels on which it depends.
void collect_tile(const ConvShape& shape, float* dx, const Tile& tile, const float* points, size_t step) {
  const Pixels<kWinogradPoints, float> pixels(shape, dx, shape.in_channels, tile, 1);
  const FloatTag d;
  for_channels(shape.in_channels, [&](size_t channel, const auto& access) HWY_ATTR {
    kn::transform_square<kWinogradPoints, kWinogradPoints>(
        E2LF_TRANSFORM(spread_input),
        [&](size_t j, size_t i) HWY_ATTR { return hn::LoadU(d, points + channel + (i * kWinogradPoints + j) * step); },
        [&](size_t j, size_t i, FloatVec value) HWY_ATTR {
          if (pixels.at[i][j] == nullptr) return;
          float* to = pixels.at[i][j] + channel;
          access.store(hn::Add(access.load(to), value), to);
        });
  });
}

void TapsToMatrices(const float* taps, size_t rows, size_t columns, float* matrices) {
  const size_t width = padded_channels(columns), step = rows * width;
  for (size_t row = 0; row < rows; ++row) {
    for_channels(columns, [&](size_t column, const auto& access) HWY_ATTR {
      kn::transform_square<kTaps, kWinogradPoints>(
          E2LF_TRANSFORM(transform_taps),
          [&](size_t i, size_t j)
              HWY_ATTR { return access.load(taps + ((i * kTaps + j) * rows + row) * columns + column); },
          [&](size_t i, size_t j, FloatVec value) HWY_ATTR {
            hn::StoreU(value, FloatTag(), matrices + row * width + column + (i * kWinogradPoints + j) * step);
          });
    });
  }
}

void MatricesToTaps(const float* matrices, size_t rows, size_t columns, float* taps) {
  const size_t width = padded_channels(columns), step = rows * width;
  for (size_t row = 0; row < rows; ++row) {
    for_channels(columns, [&](size_t column, const auto& access) HWY_ATTR {
      kn::transform_square<kWinogradPoints, kTaps>(
          E2LF_TRANSFORM(collect_taps),
          [&](size_t j, size_t i) HWY_ATTR {
            return hn::LoadU(FloatTag(), matrices + row * width + column + (i * kWinogradPoints + j) * step);
          },
          [&](size_t j, size_t i, FloatVec value)
              HWY_ATTR { access.store(value, taps + ((i * kTaps + j) * rows + row) * columns + column); });
    });
  }
}

#undef E2LF_TRANSFORM

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
