// SPDX-License-Identifier: MIT
// Implements make_direct() of conv.h: convolutions as sums over the taps.
#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/direct.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/conv_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {

namespace {

// The number of pixels of a row that one block computes.
constexpr size_t kBlockPixels = 96;

/// Packs the weights for a kind of products. Matrix t holds tap t = dy * kernel + dx.
template <class Products>
auto pack_weights(const ConvSpec& spec) {
  const size_t taps = spec.kernel * spec.kernel;
  const auto element = [&](size_t tap, size_t in, size_t out) {
    return spec.tap(out, in, tap / spec.kernel, tap % spec.kernel);
  };
  if constexpr (Factors<Products>::kAreIntegers) {
    return pack_int16(taps, spec.in_channels, spec.out_channels, element, spec.transposed ? 1 : taps, kPanelColumns);
  } else {
    return PackedMatrices(Products::kType, taps, spec.in_channels, spec.out_channels, element, kPanelColumns);
  }
}

/// Computes a convolution as sums over taps. Integers are made from the inputs of a block in scratch memory.
template <class Products>
class DirectKernel final : public Kernel {
  using Element = typename Products::Element;
  using Factor = typename Products::Factor;
  static constexpr bool kIsScaled = Factors<Products>::kAreIntegers;

 public:
  explicit DirectKernel(const ConvSpec& spec)
      : grid_(spec), factors_(pack_weights<Products>(spec), spec.out_channels), epilogue_(spec) {}

  std::string describe() const override {
    return "direct " + std::to_string(grid_.kernel) + "x" + std::to_string(grid_.kernel) + " " +
           describe_products<Products>();
  }

  Reach reach() const override { return grid_.reach(); }

  size_t scratch_bytes() const override { return kIsScaled ? tap_rows() * row_elements() * sizeof(Factor) : 0; }

  size_t num_blocks(const Strip& strip) const override {
    return (strip.end - strip.begin) * grid_.blocks_per_row(strip, kBlockPixels);
  }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const size_t y = strip.begin + block / grid_.blocks_per_row(strip, kBlockPixels);
    const size_t begin = block % grid_.blocks_per_row(strip, kBlockPixels) * kBlockPixels;
    const size_t end = HWY_MIN(begin + kBlockPixels, grid_.sums_per_row(strip));
    Block inputs{strip, y, begin, reinterpret_cast<Factor*>(scratch), 1.0F};
    if constexpr (kIsScaled) inputs.unit = make_integers(inputs, end - begin);
    for (size_t x = begin; x < end; x += kGemmRows) {
      const size_t pixels = HWY_MIN(kGemmRows, end - x);
      for (size_t phase = 0; phase < grid_.phases(); ++phase) {
        for_column_groups(factors_.weights.columns(), Pixels{*this, inputs, x, pixels, phase});
      }
    }
  }

 private:
  /// The sums of a row that are computed one after another.
  struct Block {
    const Strip& strip;
    size_t y, begin;
    Factor* integers;  ///< the inputs of all sums, see factor()
    float unit;        ///< the value of one in them
  };

  /// Neighbouring pixels whose sums are computed together. `x` counts the inputs of a transposed convolution, and
  /// outputs otherwise.
  struct Pixels {
    const DirectKernel& kernel;
    const Block& block;
    size_t x, count, phase;

    template <size_t kVectors>
    HWY_INLINE void visit(size_t column, size_t offset, size_t width) const {
      kernel.compute<kVectors>(*this, column, offset, width);
    }
  };

  // The inputs of a block under one row of taps, with room for those of discarded sums.
  size_t tap_rows() const { return grid_.transposed ? 1 : grid_.kernel; }
  size_t row_elements() const {
    return (kBlockPixels + kGemmRows) * grid_.pixel_step() + grid_.kernel * grid_.in_stride;
  }

  /// Rounds the inputs of the first `count` sums of a block. Returns the value of one.
  float make_integers(const Block& block, size_t count) const {
    const size_t elements = (count - 1) * grid_.pixel_step() + (grid_.transposed ? 1 : grid_.kernel) * grid_.in_stride;
    float largest = 0;
    const auto row = [&](size_t dy) { return grid_.template input<Element>(block.strip, block.y, block.begin, dy, 0); };
    for (size_t dy = 0; dy < tap_rows(); ++dy) {
      largest = HWY_MAX(largest, Factors<Products>::largest_of(row(dy), elements));
    }
    const auto scale = hn::Set(FloatTag(), INT16_MAX / largest);
    for (size_t dy = 0; dy < tap_rows(); ++dy) {
      const Element* from = row(dy);
      Factor* to = block.integers + dy * row_elements();
      for (size_t i = 0; i < elements; i += kLanes) Factors<Products>::store(load_floats(from + i), scale, to + i);
    }
    return largest / INT16_MAX;
  }

  /// Returns the inputs of a sum under a tap.
  HWY_INLINE const Factor* factor(const Pixels& pixels, size_t dy, size_t dx) const {
    const Block& block = pixels.block;
    if constexpr (kIsScaled) {
      return block.integers + dy * row_elements() + (pixels.x - block.begin) * grid_.pixel_step() +
             dx * grid_.in_stride;
    } else {
      return grid_.template input<Element>(block.strip, block.y, pixels.x, dy, dx);
    }
  }

  template <size_t kVectors>
  HWY_INLINE void compute(const Pixels& pixels, size_t column, size_t offset, size_t width) const {
    typename Products::Sum sums[kGemmRows][kVectors];
    clear(sums);
    const PackedMatrices& weights = factors_.weights;
    const size_t panel_offset = offset * Products::kStep;
    if (grid_.transposed) {
      const size_t tap = pixels.block.y % grid_.stride * grid_.kernel + pixels.phase;
      multiply_accumulate<Products>(factor(pixels, 0, 0), grid_.pixel_step(),
                                    weights.template panel<Factor>(tap, column) + panel_offset, width, weights.depth(),
                                    sums);
    } else {
      for (size_t tap = 0; tap < grid_.kernel * grid_.kernel; ++tap) {
        multiply_accumulate<Products>(factor(pixels, tap / grid_.kernel, tap % grid_.kernel), grid_.pixel_step(),
                                      weights.template panel<Factor>(tap, column) + panel_offset, width,
                                      weights.depth(), sums);
      }
    }
    epilogue_.select(Finish<kVectors>{*this, pixels, column + offset, sums});
  }

  template <size_t kVectors>
  struct Finish {
    const DirectKernel& kernel;
    const Pixels& pixels;
    size_t column;
    const typename Products::Sum (&sums)[kGemmRows][kVectors];

    template <bool kResidual, class Output>
    HWY_INLINE void visit() const {
      const auto row = kernel.epilogue_.row(pixels.block.strip, pixels.block.y);
      const size_t columns = kernel.factors_.weights.columns();
      const size_t step = kernel.grid_.phases() * columns;
      const size_t first = pixels.x * step + pixels.phase * columns;
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) {
        const size_t channel = column + j * kLanes;
        const auto channels = kernel.epilogue_.channels(channel);
        const auto unit = kernel.factors_.unit(channel, pixels.block.unit);
        E2LF_UNROLL
        for (size_t i = 0; i < kGemmRows; ++i) {
          if (i >= pixels.count) break;
          const auto sum = Factors<Products>::scaled(Factors<Products>::value(sums[i][j]), unit);
          Epilogue<Products>::template store<kResidual, Output>(sum, channels, first + i * step + channel, row);
        }
      }
    }
  };

  TapGrid grid_;
  Factors<Products> factors_;
  Epilogue<Products> epilogue_;
};

}  // namespace

std::unique_ptr<Kernel> MakeDirect(const ConvSpec& spec, bool integers) {
  return make_conv_kernel<DirectKernel>(spec, integers);
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

std::unique_ptr<Kernel> make_direct(const ConvSpec& spec, bool integers) {
  return HWY_DYNAMIC_DISPATCH(MakeDirect)(spec, integers);
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
