// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/base/isa.h"
#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/amx.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/amx-inl.h"
#include "e2lf/engine/conv_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

#if E2LF_TARGET_HAS_BF16
namespace {

// The number of pixels whose sums for one tile of columns are held in tiles at a time.
constexpr size_t kSumTiles = 4, kPixels = kSumTiles * kTileRows;
// The number of pixels of a row that one block computes.
constexpr size_t kBlockPixels = 2 * kPixels;

/// Configures the tiles: 0 to 3 hold sums, 4 and 5 alternately hold pixels, 6 holds weights, and 7 holds the last
/// pixels, which may be fewer than a tile has rows. All tiles are zero afterwards.
void shape_tiles(size_t pixels) {
  TileShapes shapes;
  std::fill_n(shapes.row_bytes, 8, static_cast<uint16_t>(kTileRowBytes));
  std::fill_n(shapes.rows, 8, static_cast<uint8_t>(kTileRows));
  const size_t last = (pixels - 1) / kTileRows;
  shapes.rows[last] = shapes.rows[7] = static_cast<uint8_t>(pixels - last * kTileRows);
  load_tile_shapes(shapes);
}

/// Computes a convolution as sums over rows of taps, on tiles. Neighbouring pixels are contiguous, so that a row of
/// taps is a product of depth kernel * channels. Depths are rounded up to whole tiles: the weights there are zero, and
/// the pixel after the last tap, which is read, is part of the image or of the zeros beside it.
class AmxKernel final : public Kernel {
 public:
  explicit AmxKernel(const ConvSpec& spec) : grid_(spec), weights_(pack(spec)), epilogue_(spec) {}

  std::string describe() const override {
    return "direct " + std::to_string(grid_.kernel) + "x" + std::to_string(grid_.kernel) + " AMX bfloat16";
  }

  Reach reach() const override { return grid_.reach(); }

  size_t scratch_bytes() const override { return kPixels * kTileRows * sizeof(float); }

  size_t num_blocks(const Strip& strip) const override {
    return (strip.end - strip.begin) * grid_.blocks_per_row(strip, kBlockPixels);
  }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const size_t begin = block % grid_.blocks_per_row(strip, kBlockPixels) * kBlockPixels;
    const size_t end = std::min(begin + kBlockPixels, grid_.sums_per_row(strip));
    Step step{strip,
              strip.begin + block / grid_.blocks_per_row(strip, kBlockPixels),
              begin,
              0,
              0,
              0,
              reinterpret_cast<float*>(scratch)};
    size_t shaped = 0;
    for (; step.x < end; step.x += kPixels) {
      step.pixels = std::min(kPixels, end - step.x);
      if (step.pixels != shaped) shape_tiles(step.pixels);
      shaped = step.pixels;
      for (step.phase = 0; step.phase < grid_.phases(); ++step.phase) {
        for (step.column = 0; step.column < weights_.columns(); step.column += kTileRows) compute(step);
      }
    }
    release_tiles();
  }

 private:
  /// Neighbouring pixels and columns whose sums are computed together. `x` counts the inputs of a transposed
  /// convolution, and outputs otherwise.
  struct Step {
    const Strip& strip;
    size_t y, x, pixels, phase, column;
    float* sums;  ///< [kPixels, kTileRows]
  };

  static PackedMatrices pack(const ConvSpec& spec) {
    const size_t in_stride = padded_channels(spec.in_channels), taps = spec.transposed ? 1 : spec.kernel;
    const size_t matrices = spec.kernel * (spec.transposed ? spec.kernel : 1);
    return {ElementType::kBfloat16, matrices, round_up(taps * in_stride, kTileDepth), spec.out_channels,
            [&](size_t matrix, size_t row, size_t out) {
              const size_t in = row % in_stride, dx = spec.transposed ? matrix % spec.kernel : row / in_stride;
              const size_t dy = spec.transposed ? matrix / spec.kernel : matrix;
              const bool outside = in >= spec.in_channels || row >= taps * in_stride;
              return outside ? 0.0F : spec.tap(out, in, dy, dx);
            }};
  }

  void compute(const Step& step) const {
    switch ((step.pixels + kTileRows - 1) / kTileRows) {
      case 1:
        multiply<1>(step);
        break;
      case 2:
        multiply<2>(step);
        break;
      case 3:
        multiply<3>(step);
        break;
      default:
        multiply<4>(step);
    }
    epilogue_.select(Finish{*this, step});
  }

  /// Computes the sums of kTiles tiles of pixels, the last of which may be smaller, into step.sums.
  template <size_t kTiles>
  void multiply(const Step& step) const {
    const size_t panel_begin = step.column / kPanelWidth * kPanelWidth;
    const size_t width = std::min(kPanelWidth, weights_.columns() - panel_begin);
    const size_t pixel_step = grid_.pixel_step(), tile_step = kTileRows * pixel_step;
    const size_t pixel_bytes = pixel_step * sizeof(Bfloat16), weight_bytes = 2 * width * sizeof(Bfloat16);
    E2LF_TILE_ZERO(0);
    if constexpr (kTiles > 1) E2LF_TILE_ZERO(1);
    if constexpr (kTiles > 2) E2LF_TILE_ZERO(2);
    if constexpr (kTiles > 3) E2LF_TILE_ZERO(3);
    for (size_t tap_row = 0; tap_row < (grid_.transposed ? 1 : grid_.kernel); ++tap_row) {
      const Bfloat16* pixels = grid_.input<Bfloat16>(step.strip, step.y, step.x, tap_row);
      const size_t matrix = grid_.transposed ? step.y % grid_.stride * grid_.kernel + step.phase : tap_row;
      const Bfloat16* weights = weights_.panel<Bfloat16>(matrix, panel_begin) + 2 * (step.column - panel_begin);
      for (size_t k = 0; k < weights_.depth(); k += kTileDepth, pixels += kTileDepth, weights += kTileDepth * width) {
        E2LF_TILE_LOAD(6, weights, weight_bytes);
        if constexpr (kTiles > 1) {
          E2LF_TILE_LOAD(4, pixels, pixel_bytes);
          E2LF_TILE_MULTIPLY(0, 4, 6);
        }
        if constexpr (kTiles > 2) {
          E2LF_TILE_LOAD(5, pixels + tile_step, pixel_bytes);
          E2LF_TILE_MULTIPLY(1, 5, 6);
        }
        if constexpr (kTiles > 3) {
          E2LF_TILE_LOAD(4, pixels + 2 * tile_step, pixel_bytes);
          E2LF_TILE_MULTIPLY(2, 4, 6);
        }
        E2LF_TILE_LOAD(7, pixels + (kTiles - 1) * tile_step, pixel_bytes);
        if constexpr (kTiles == 1) E2LF_TILE_MULTIPLY(0, 7, 6);
        if constexpr (kTiles == 2) E2LF_TILE_MULTIPLY(1, 7, 6);
        if constexpr (kTiles == 3) E2LF_TILE_MULTIPLY(2, 7, 6);
        if constexpr (kTiles == 4) E2LF_TILE_MULTIPLY(3, 7, 6);
      }
    }
    constexpr size_t kTileSums = kTileRows * kTileRows, kSumBytes = kTileRows * sizeof(float);
    E2LF_TILE_STORE(0, step.sums, kSumBytes);
    if constexpr (kTiles > 1) E2LF_TILE_STORE(1, step.sums + kTileSums, kSumBytes);
    if constexpr (kTiles > 2) E2LF_TILE_STORE(2, step.sums + 2 * kTileSums, kSumBytes);
    if constexpr (kTiles > 3) E2LF_TILE_STORE(3, step.sums + 3 * kTileSums, kSumBytes);
  }

  struct Finish {
    const AmxKernel& kernel;
    const Step& at;

    template <bool kResidual, class Output>
    HWY_INLINE void visit() const {
      const auto row = kernel.epilogue_.row(at.strip, at.y);
      const size_t columns = kernel.weights_.columns();
      const size_t step = kernel.grid_.phases() * columns;
      const size_t first = at.x * step + at.phase * columns + at.column;
      const auto channels = kernel.epilogue_.channels(at.column);
      for (size_t i = 0; i < at.pixels; ++i) {
        const auto sum = hn::Load(FloatTag(), at.sums + i * kTileRows);
        Epilogue<Bfloat16Products>::template store<kResidual, Output>(sum, channels, first + i * step, row);
      }
    }
  };

  TapGrid grid_;
  PackedMatrices weights_;  ///< one matrix per row of taps, or per tap if transposed
  Epilogue<Bfloat16Products> epilogue_;
};

}  // namespace

std::unique_ptr<Kernel> MakeAmx(const ConvSpec& spec) {
  return std::make_unique<AmxKernel>(spec);
}
#else

std::unique_ptr<Kernel> MakeAmx(const ConvSpec& /*spec*/) {
  E2LF_REQUIRE(false, "AMX needs bfloat16_supported()");
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {

HWY_EXPORT(MakeAmx);

std::string amx_refusal(const ConvSpec& spec) {
  constexpr size_t kMinChannels = 8;
  if (spec.compute != ElementType::kBfloat16) return "AMX only multiplies bfloat16";
  if (current_isa() != "amx") return "the CPU has no AMX, or E2LF_MAX_ISA leaves it out";
  return spec.in_channels < kMinChannels ? "too few input channels: most of the products would be with padding" : "";
}

std::unique_ptr<Kernel> make_amx(const ConvSpec& spec) {
  return HWY_DYNAMIC_DISPATCH(MakeAmx)(spec);
}

}  // namespace e2lf::engine
#endif
