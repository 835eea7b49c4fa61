// SPDX-License-Identifier: MIT
#include "e2lf/base/contract.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/pack.h"
#include "e2lf/engine/tap_grid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/direct.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/epilogue-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

namespace {

// The number of pixels of a row that one block computes.
constexpr size_t kBlockPixels = 96;

/// Computes a convolution as sums over taps. Matrix t holds tap t = dy * kernel + dx.
template <class Products>
class DirectKernel final : public Kernel {
  using Element = typename Products::Element;

 public:
  explicit DirectKernel(const ConvSpec& spec)
      : grid_(spec),
        weights_(
            Products::kType, spec.kernel * spec.kernel, spec.in_channels, spec.out_channels,
            [&](size_t tap, size_t in, size_t out) { return spec.tap(out, in, tap / spec.kernel, tap % spec.kernel); },
            kPanelColumns),
        epilogue_(spec) {}

  std::string describe() const override {
    return "direct " + std::to_string(grid_.kernel) + "x" + std::to_string(grid_.kernel) + " " +
           hwy::TargetName(HWY_TARGET) + (Products::kStep == 2 ? " bfloat16" : " float32");
  }

  Reach reach() const override { return grid_.reach(); }

  size_t num_blocks(const Strip& strip) const override { return (strip.end - strip.begin) * blocks_per_row(strip); }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const size_t y = strip.begin + block / blocks_per_row(strip);
    const size_t begin = block % blocks_per_row(strip) * kBlockPixels;
    const size_t end = HWY_MIN(begin + kBlockPixels, grid_.sums_per_row(strip));
    for (size_t x = begin; x < end; x += kGemmRows) {
      const size_t pixels = HWY_MIN(kGemmRows, end - x);
      for (size_t phase = 0; phase < grid_.phases(); ++phase) {
        for_column_groups(weights_.columns(), Pixels{*this, strip, y, x, pixels, phase});
      }
    }
  }

 private:
  /// Neighbouring pixels whose sums are computed together. `x` counts the inputs of a transposed convolution, and
  /// outputs otherwise.
  struct Pixels {
    const DirectKernel& kernel;
    const Strip& strip;
    size_t y, x, count, phase;

    template <size_t kVectors>
    HWY_INLINE void visit(size_t column, size_t offset, size_t width) const {
      kernel.compute<kVectors>(*this, column, offset, width);
    }
  };

  size_t blocks_per_row(const Strip& strip) const {
    return (grid_.sums_per_row(strip) + kBlockPixels - 1) / kBlockPixels;
  }

  template <size_t kVectors>
  HWY_INLINE void compute(const Pixels& pixels, size_t column, size_t offset, size_t width) const {
    FloatVec sums[kGemmRows][kVectors];
    clear(sums);
    const size_t panel_offset = offset * Products::kStep;
    if (grid_.transposed) {
      const size_t tap = pixels.y % grid_.stride * grid_.kernel + pixels.phase;
      multiply_accumulate<Products>(grid_.template input<Element>(pixels.strip, pixels.y, pixels.x), grid_.pixel_step(),
                                    weights_.template panel<Element>(tap, column) + panel_offset, width,
                                    weights_.depth(), sums);
    } else {
      for (size_t tap = 0; tap < grid_.kernel * grid_.kernel; ++tap) {
        const auto* from =
            grid_.template input<Element>(pixels.strip, pixels.y, pixels.x, tap / grid_.kernel, tap % grid_.kernel);
        multiply_accumulate<Products>(from, grid_.pixel_step(),
                                      weights_.template panel<Element>(tap, column) + panel_offset, width,
                                      weights_.depth(), sums);
      }
    }
    epilogue_.select(Finish<kVectors>{*this, pixels, column + offset, sums});
  }

  template <size_t kVectors>
  struct Finish {
    const DirectKernel& kernel;
    const Pixels& pixels;
    size_t column;
    const FloatVec (&sums)[kGemmRows][kVectors];

    template <bool kResidual, class Output>
    HWY_INLINE void visit() const {
      const auto row = kernel.epilogue_.row(pixels.strip, pixels.y);
      const size_t columns = kernel.weights_.columns();
      const size_t step = kernel.grid_.phases() * columns;
      const size_t first = pixels.x * step + pixels.phase * columns;
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) {
        const size_t channel = column + j * kLanes;
        const auto channels = kernel.epilogue_.channels(channel);
        E2LF_UNROLL
        for (size_t i = 0; i < kGemmRows; ++i) {
          if (i >= pixels.count) break;
          Epilogue<Products>::template store<kResidual, Output>(sums[i][j], channels, first + i * step + channel, row);
        }
      }
    }
  };

  TapGrid grid_;
  PackedMatrices weights_;
  Epilogue<Products> epilogue_;
};

}  // namespace

std::unique_ptr<Kernel> MakeDirect(const ConvSpec& spec) {
#if E2LF_TARGET_HAS_BF16
  if (spec.compute == ElementType::kBfloat16) return std::make_unique<DirectKernel<Bfloat16Products>>(spec);
#endif
  E2LF_REQUIRE(spec.compute == ElementType::kFloat32, "bfloat16 needs bfloat16_supported()");
  return std::make_unique<DirectKernel<FloatProducts>>(spec);
}

bool KnowsBfloat16() {
  return E2LF_TARGET_HAS_BF16 != 0;
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {

HWY_EXPORT(MakeDirect);
HWY_EXPORT(KnowsBfloat16);

std::unique_ptr<Kernel> make_direct(const ConvSpec& spec) {
  return HWY_DYNAMIC_DISPATCH(MakeDirect)(spec);
}

bool bfloat16_supported() {
#if defined(__x86_64__)
  return HWY_DYNAMIC_DISPATCH(KnowsBfloat16)() && __builtin_cpu_supports("avx512bf16") != 0;
#else
  return false;
#endif
}

}  // namespace e2lf::engine
#endif
