// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "e2lf/base/result.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/winograd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/conv_kernel-inl.h"
#include "e2lf/engine/winograd.h"
#include "e2lf/kernels/winograd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

namespace {

// Up to this many channels are copied at once.
constexpr size_t kFewChannels = 4;

/// Packs the weights for a kind of products.
template <class Products>
auto pack_weights(const ConvSpec& spec) {
  if constexpr (Factors<Products>::kAreIntegers) {
    return pack_winograd_int16(spec, kPanelColumns);
  } else {
    return pack_winograd_weights(spec, kPanelColumns);
  }
}

template <class Products>
class WinogradKernel final : public Kernel {
  using Element = typename Products::Element;
  using Factor = typename Products::Factor;
  using Sum = typename Products::Sum;
  using SumElement = hn::TFromV<Sum>;
  static constexpr bool kIsScaled = Factors<Products>::kAreIntegers;
  static constexpr size_t kBlockTiles = kIsScaled ? kWinogradInt16Tiles : kWinogradBlockTiles;
  static constexpr size_t kBlockGroups = kBlockTiles / kGemmRows;
  static_assert(kBlockTiles % kGemmRows == 0);

 public:
  explicit WinogradKernel(const ConvSpec& spec)
      : kernel_(spec.kernel),
        parts_(winograd_parts(spec).parts),
        group_(winograd_parts(spec).group),
        depth_(winograd_parts(spec).depth()),
        in_channels_(spec.in_channels),
        in_stride_(padded_channels(spec.in_channels)),
        factors_(pack_weights<Products>(spec), spec.out_channels),
        epilogue_(spec) {}

  std::string describe() const override {
    return "Winograd F(4x4,3x3) for " + std::to_string(kernel_) + "x" + std::to_string(kernel_) + " " +
           describe_products<Products>();
  }

  Reach reach() const override { return {kernel_ / 2, parts_ * 3 - 1 - kernel_ / 2, 1, 1}; }

  size_t scratch_bytes() const override { return transformed_bytes() + sums_bytes() + patch_bytes(); }

  size_t num_blocks(const Strip& strip) const override { return (num_groups(strip) + kBlockGroups - 1) / kBlockGroups; }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    // Blocks consist of whole groups and have nearly equal sizes, so that the last one is not a small remainder.
    const size_t groups = num_groups(strip), blocks = num_blocks(strip);
    const size_t first = groups * block / blocks * kGemmRows;
    const size_t count = std::min(num_tiles(strip), groups * (block + 1) / blocks * kGemmRows) - first;
    auto* transformed = reinterpret_cast<Factor*>(scratch);
    auto* sums = reinterpret_cast<SumElement*>(scratch + transformed_bytes());
    float units[kBlockTiles];  // the value of one in the integers of each tile
    auto* patch = reinterpret_cast<Element*>(scratch + transformed_bytes() + sums_bytes());
    // This clears the elements after the channels that gather_shifts() writes. Zero weights would not suppress a NaN
    // left there by an earlier stage.
    if (parts_ > 1) std::memset(patch, 0, patch_bytes());
    for (size_t tile = 0; tile < count; ++tile) {
      units[tile] = transform_tile(strip, first + tile, patch, transformed + tile * kWinogradMatrices * depth_);
    }
    for (size_t point = 0; point < kWinogradMatrices; ++point) {
      const Multiply multiply{*this, transformed + point * depth_, sums + point * columns(), point, count};
      for_column_groups(columns(), multiply);
    }
    epilogue_.select(Finish{*this, strip, first, count, sums, units});
  }

 private:
  /// Computes the sums of one of the 36 points for the tiles of a block, which is a small matrix product.
  struct Multiply {
    const WinogradKernel& kernel;
    const Factor* transformed;
    SumElement* sums;
    size_t point;
    size_t tiles;

    template <size_t kVectors>
    HWY_INLINE void visit(size_t column, size_t offset, size_t width) const {
      const PackedMatrices& weights = kernel.factors_.weights;
      const Factor* panel = weights.template panel<Factor>(point, column) + offset * Products::kStep;
      const size_t in_step = kWinogradMatrices * kernel.depth_;
      const size_t out_step = kWinogradMatrices * weights.columns();
      for (size_t tile = 0; tile < tiles; tile += kGemmRows) {
        Sum acc[kGemmRows][kVectors];
        clear(acc);
        multiply_accumulate<Products>(transformed + tile * in_step, in_step, panel, width, weights.depth(), acc);
        E2LF_UNROLL
        for (size_t i = 0; i < kGemmRows; ++i) {
          SumElement* to = sums + (tile + i) * out_step + column + offset;
          E2LF_UNROLL
          for (size_t j = 0; j < kVectors; ++j) hn::Store(acc[i][j], hn::DFromV<Sum>(), to + j * kLanes);
        }
      }
    }
  };

  /// Computes the outputs of the tiles of a block.
  struct Finish {
    const WinogradKernel& kernel;
    const Strip& strip;
    size_t first, count;
    const SumElement* sums;
    const float* units;

    template <bool kResidual, class Output>
    HWY_INLINE void visit() const {
      const size_t step = kWinogradMatrices * kernel.columns();
      for (size_t tile = 0; tile < count; ++tile) {
        kernel.template finish_tile<kResidual, Output>(strip, first + tile, sums + tile * step, units[tile]);
      }
    }
  };

  size_t columns() const { return factors_.weights.columns(); }

  static size_t tiles_per_row(const Strip& strip) { return (strip.width + kTileSize - 1) / kTileSize; }
  static size_t num_tiles(const Strip& strip) {
    return tiles_per_row(strip) * ((strip.end - strip.begin + kTileSize - 1) / kTileSize);
  }
  /// Returns the number of groups of tiles whose sums are computed together.
  static size_t num_groups(const Strip& strip) { return (num_tiles(strip) + kGemmRows - 1) / kGemmRows; }
  size_t transformed_bytes() const { return kWinogradMatrices * kBlockTiles * depth_ * sizeof(Factor); }
  size_t sums_bytes() const { return kWinogradMatrices * kBlockTiles * columns() * sizeof(SumElement); }

  size_t patch_bytes() const { return (patch_rows() * kWinogradPoints * group_ + kFewChannels) * sizeof(Element); }

  /// Transforms the 6x6 input pixels of a tile. Point p is stored at `to` + p * depth_. If they become integers,
  /// returns the value of one.
  float transform_tile(const Strip& strip, size_t tile, Element* HWY_RESTRICT patch, Factor* HWY_RESTRICT to) const {
    const auto y = static_cast<ptrdiff_t>(strip.begin + tile / tiles_per_row(strip) * kTileSize);
    const auto x = static_cast<ptrdiff_t>(tile % tiles_per_row(strip) * kTileSize);
    if (parts_ > 1) gather_shifts(strip, y, x, patch);
    const auto row = [&](size_t i) {
      return parts_ > 1 ? patch + i * kWinogradPoints * group_
                        : strip.inputs[0].template row<const Element>(y - 1 + static_cast<ptrdiff_t>(i)) +
                              (x - 1) * static_cast<ptrdiff_t>(in_stride_);
    };
    float largest = kIsScaled ? 0.0F : 1.0F;
    if constexpr (kIsScaled) {
      for (size_t i = 0; i < patch_rows(); ++i) {
        largest = std::max(largest, Factors<Products>::largest_of(row(i), kWinogradPoints * group_));
      }
    }
    for (size_t part = 0; part < parts_; ++part) {
      const Element* rows[kWinogradPoints];
      for (size_t i = 0; i < kWinogradPoints; ++i) rows[i] = row(i + 3 * part);
      transform_group(rows, hn::Set(FloatTag(), INT16_MAX / (kMostWinogradGrowth * largest)), to + part * group_);
    }
    return largest * (kMostWinogradGrowth / INT16_MAX);
  }

  /// Transforms 6x6 pixels of group_ channels.
  HWY_INLINE void transform_group(const Element* const (&rows)[kWinogradPoints], FloatVec scale,
                                  Factor* HWY_RESTRICT to) const {
    const size_t group = group_;
    const size_t depth = depth_;
    for (size_t channel = 0; channel < group; channel += kLanes) {
      transform_square<kWinogradPoints, kWinogradPoints>(
          [](const auto& from, auto& v) HWY_ATTR { transform_input(from, v); },
          [&](size_t i, size_t j) HWY_ATTR { return load_floats(rows[i] + j * group + channel); },
          [&](size_t i, size_t j, FloatVec value)
              HWY_ATTR { Factors<Products>::store(value, scale, to + channel + (i * kWinogradPoints + j) * depth); });
    }
  }

  /// Returns the number of input rows that all parts of a kernel see for a tile.
  size_t patch_rows() const { return kWinogradPoints + 3 * (parts_ - 1); }

  /// Copies the pixels that the 3x3 parts of a larger kernel see for a tile: pixel j of a row of the patch holds the
  /// channels of the input pixels at offsets 0, 3, 6, ...
  void gather_shifts(const Strip& strip, ptrdiff_t y, ptrdiff_t x, Element* HWY_RESTRICT patch) const {
    const auto radius = static_cast<ptrdiff_t>(kernel_ / 2);
    const size_t parts = parts_;
    const size_t in_stride = in_stride_;
    const size_t rows = patch_rows();
    for (size_t i = 0; i < rows; ++i) {
      const Element* row = strip.inputs[0].template row<const Element>(y - radius + static_cast<ptrdiff_t>(i)) +
                           (x - radius) * static_cast<ptrdiff_t>(in_stride);
      for (size_t j = 0; j < kWinogradPoints; ++j) {
        Element* to = patch + (i * kWinogradPoints + j) * group_;
        for (size_t part = 0; part < parts; ++part) {
          copy_channels(row + (j + 3 * part) * in_stride, to + part * in_channels_);
        }
      }
    }
  }

  /// If there are few channels, the elements after them are copied as well; they are padding or are overwritten by the
  /// next copy.
  HWY_INLINE void copy_channels(const Element* HWY_RESTRICT from, Element* HWY_RESTRICT to) const {
    if (in_channels_ <= kFewChannels) {
      std::memcpy(to, from, kFewChannels * sizeof(Element));
    } else {
      std::copy_n(from, in_channels_, to);
    }
  }

  static HWY_INLINE FloatVec last_point(FloatVec value) {
    return kIsScaled ? hn::Mul(value, hn::Set(FloatTag(), kInt16LastPoint)) : value;
  }

  /// Computes the outputs of a tile that lie inside the strip. The sums of point p are at `sums` + p * columns.
  template <bool kResidual, class Output>
  void finish_tile(const Strip& strip, size_t tile, const SumElement* HWY_RESTRICT sums, float tile_unit) const {
    const size_t y = strip.begin + tile / tiles_per_row(strip) * kTileSize;
    const size_t x = tile % tiles_per_row(strip) * kTileSize;
    const size_t height = std::min(kTileSize, strip.end - y);
    const size_t width = std::min(kTileSize, strip.width - x);
    const size_t columns = this->columns();
    typename Epilogue<Products>::Row rows[kTileSize];
    for (size_t i = 0; i < height; ++i) rows[i] = epilogue_.row(strip, y + i);
    for (size_t channel = 0; channel < columns; channel += kLanes) {
      FloatVec half[kTileSize][kWinogradPoints];
      const auto channels = epilogue_.channels(channel);
      const auto unit = factors_.unit(channel, tile_unit);
      const SumElement* in = sums + channel;
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        FloatVec row[kWinogradPoints], v[kTileSize];
        E2LF_UNROLL
        for (size_t j = 0; j < kWinogradPoints; ++j, in += columns) {
          row[j] = Factors<Products>::value(hn::Load(hn::DFromV<Sum>(), in));
        }
        row[kWinogradPoints - 1] = last_point(row[kWinogradPoints - 1]);
        transform_output(row, v);
        E2LF_UNROLL
        for (size_t j = 0; j < kTileSize; ++j) half[j][i] = v[j];
      }
      E2LF_UNROLL
      for (size_t j = 0; j < kTileSize; ++j) {
        if (j >= width) break;
        FloatVec v[kTileSize];
        half[j][kWinogradPoints - 1] = last_point(half[j][kWinogradPoints - 1]);
        transform_output(half[j], v);
        E2LF_UNROLL
        for (size_t i = 0; i < kTileSize; ++i) {
          if (i < height)
            Epilogue<Products>::template store<kResidual, Output>(Factors<Products>::scaled(v[i], unit), channels,
                                                                  (x + j) * columns + channel, rows[i]);
        }
      }
    }
  }

  size_t kernel_;
  size_t parts_, group_, depth_;  ///< see WinogradParts
  size_t in_channels_;
  size_t in_stride_;
  Factors<Products> factors_;
  Epilogue<Products> epilogue_;
};

}  // namespace

std::unique_ptr<Kernel> MakeWinograd(const ConvSpec& spec, bool integers) {
  return make_conv_kernel<WinogradKernel>(spec, integers);
}

bool KnowsInt16() {
#if E2LF_TARGET_HAS_INT16
  return HWY_TARGET == HWY_AVX2 || __builtin_cpu_supports("avx512vnni") != 0;
#else
  return false;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {

HWY_EXPORT(MakeWinograd);
HWY_EXPORT(KnowsInt16);

std::unique_ptr<Kernel> make_winograd(const ConvSpec& spec, bool integers) {
  return HWY_DYNAMIC_DISPATCH(MakeWinograd)(spec, integers);
}

bool int16_supported() {
  return HWY_DYNAMIC_DISPATCH(KnowsInt16)();
}

}  // namespace e2lf::engine
#endif
