// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/image.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

using testing::HasSubstr;

ReadOptions all_views() {
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  return options;
}

template <typename T>
StoredArray stored(const Shape& shape, const AxisStrides& strides, const char* type, const std::vector<T>& samples) {
  return {shape, strides, type, std::span(reinterpret_cast<const uint8_t*>(samples.data()), samples.size() * sizeof(T)),
          white_of_type(type)};
}

std::vector<size_t> taken(const ChosenViews& views) {
  std::vector<size_t> out;
  for (size_t i = 0; i < views.count; ++i) out.push_back(views[i]);
  return out;
}

std::vector<size_t> taken_of(size_t num_stored, const AxisViews& wanted) {
  ReadOptions options;
  options.views_x = wanted;
  return taken(choose_views(8, num_stored, options, "a").value().x);
}

TEST(ChooseViews, TakesTheCentreAndRoundsDown) {
  EXPECT_THAT(taken_of(8, {}), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(taken_of(9, {}), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(taken_of(14, {}), testing::ElementsAre(3, 4, 5, 6, 7, 8, 9, 10));
  EXPECT_THAT(taken_of(17, {}), testing::ElementsAre(4, 5, 6, 7, 8, 9, 10, 11));
  EXPECT_THAT(taken_of(17, {.count = 8, .step = 2, .first = {}}), testing::ElementsAre(1, 3, 5, 7, 9, 11, 13, 15));
}

TEST(ChooseViews, TakesWhatIsAskedFor) {
  EXPECT_THAT(taken_of(9, {.count = 3, .step = 1, .first = 6}), testing::ElementsAre(6, 7, 8));
  EXPECT_THAT(taken_of(5, {.count = 0, .step = 1, .first = {}}), testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(taken_of(6, {.count = 0, .step = 2, .first = 1}), testing::ElementsAre(1, 3, 5));
}

TEST(ChooseViews, ReversesRowsOnly) {
  ReadOptions options;
  options.reverse_rows = true;
  const ChosenGrid grid = choose_views(9, 9, options, "a").value();
  EXPECT_THAT(taken(grid.y), testing::ElementsAre(8, 7, 6, 5, 4, 3, 2, 1));
  EXPECT_THAT(taken(grid.x), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(ChooseViews, RefusesWhatIsNotStored) {
  ReadOptions options;
  EXPECT_EQ(choose_views(8, 7, options, "a").error().code, ErrorCode::kShape);
  EXPECT_EQ(choose_views(0, 8, options, "a").error().code, ErrorCode::kShape);
  options.views_x = {.count = 8, .step = 2, .first = {}};
  EXPECT_FALSE(choose_views(8, 14, options, "a").ok());
  EXPECT_TRUE(choose_views(8, 15, options, "a").ok());
  options.views_x = {.count = 8, .step = 1, .first = 2};
  EXPECT_FALSE(choose_views(8, 9, options, "a").ok());
  options.views_x = {.count = SIZE_MAX, .step = SIZE_MAX, .first = {}};
  EXPECT_FALSE(choose_views(8, 9, options, "a").ok());
  options.views_x = {.count = 0, .step = 1, .first = 9};
  EXPECT_FALSE(choose_views(8, 9, options, "a").ok());
}

/// Every convention is written out here as nested loops, outermost axis first.
class AxisOrder : public testing::Test {
 protected:
  static constexpr size_t kViewsY = 2, kViewsX = 3, kHeight = 5, kWidth = 35;

  explicit AxisOrder(size_t channels = 3)
      : shape_{kViewsY, kViewsX, kHeight, kWidth, channels}, expected_(numbered_light_field(shape_)) {}

  void put(size_t view_y, size_t view_x, size_t y, size_t x, size_t channel) {
    samples_.push_back(expected_.at(view_y, view_x, y, x, channel));
  }
  void expect_reads_back(const AxisStrides& strides) {
    ReadOptions options = all_views();
    options.colour = true;
    const Result<LightField> read = from_stored(stored(shape_, strides, "f4", samples_), options, "a");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_TRUE(same(*read, expected_));
  }

  Shape shape_;
  LightField expected_;
  std::vector<float> samples_;
};

class GreyAxisOrder : public AxisOrder {
 protected:
  GreyAxisOrder() : AxisOrder(1) {}
};

TEST_F(AxisOrder, UvhwcIsViewRowViewColumnRowColumnChannel) {
  for (size_t u = 0; u < kViewsY; ++u)
    for (size_t v = 0; v < kViewsX; ++v)
      for (size_t h = 0; h < kHeight; ++h)
        for (size_t w = 0; w < kWidth; ++w)
          for (size_t c = 0; c < 3; ++c) put(u, v, h, w, c);
  expect_reads_back(uvhwc_strides(shape_));
}

TEST_F(AxisOrder, MatlabUvhwcVariesTheViewRowFastest) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t w = 0; w < kWidth; ++w)
      for (size_t h = 0; h < kHeight; ++h)
        for (size_t v = 0; v < kViewsX; ++v)
          for (size_t u = 0; u < kViewsY; ++u) put(u, v, h, w, c);
  expect_reads_back(matlab_uvhwc_strides(shape_));
}

TEST_F(AxisOrder, HuwvcPutsTheViewsOfAPixelSideBySide) {
  for (size_t h = 0; h < kHeight; ++h)
    for (size_t u = 0; u < kViewsY; ++u)
      for (size_t w = 0; w < kWidth; ++w)
        for (size_t v = 0; v < kViewsX; ++v)
          for (size_t c = 0; c < 3; ++c) put(u, v, h, w, c);
  expect_reads_back(huwvc_strides(shape_));
}

TEST_F(GreyAxisOrder, VwuhIsATransposedMosaicOfViews) {
  for (size_t v = 0; v < kViewsX; ++v)
    for (size_t w = 0; w < kWidth; ++w)
      for (size_t u = 0; u < kViewsY; ++u)
        for (size_t h = 0; h < kHeight; ++h) put(u, v, h, w, 0);
  expect_reads_back(vwuh_strides(shape_));
}

TEST(FromStored, DividesIntegersByTheirLargestValue) {
  const Shape shape{1, 1, 1, 3, 1};
  const auto row = [](const Result<LightField>& read) {
    return std::vector<float>(read.value().data().begin(), read.value().data().end());
  };
  const std::vector<uint8_t> bytes = {0, 51, 255};
  EXPECT_THAT(row(from_stored(stored(shape, uvhwc_strides(shape), "u1", bytes), all_views(), "a")),
              testing::ElementsAre(0, 0.2F, 1));
  const std::vector<uint16_t> words = {0, 13107, 65535};
  EXPECT_THAT(row(from_stored(stored(shape, uvhwc_strides(shape), "u2", words), all_views(), "a")),
              testing::ElementsAre(0, 0.2F, 1));
  const std::vector<double> doubles = {0, 0.2, 1};
  EXPECT_THAT(row(from_stored(stored(shape, uvhwc_strides(shape), "f8", doubles), all_views(), "a")),
              testing::ElementsAre(0, 0.2F, 1));
}

TEST(FromStored, UsesTheFirstThreeOfMoreChannels) {
  const Shape shape{1, 1, 1, 2, 5};
  const std::vector<float> samples = {0.1F, 0.2F, 0.3F, 9, std::nanf(""), 0.5F, 0.5F, 0.5F, -1, 7};
  ReadOptions options = all_views();
  const StoredArray array = stored(shape, uvhwc_strides(shape), "f4", samples);
  EXPECT_EQ(from_stored(array, options, "a").value().at(0, 0, 0, 0), grey_of(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(from_stored(array, options, "a").value().at(0, 0, 0, 1), 0.5F);
  options.colour = true;
  const LightField colour = from_stored(array, options, "a").value();
  EXPECT_EQ(colour.shape().channels, 3U);
  EXPECT_EQ(colour.at(0, 0, 0, 0, 2), 0.3F);
}

class Range : public testing::Test {
 protected:
  Result<LightField> read(float value, RangePolicy policy) {
    LightField light_field(Shape{2, 2, 3, 40, 1});
    light_field.at(1, 0, 2, 39) = value;
    samples_.assign(light_field.data().begin(), light_field.data().end());
    ReadOptions options = all_views();
    options.range = policy;
    const Shape& shape = light_field.shape();
    return from_stored(stored(shape, uvhwc_strides(shape), "f4", samples_), options, "a.npy");
  }
  float at(float value, RangePolicy policy) { return read(value, policy).value().at(1, 0, 2, 39); }

  std::vector<float> samples_;
};

TEST_F(Range, RefusesAndNamesTheFirstValueOutside) {
  for (const float value : {1.1F, -0.2F, 255.0F}) {
    const Error error = read(value, RangePolicy::kRefuse).error();
    EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
    EXPECT_THAT(error.text(), HasSubstr("view row 1, view column 0, y 2, x 39"));
  }
  EXPECT_EQ(at(1.0005F, RangePolicy::kRefuse), 1.0F);
  EXPECT_EQ(at(-0.0005F, RangePolicy::kRefuse), 0.0F);
}

TEST_F(Range, ClampsOrKeepsWhenAsked) {
  EXPECT_EQ(at(1.5F, RangePolicy::kClamp), 1.0F);
  EXPECT_EQ(at(-3.0F, RangePolicy::kClamp), 0.0F);
  EXPECT_EQ(at(1.5F, RangePolicy::kKeep), 1.5F);
}

TEST_F(Range, NeverTakesNanInfinityOrCounts) {
  for (const RangePolicy policy : {RangePolicy::kRefuse, RangePolicy::kClamp, RangePolicy::kKeep}) {
    EXPECT_EQ(read(std::nanf(""), policy).error().code, ErrorCode::kInvalidValue);
    EXPECT_EQ(read(std::numeric_limits<float>::infinity(), policy).error().code, ErrorCode::kInvalidValue);
    EXPECT_EQ(read(255.0F, policy).error().code, ErrorCode::kInvalidValue);
  }
}

TEST(CheckMemory, RefusesMoreThanTheLimitWithoutOverflow) {
  ReadOptions options;
  options.max_bytes = 1000;
  EXPECT_TRUE(check_memory({1, 1, 10, 25, 1}, 4, options, "a").ok());
  EXPECT_EQ(check_memory({1, 1, 10, 26, 1}, 4, options, "a").error().code, ErrorCode::kUnsupported);
  EXPECT_FALSE(check_memory({SIZE_MAX, SIZE_MAX, SIZE_MAX, SIZE_MAX, 3}, 8, options, "a").ok());
  EXPECT_EQ(check_memory({8, 8, 0, 10, 1}, 4, options, "a").error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::lightfield
