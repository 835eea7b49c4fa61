// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>

#include "e2lf/base/contract.h"
#include "e2lf/engine/conv.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/winograd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/epilogue-inl.h"
#include "e2lf/engine/winograd.h"
#include "e2lf/kernels/winograd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

namespace {

// Up to this many channels are copied at once.
constexpr size_t kFewChannels = 4;

constexpr size_t kBlockGroups = kWinogradBlockTiles / kGemmRows;
static_assert(kWinogradBlockTiles % kGemmRows == 0);

template <class Products>
class WinogradKernel final : public Kernel {
  using Element = typename Products::Element;

 public:
  explicit WinogradKernel(const ConvSpec& spec)
      : kernel_(spec.kernel),
        parts_(winograd_parts(spec).parts),
        group_(winograd_parts(spec).group),
        depth_(winograd_parts(spec).depth()),
        in_channels_(spec.in_channels),
        in_stride_(padded_channels(spec.in_channels)),
        weights_(pack_winograd_weights(spec, kPanelColumns)),
        epilogue_(spec) {}

  std::string describe() const override {
    return "Winograd F(4x4,3x3) for " + std::to_string(kernel_) + "x" + std::to_string(kernel_) + " " +
           hwy::TargetName(HWY_TARGET) + (Products::kStep == 2 ? " bfloat16" : " float32");
  }

  Reach reach() const override { return {kernel_ / 2, parts_ * 3 - 1 - kernel_ / 2, 1, 1}; }

  size_t scratch_bytes() const override { return transformed_bytes() + sums_bytes() + patch_bytes(); }

  size_t num_blocks(const Strip& strip) const override { return (num_groups(strip) + kBlockGroups - 1) / kBlockGroups; }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    // Blocks consist of whole groups and have nearly equal sizes, so that the last one is not a small remainder.
    const size_t groups = num_groups(strip), blocks = num_blocks(strip);
    const size_t first = groups * block / blocks * kGemmRows;
    const size_t count = std::min(num_tiles(strip), groups * (block + 1) / blocks * kGemmRows) - first;
    auto* transformed = reinterpret_cast<Element*>(scratch);
    auto* sums = reinterpret_cast<float*>(scratch + transformed_bytes());
    auto* patch = reinterpret_cast<Element*>(scratch + transformed_bytes() + sums_bytes());
    // This clears the elements after the channels that gather_shifts() writes. Zero weights would not suppress a NaN
    // left there by an earlier stage.
    if (parts_ > 1) std::memset(patch, 0, patch_bytes());
    for (size_t tile = 0; tile < count; ++tile) {
      transform_tile(strip, first + tile, patch, transformed + tile * kWinogradMatrices * depth_);
    }
    for (size_t point = 0; point < kWinogradMatrices; ++point) {
      const Multiply multiply{*this, transformed + point * depth_, sums + point * weights_.columns(), point, count};
      for_column_groups(weights_.columns(), multiply);
    }
    epilogue_.select(Finish{*this, strip, first, count, sums});
  }

 private:
  /// Computes the sums of one of the 36 points for the tiles of a block, which is a small matrix product.
  struct Multiply {
    const WinogradKernel& kernel;
    const Element* transformed;
    float* sums;
    size_t point;
    size_t tiles;

    template <size_t kVectors>
    HWY_INLINE void visit(size_t column, size_t offset, size_t width) const {
      const Element* panel = kernel.weights_.template panel<Element>(point, column) + offset * Products::kStep;
      const size_t in_step = kWinogradMatrices * kernel.depth_;
      const size_t out_step = kWinogradMatrices * kernel.weights_.columns();
      for (size_t tile = 0; tile < tiles; tile += kGemmRows) {
        FloatVec acc[kGemmRows][kVectors];
        clear(acc);
        multiply_accumulate<Products>(transformed + tile * in_step, in_step, panel, width, kernel.weights_.depth(),
                                      acc);
        E2LF_UNROLL
        for (size_t i = 0; i < kGemmRows; ++i) {
          float* to = sums + (tile + i) * out_step + column + offset;
          E2LF_UNROLL
          for (size_t j = 0; j < kVectors; ++j) hn::Store(acc[i][j], FloatTag(), to + j * kLanes);
        }
      }
    }
  };

  /// Computes the outputs of the tiles of a block.
  struct Finish {
    const WinogradKernel& kernel;
    const Strip& strip;
    size_t first, count;
    const float* sums;

    template <bool kResidual, class Output>
    HWY_INLINE void visit() const {
      const size_t step = kWinogradMatrices * kernel.weights_.columns();
      for (size_t tile = 0; tile < count; ++tile) {
        kernel.template finish_tile<kResidual, Output>(strip, first + tile, sums + tile * step);
      }
    }
  };

  static size_t tiles_per_row(const Strip& strip) { return (strip.width + kTileSize - 1) / kTileSize; }
  static size_t num_tiles(const Strip& strip) {
    return tiles_per_row(strip) * ((strip.end - strip.begin + kTileSize - 1) / kTileSize);
  }
  /// Returns the number of groups of tiles whose sums are computed together.
  static size_t num_groups(const Strip& strip) { return (num_tiles(strip) + kGemmRows - 1) / kGemmRows; }
  size_t transformed_bytes() const { return kWinogradMatrices * kWinogradBlockTiles * depth_ * sizeof(Element); }
  size_t sums_bytes() const { return kWinogradMatrices * kWinogradBlockTiles * weights_.columns() * sizeof(float); }

  size_t patch_bytes() const { return (patch_rows() * kWinogradPoints * group_ + kFewChannels) * sizeof(Element); }

  /// Transforms the 6x6 input pixels of a tile. Point p is stored at `to` + p * depth_.
  void transform_tile(const Strip& strip, size_t tile, Element* HWY_RESTRICT patch, Element* HWY_RESTRICT to) const {
    const auto y = static_cast<ptrdiff_t>(strip.begin + tile / tiles_per_row(strip) * kTileSize);
    const auto x = static_cast<ptrdiff_t>(tile % tiles_per_row(strip) * kTileSize);
    if (parts_ > 1) gather_shifts(strip, y, x, patch);
    for (size_t part = 0; part < parts_; ++part) {
      const Element* rows[kWinogradPoints];
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        rows[i] = parts_ > 1 ? patch + (i + 3 * part) * kWinogradPoints * group_
                             : strip.inputs[0].template row<const Element>(y - 1 + static_cast<ptrdiff_t>(i)) +
                                   (x - 1) * static_cast<ptrdiff_t>(in_stride_);
      }
      transform_group(rows, to + part * group_);
    }
  }

  /// Transforms 6x6 pixels of group_ channels.
  HWY_INLINE void transform_group(const Element* const (&rows)[kWinogradPoints], Element* HWY_RESTRICT to) const {
    const size_t group = group_;
    const size_t depth = depth_;
    for (size_t channel = 0; channel < group; channel += kLanes) {
      FloatVec half[kWinogradPoints][kWinogradPoints];
      E2LF_UNROLL
      for (size_t j = 0; j < kWinogradPoints; ++j) {
        FloatVec column[kWinogradPoints], v[kWinogradPoints];
        E2LF_UNROLL
        for (size_t i = 0; i < kWinogradPoints; ++i) column[i] = load_floats(rows[i] + j * group + channel);
        transform_input(column, v);
        E2LF_UNROLL
        for (size_t i = 0; i < kWinogradPoints; ++i) half[i][j] = v[i];
      }
      Element* out = to + channel;
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        FloatVec v[kWinogradPoints];
        transform_input(half[i], v);
        E2LF_UNROLL
        for (size_t j = 0; j < kWinogradPoints; ++j, out += depth) store_floats(v[j], out);
      }
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

  /// Computes the outputs of a tile that lie inside the strip. The sums of point p are at `sums` + p * columns.
  template <bool kResidual, class Output>
  void finish_tile(const Strip& strip, size_t tile, const float* HWY_RESTRICT sums) const {
    const size_t y = strip.begin + tile / tiles_per_row(strip) * kTileSize;
    const size_t x = tile % tiles_per_row(strip) * kTileSize;
    const size_t height = std::min(kTileSize, strip.end - y);
    const size_t width = std::min(kTileSize, strip.width - x);
    const size_t columns = weights_.columns();
    typename Epilogue<Products>::Row rows[kTileSize];
    for (size_t i = 0; i < height; ++i) rows[i] = epilogue_.row(strip, y + i);
    for (size_t channel = 0; channel < columns; channel += kLanes) {
      FloatVec half[kTileSize][kWinogradPoints];
      const auto channels = epilogue_.channels(channel);
      const float* in = sums + channel;
      E2LF_UNROLL
      for (size_t i = 0; i < kWinogradPoints; ++i) {
        FloatVec row[kWinogradPoints], v[kTileSize];
        E2LF_UNROLL
        for (size_t j = 0; j < kWinogradPoints; ++j, in += columns) row[j] = hn::Load(FloatTag(), in);
        transform_output(row, v);
        E2LF_UNROLL
        for (size_t j = 0; j < kTileSize; ++j) half[j][i] = v[j];
      }
      E2LF_UNROLL
      for (size_t j = 0; j < kTileSize; ++j) {
        if (j >= width) break;
        FloatVec v[kTileSize];
        transform_output(half[j], v);
        E2LF_UNROLL
        for (size_t i = 0; i < kTileSize; ++i) {
          if (i < height)
            Epilogue<Products>::template store<kResidual, Output>(v[i], channels, (x + j) * columns + channel, rows[i]);
        }
      }
    }
  }

  size_t kernel_;
  size_t parts_, group_, depth_;  ///< see WinogradParts
  size_t in_channels_;
  size_t in_stride_;
  PackedMatrices weights_;
  Epilogue<Products> epilogue_;
};

}  // namespace

std::unique_ptr<Kernel> MakeWinograd(const ConvSpec& spec) {
#if E2LF_TARGET_HAS_BF16
  if (spec.compute == ElementType::kBfloat16) return std::make_unique<WinogradKernel<Bfloat16Products>>(spec);
#endif
  E2LF_REQUIRE(spec.compute == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return std::make_unique<WinogradKernel<FloatProducts>>(spec);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {

HWY_EXPORT(MakeWinograd);

std::unique_ptr<Kernel> make_winograd(const ConvSpec& spec) {
  return HWY_DYNAMIC_DISPATCH(MakeWinograd)(spec);
}

}  // namespace e2lf::engine
#endif
