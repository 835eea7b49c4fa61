// SPDX-License-Identifier: MIT
#include "e2lf/engine/conv.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/winograd.h"
#include "testing/test_networks.h"

namespace e2lf::engine {
namespace {

ConvSpec random_spec(size_t in, size_t out, size_t kernel, uint64_t seed) {
  ConvSpec spec;
  spec.in_channels = in;
  spec.out_channels = out;
  spec.kernel = kernel;
  spec.weight =
      random_values(in * out * kernel * kernel, seed, std::sqrt(3.0F / static_cast<float>(in * kernel * kernel)));
  spec.bias = random_values(out, seed + 1);
  return spec;
}

/// Rows with zeros around them, as kernels expect them.
class Grid {
 public:
  static constexpr size_t kMargin = 16;

  Grid(size_t height, size_t width, size_t channels, ElementType type)
      : pixel_bytes_(padded_channels(channels) * element_size(type)),
        memory_((height + 2 * kMargin) * (width + 2 * kMargin) * pixel_bytes_) {
    for (size_t y = 0; y < height + 2 * kMargin; ++y) {
      pointers_.push_back(memory_.data() + (y * (width + 2 * kMargin) + kMargin) * pixel_bytes_);
    }
  }
  [[nodiscard]] Rows rows() const { return {pointers_.data(), -static_cast<ptrdiff_t>(kMargin)}; }

  float& at(size_t y, size_t x, size_t c) {
    return rows().row<float>(static_cast<ptrdiff_t>(y))[x * pixel_bytes_ / 4 + c];
  }
  Bfloat16& narrow_at(size_t y, size_t x, size_t c) {
    return rows().row<Bfloat16>(static_cast<ptrdiff_t>(y))[x * pixel_bytes_ / 2 + c];
  }

 private:
  size_t pixel_bytes_;
  AlignedBuffer memory_;
  mutable std::vector<std::byte*> pointers_;
};

/// As a kernel of the spec's type sees it.
float rounded(const ConvSpec& spec, float value) {
  return spec.compute == ElementType::kBfloat16 ? to_float(to_bfloat16(value)) : value;
}

/// Interleaved values of an image.
struct Values {
  size_t height, width, channels;
  std::vector<float> values;
  [[nodiscard]] float at(size_t y, size_t x, size_t c) const { return values[(y * width + x) * channels + c]; }
};

/// One output in double precision, of weights and inputs as a kernel of the spec's type sees them.
double expected_output(const ConvSpec& spec, const Values& input, size_t y, size_t x, size_t out) {
  double sum = spec.bias[out];
  for (size_t tap = 0; tap < spec.kernel * spec.kernel; ++tap) {
    const size_t dy = tap / spec.kernel, dx = tap % spec.kernel;
    if (spec.transposed && (dy != y % spec.stride || dx != x % spec.stride)) continue;
    const size_t radius = spec.stride == 1 ? spec.kernel / 2 : 0;
    const size_t in_y = spec.transposed ? y / spec.stride : y * spec.stride + dy - radius;  // wraps below zero
    const size_t in_x = spec.transposed ? x / spec.stride : x * spec.stride + dx - radius;
    if (in_y >= input.height || in_x >= input.width) continue;
    for (size_t in = 0; in < spec.in_channels; ++in) {
      sum += static_cast<double>(rounded(spec, spec.tap(out, in, dy, dx))) * input.at(in_y, in_x, in);
    }
  }
  return sum;
}

/// The largest difference between a kernel's float32 result for an input of that size and sums in double precision. NaN
/// is the largest of all.
double error_of(const Kernel& kernel, const ConvSpec& spec, size_t in_height, size_t in_width, float brightness = 1) {
  Grid input(in_height, in_width, spec.in_channels, spec.compute);
  Values values{in_height, in_width, spec.in_channels, random_values(in_height * in_width * spec.in_channels, 11)};
  for (size_t i = 0; i < values.values.size(); ++i) {
    float& value = values.values[i];
    value *= brightness;
    const size_t y = i / spec.in_channels / in_width, x = i / spec.in_channels % in_width, c = i % spec.in_channels;
    if (spec.compute == ElementType::kFloat32) input.at(y, x, c) = value;
    if (spec.compute == ElementType::kBfloat16) input.narrow_at(y, x, c) = to_bfloat16(value);
    value = rounded(spec, value);
  }
  const size_t height = spec.transposed ? in_height * spec.stride : in_height / spec.stride;
  const size_t width = spec.transposed ? in_width * spec.stride : in_width / spec.stride;
  Grid output(height, width, spec.out_channels, ElementType::kFloat32);
  Strip strip;
  strip.inputs = {input.rows()};
  strip.output = output.rows();
  strip.end = strip.height = height;
  strip.width = width;
  const AlignedBuffer scratch(kernel.scratch_bytes());
  std::memset(scratch.data(), 0xFF, scratch.size());  // NaN of either type: what other kernels leave may be one
  for (size_t block = 0; block < kernel.num_blocks(strip); ++block) kernel.run_block(strip, block, scratch.data());
  double largest = 0.0;
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      for (size_t out = 0; out < spec.out_channels; ++out) {
        const double error = std::abs(expected_output(spec, values, y, x, out) - output.at(y, x, out));
        largest = error <= largest ? largest : error;
      }
    }
  }
  return largest;
}

class ConvTest : public ::testing::Test {
 protected:
  void TearDown() override { set_max_isa("").value(); }
};

TEST_F(ConvTest, EveryMethodEqualsPlainSumsForEveryInstructionSet) {
  uint64_t seed = 0;
  for (const std::string& isa : available_isas()) {
    set_max_isa(isa).value();
    for (const size_t kernel : {1, 3, 5, 11}) {
      for (const auto& [in, out] : std::vector<std::pair<size_t, size_t>>{{1, 1}, {3, 64}, {17, 33}, {64, 80}}) {
        if (kernel == 11 && in > 3) continue;  // slow in the reference
        const ConvSpec spec = random_spec(in, out, kernel, ++seed);
        EXPECT_LT(error_of(*make_direct(spec), spec, 6, 23), 1e-5) << isa << " direct " << kernel << " " << in;
        if (kernel == 1) continue;
        EXPECT_LT(error_of(*make_winograd(spec), spec, 6, 23), 2e-5) << isa << " Winograd " << kernel << " " << in;
      }
    }
  }
}

TEST_F(ConvTest, SumsOfBfloat16ProductsAreThoseOfTheRoundedNumbers) {
  if (!bfloat16_supported()) GTEST_SKIP() << "this CPU has no AVX512_BF16";
  uint64_t seed = 0;
  for (const size_t kernel : {1, 3, 5}) {
    for (const auto& [in, out] : std::vector<std::pair<size_t, size_t>>{{3, 64}, {9, 16}, {33, 33}, {64, 80}}) {
      ConvSpec spec = random_spec(in, out, kernel, ++seed);
      spec.compute = ElementType::kBfloat16;
      for (const size_t width : {1, 16, 23, 40, 101, 150}) {  // 150: more than one block
        EXPECT_LT(error_of(*make_direct(spec), spec, 3, width), 1e-5) << "direct " << kernel << " " << in;
        // Its transformed numbers are rounded once more.
        if (kernel > 1) {
          EXPECT_LT(error_of(*make_winograd(spec), spec, 3, width), 0.2) << "Winograd " << kernel << " " << in;
        }
        if (current_isa() != "amx") continue;
        EXPECT_LT(error_of(*make_amx(spec), spec, 3, width), 1e-5) << "AMX " << kernel << " " << in << " " << width;
      }
    }
  }
}

TEST_F(ConvTest, Int16ProductsAreNearPlainSumsForEveryInstructionSetThatHasThem) {
  uint64_t seed = 50;
  for (const std::string& isa : available_isas()) {
    set_max_isa(isa).value();
    if (!int16_supported()) continue;
    for (const size_t kernel : {3, 5}) {
      for (const auto& [in, out] : std::vector<std::pair<size_t, size_t>>{{5, 16}, {17, 33}, {40, 80}}) {
        ConvSpec spec = random_spec(in, out, kernel, ++seed);
        spec.int16_products = true;
        // Channels of very different size keep their digits.
        for (size_t i = 0; i < spec.weight.size() / out; ++i) spec.weight[i] *= 1e-3F;
        for (const size_t width : {1, 23, 101}) {
          EXPECT_LT(error_of(*make_winograd(spec, true), spec, 6, width), 0.1) << isa << " " << kernel << " " << in;
        }
      }
    }
  }
}

TEST_F(ConvTest, Int16ProductsKeepTheDigitsOfDarkInputs) {
  if (!int16_supported()) GTEST_SKIP() << "this CPU has no int16 products";
  ConvSpec spec = random_spec(40, 33, 3, 9);
  spec.bias.assign(33, 0.0F);
  spec.int16_products = true;
  for (const float brightness : {1e-6F, 0.0F}) {
    EXPECT_LE(error_of(*make_winograd(spec, true), spec, 6, 23, brightness), 0.1 * brightness);
    EXPECT_LE(error_of(*make_direct(spec, true), spec, 6, 23, brightness), 0.01 * brightness);
  }
}

TEST_F(ConvTest, Int16WeightsCannotOverflowTheirSums) {
  ConvSpec spec = random_spec(96, 33, 3, 7);
  for (float& weight : spec.weight) weight *= 1e3F;
  const ScaledWeights scaled = pack_winograd_int16(spec, 16);
  for (size_t point = 0; point < kWinogradMatrices; ++point) {
    for (size_t column = 0; column < scaled.weights.columns(); ++column) {
      const int16_t* panel = scaled.weights.panel<int16_t>(point, column / 16 * 16);
      int64_t sum = 0;
      for (size_t row = 0; row < 96; ++row) sum += std::abs(panel[row / 2 * 32 + column % 16 * 2 + row % 2]);
      EXPECT_LE(sum * INT16_MAX, INT32_MAX) << point << " " << column;
    }
  }
}

TEST_F(ConvTest, Int16ProductsAreOnlyForThoseWhoWantThem) {
  ConvSpec spec = random_spec(64, 64, 3, 1);
  EXPECT_NE(winograd_int16_refusal(spec), "");
  spec.int16_products = true;
  EXPECT_EQ(winograd_int16_refusal(spec), "");
  EXPECT_NE(winograd_int16_refusal(random_spec(64, 64, 1, 1)), "");
  set_max_isa("sse4").value();
  EXPECT_FALSE(int16_supported());
  EXPECT_THROW((void)make_winograd(spec, true), ContractError);
}

TEST_F(ConvTest, StridedAndTransposedConvolutionsArePlainSumsToo) {
  uint64_t seed = 100;
  for (const size_t stride : {2, 3}) {
    for (const bool transposed : {false, true}) {
      ConvSpec spec = random_spec(33, 40, stride, ++seed);
      spec.stride = stride;
      spec.transposed = transposed;
      const size_t width = transposed ? 150 : 150 * stride;  // more than one block of sums
      EXPECT_LT(error_of(*make_direct(spec), spec, 6, width), 1e-5) << "direct " << stride << " " << transposed;
      if (int16_supported()) {
        EXPECT_LT(error_of(*make_direct(spec, true), spec, 6, width), 5e-3) << "int16 " << stride << " " << transposed;
      }
      if (!bfloat16_supported()) continue;
      spec.compute = ElementType::kBfloat16;
      EXPECT_LT(error_of(*make_direct(spec), spec, 6, width), 1e-5) << "bfloat16 " << stride << " " << transposed;
      if (current_isa() != "amx") continue;
      EXPECT_LT(error_of(*make_amx(spec), spec, 6, width), 1e-5) << "AMX " << stride << " " << transposed;
    }
  }
}

TEST_F(ConvTest, AmxIsForBfloat16OfMoreThanAFewChannelsWhereTheCpuHasIt) {
  ConvSpec spec = random_spec(64, 64, 3, 1);
  EXPECT_NE(amx_refusal(spec), "");
  spec.compute = ElementType::kBfloat16;
  EXPECT_EQ(amx_refusal(spec) == "", current_isa() == "amx");
  spec.in_channels = 3;
  EXPECT_NE(amx_refusal(spec), "");
  spec.in_channels = 64;
  set_max_isa("avx512").value();
  EXPECT_NE(amx_refusal(spec), "");
}

TEST_F(ConvTest, MethodsSayWhyTheyDoNotApply) {
  ConvSpec spec = random_spec(64, 64, 3, 1);
  EXPECT_EQ(winograd_refusal(spec), "");
  spec.stride = 3;
  EXPECT_NE(winograd_refusal(spec), "");
  EXPECT_NE(winograd_refusal(random_spec(64, 64, 1, 1)), "");
  EXPECT_NE(winograd_refusal(random_spec(3, 64, 3, 1)), "");
  EXPECT_EQ(conv_methods().back().refusal(spec), "");
}

TEST_F(ConvTest, NoMethodMakesBfloat16WhereItIsNotSupported) {
  ConvSpec spec = random_spec(64, 64, 3, 1);
  spec.compute = ElementType::kBfloat16;
  set_max_isa("avx2").value();
  ASSERT_FALSE(bfloat16_supported());
  EXPECT_THROW((void)make_conv(spec), ContractError);
  for (const ConvMethod& method : conv_methods()) EXPECT_THROW((void)method.make(spec), ContractError) << method.name;
}

TEST_F(ConvTest, PackedMatricesHoldPanelsOfColumns) {
  const PackedMatrices packed(ElementType::kFloat32, 2, 3, 70, [](size_t matrix, size_t row, size_t column) {
    return static_cast<float>(matrix * 10000 + row * 100 + column);
  });
  EXPECT_EQ(packed.depth(), 4U);
  EXPECT_EQ(packed.columns(), 80U);
  EXPECT_EQ(packed.panel<float>(1, 0)[2 * 64 + 5], 10205.0F);
  EXPECT_EQ(packed.panel<float>(1, 64)[1 * 16 + 3], 10167.0F);
  EXPECT_EQ(packed.panel<float>(1, 64)[1 * 16 + 6], 0.0F);  // padding
  EXPECT_EQ(packed.panel<float>(0, 0)[3 * 64], 0.0F);
}

TEST_F(ConvTest, PackedBfloat16HoldsPairsOfRows) {
  const PackedMatrices packed(ElementType::kBfloat16, 1, 4, 16, [](size_t /*matrix*/, size_t row, size_t column) {
    return static_cast<float>(row * 16 + column);
  });
  EXPECT_EQ(to_float(packed.panel<Bfloat16>(0, 0)[1 * 32 + 2 * 7]), 2 * 16 + 7.0F);
  EXPECT_EQ(to_float(packed.panel<Bfloat16>(0, 0)[1 * 32 + 2 * 7 + 1]), 3 * 16 + 7.0F);
}

TEST_F(ConvTest, Bfloat16RoundsToTheNearestEven) {
  EXPECT_EQ(to_float(to_bfloat16(1.0F + 1.0F / 256)), 1.0F);
  EXPECT_EQ(to_float(to_bfloat16(1.0F + 3.0F / 256)), 1.0F + 4.0F / 256);
  EXPECT_EQ(to_float(to_bfloat16(1.0F + 1.01F / 256)), 1.0F + 2.0F / 256);
  EXPECT_EQ(to_float(to_bfloat16(-2.5F)), -2.5F);
}

TEST(ChainTest, ComposedTapsAreTheConvolutionOfTheTaps) {
  ConvSpec first = random_spec(1, 1, 3, 1);
  ConvSpec second = random_spec(1, 1, 3, 2);
  first.weight = {0, 0, 0, 1, 2, 3, 0, 0, 0};
  first.bias = {10};
  second.weight = {0, 5, 0, 0, 7, 0, 0, 0, 0};
  second.bias = {1};
  const ConvSpec whole = compose({first, second});
  EXPECT_EQ(whole.kernel, 5U);
  EXPECT_EQ(whole.bias, std::vector<float>{121});
  std::vector<float> expected(25, 0.0F);
  for (size_t x = 0; x < 3; ++x) {
    expected[1 * 5 + 1 + x] = 5.0F * static_cast<float>(x + 1);
    expected[2 * 5 + 1 + x] = 7.0F * static_cast<float>(x + 1);
  }
  EXPECT_EQ(whole.weight, expected);
}

TEST(ChainTest, ComposesOnlyWhatGetsCheaper) {
  const ConvSpec narrow = random_spec(3, 64, 5, 1);
  const ConvSpec wide = random_spec(64, 64, 5, 2);
  EXPECT_TRUE(worth_composing({narrow, wide, wide}));
  EXPECT_FALSE(worth_composing({wide, wide}));
  EXPECT_FALSE(worth_composing({narrow}));
  EXPECT_EQ(frame_width({narrow, wide, wide}), 4U);
}

}  // namespace
}  // namespace e2lf::engine
