// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/light_field_io.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/image.h"
#include "testing/test_files.h"
#include "testing/test_light_field.h"
#include "testing/test_log.h"

namespace e2lf::lightfield {
namespace {

using testing::HasSubstr;

TEST(Lenslet, TakesTheCentralViewsOfFourteen) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({14, 14, 3, 4, 3});
  ASSERT_TRUE(write_png(folder / "eslf.png", mosaic_of(stored), PngDepth::k16).ok());
  ReadOptions options;
  options.colour = true;
  const LightField read = read_light_field(folder / "eslf.png", options).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 3, 4, 3}));
  EXPECT_EQ(read.at(0, 0, 2, 1, 1), stored.at(3, 3, 2, 1, 1));
  EXPECT_EQ(read.at(7, 2, 0, 3, 2), stored.at(10, 5, 0, 3, 2));
  options.lenslet_views = 15;
  EXPECT_EQ(read_light_field(folder / "eslf.png", options).error().code, ErrorCode::kShape);
}

TEST(Npy, ReadsEveryShape) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 3, 5, 1});
  std::vector<uint8_t> bytes;
  for (const float value : stored.data()) bytes.push_back(static_cast<uint8_t>(value * 255.0F + 0.5F));
  const std::vector<std::vector<size_t>> shapes = {{8, 8, 3, 5}, {8, 8, 3, 5, 1}, {64, 3, 5}, {64, 3, 5, 1}};
  for (const auto& shape : shapes) {
    ASSERT_TRUE(write_npy(folder / "a.npy", make_npy<float>(shape, stored.data())).ok());
    EXPECT_TRUE(same(read_light_field(folder / "a.npy").value(), stored)) << shape_text(shape);
    ASSERT_TRUE(write_npy(folder / "a.npy", make_npy<uint8_t>(shape, bytes)).ok());
    EXPECT_TRUE(same(read_light_field(folder / "a.npy").value(), stored)) << shape_text(shape);
  }
}

TEST(Npy, OtherShapesTypesAndNanAreErrors) {
  const TestFolder folder;
  const auto read_as = [&](const NpyArray& array) {
    EXPECT_TRUE(write_npy(folder / "a.npy", array).ok());
    return read_light_field(folder / "a.npy").error().code;
  };
  const std::vector<float> floats(64 * 6);
  EXPECT_EQ(read_as(make_npy<float>({63, 2}, std::span(floats).first(126))), ErrorCode::kShape);
  EXPECT_EQ(read_as(make_npy<float>({3, 64, 2}, floats)), ErrorCode::kShape);
  EXPECT_EQ(read_as(make_npy<float>({4, 16, 2, 3}, floats)), ErrorCode::kShape);
  const std::vector<int32_t> counts(64 * 6);
  EXPECT_EQ(read_as(make_npy<int32_t>({64, 2, 3}, counts)), ErrorCode::kUnsupported);
  EXPECT_EQ(read_as(make_npy<int16_t>({64, 2, 3}, std::vector<int16_t>(64 * 6))), ErrorCode::kShape);
  EXPECT_EQ(detect_kind(folder / "a.npy").error().code, ErrorCode::kUnsupported);
  std::vector<float> nan = floats;
  nan[100] = std::nanf("");
  EXPECT_EQ(read_as(make_npy<float>({64, 2, 3}, nan)), ErrorCode::kInvalidValue);
  EXPECT_EQ(read_as(make_npy<float>({64, 0, 3}, {})), ErrorCode::kShape);
}

TEST(Npy, NumbersAreDividedByTheWhiteThatIsNamed) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 3, 5, 1});
  std::vector<float> counts;
  std::vector<int32_t> whole;
  for (const float value : stored.data()) {
    whole.push_back(static_cast<int32_t>(value * 255.0F + 0.5F));
    counts.push_back(static_cast<float>(whole.back()));
  }
  const auto read = [&](const NpyArray& array, float white, RangePolicy range) {
    EXPECT_TRUE(write_npy(folder / "a.npy", array).ok());
    ReadOptions options;
    options.white = white;
    options.range = range;
    return read_light_field(folder / "a.npy", options);
  };
  const std::vector<size_t> shape = {8, 8, 3, 5};
  for (const RangePolicy range : {RangePolicy::kRefuse, RangePolicy::kClamp, RangePolicy::kKeep}) {
    const auto refused = read(make_npy<float>(shape, counts), 0.0F, range);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().option, "white");
    EXPECT_TRUE(same(read(make_npy<float>(shape, counts), 255.0F, range).value(), stored));
    EXPECT_EQ(read(make_npy<int32_t>(shape, whole), 0.0F, range).error().option, "white");
    EXPECT_TRUE(same(read(make_npy<int32_t>(shape, whole), 255.0F, range).value(), stored));
  }
}

TEST(Npy, ReadsHalfPrecision) {
  const TestFolder folder;
  NpyArray array;
  array.type = "f2";
  array.item_size = 2;
  array.shape = {8, 8, 1, 1};
  for (int i = 0; i < 64; ++i) array.bytes.insert(array.bytes.end(), {0x00, 0x38});  // 0.5
  ASSERT_TRUE(write_npy(folder / "a.npy", array).ok());
  EXPECT_EQ(read_light_field(folder / "a.npy")->at(7, 7, 0, 0), 0.5F);
}

TEST(Lenslet, TheNumberOfViewsIsStatedOrAskedFor) {
  const TestFolder folder;
  ASSERT_TRUE(write_png(folder / "other.png", Image(112, 112, 1)).ok());
  EXPECT_EQ(read_light_field(folder / "other.png").error().code, ErrorCode::kInvalidValue);
  ASSERT_TRUE(write_png(folder / "other_eslf.png", Image(112, 112, 1)).ok());
  EXPECT_EQ(read_light_field(folder / "other_eslf.png")->shape(), (Shape{8, 8, 8, 8, 1}));
}

TEST(Lenslet, AnotherLayoutThanTheStatedOneIsRefused) {
  const TestFolder folder;
  constexpr size_t kViews = 15, kHeight = 28, kWidth = 42;
  const auto scene = [](double y, double x) {
    return static_cast<float>(0.5 + 0.2 * std::sin(0.77 * x) + 0.2 * std::cos(0.7 * y));
  };
  Image lenslets(kViews * kWidth, kViews * kHeight, 1), montage = lenslets;
  for (size_t v = 0; v < kViews; ++v) {
    for (size_t u = 0; u < kViews; ++u) {
      for (size_t y = 0; y < kHeight; ++y) {
        for (size_t x = 0; x < kWidth; ++x) {
          const float value = scene(static_cast<double>(y) + 0.1 * static_cast<double>(v),
                                    static_cast<double>(x) + 0.1 * static_cast<double>(u));
          lenslets.pixels[(y * kViews + v) * lenslets.width + x * kViews + u] = value;
          montage.pixels[(v * kHeight + y) * montage.width + u * kWidth + x] = value;
        }
      }
    }
  }
  ASSERT_TRUE(write_png(folder / "eslf.png", lenslets).ok());
  EXPECT_EQ(read_light_field(folder / "eslf.png").error().option, "lenslet_views");  // 14 divides 630x420, too
  ReadOptions options;
  options.lenslet_views = kViews;
  EXPECT_TRUE(read_light_field(folder / "eslf.png", options).ok());
  ASSERT_TRUE(write_png(folder / "montage.png", montage).ok());
  EXPECT_EQ(read_light_field(folder / "montage.png", options).error().code, ErrorCode::kUnsupported);
}

ReadOptions of_grid(size_t views) {
  ReadOptions options;
  options.lenslet_views = views;
  return options;
}

ReadOptions with_columns(size_t columns) {
  ReadOptions options;
  options.view_columns = columns;
  return options;
}

/// A lenslet mosaic of 8x8 views that differ a little.
Image mosaic_of_8x8(size_t side) {
  constexpr size_t kViews = 8;
  Image mosaic(kViews * side, kViews * side, 1);
  for (size_t row = 0; row < mosaic.height; ++row) {
    for (size_t column = 0; column < mosaic.width; ++column) {
      const double y = static_cast<double>(row / kViews) - 0.1 * static_cast<double>(row % kViews);
      const double x = static_cast<double>(column / kViews) - 0.1 * static_cast<double>(column % kViews);
      mosaic.pixels[row * mosaic.width + column] =
          static_cast<float>(0.5 + 0.2 * std::sin(0.77 * x + 0.2 * y) + 0.2 * std::cos(0.7 * y));
    }
  }
  return mosaic;
}

TEST(Lenslet, EveryOtherNumberOfViewsThanThatOfTheContentIsRefused) {
  const TestFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", mosaic_of_8x8(80)).ok());
  for (const size_t views : {2, 4, 5, 16, 32}) {
    EXPECT_EQ(read_light_field(folder / "a.png", of_grid(views)).error().option, "lenslet_views") << views;
  }
  EXPECT_EQ(read_light_field(folder / "a.png", of_grid(8))->shape(), (Shape{8, 8, 80, 80, 1}));
}

TEST(ReadOptions, OnesWithoutEffectAreTold) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 2, 2, 1});
  ASSERT_TRUE(write_light_field(folder / "views", stored).ok());
  ASSERT_TRUE(write_light_field(folder / "a.h5", stored, {.format = LightFieldFormat::kHdf5}).ok());
  ASSERT_TRUE(write_light_field(folder / "a.npy", stored, {.format = LightFieldFormat::kNpy}).ok());
  for (const char* name : {"views", "a.h5", "a.npy"}) {
    const TestLog log;
    const auto num_told = [&log] {
      size_t count = 0;
      for (size_t at = 0; (at = log.text().find("no effect", at)) != std::string::npos; ++at) ++count;
      return count;
    };
    ASSERT_TRUE(read_light_field(folder / name).ok());
    EXPECT_EQ(num_told(), 0U) << name;
    ASSERT_TRUE(read_light_field(folder / name, of_grid(5)).ok());
    EXPECT_EQ(num_told(), 1U) << name;
    ASSERT_TRUE(read_light_field(folder / name, with_columns(8)).ok());
    EXPECT_EQ(num_told(), 2U) << name;
  }
}

TEST(Npz, FindsTheLightField) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 2, 2, 1});
  const NpyArray array = make_npy<float>({64, 2, 2}, stored.data());
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"whatever", array}}).ok());
  EXPECT_TRUE(same(read_light_field(folder / "a.npz").value(), stored));
  const NpyArray other = make_npy<float>({1}, std::vector<float>{1});
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"LF", array}, {"gain", other}}).ok());
  EXPECT_TRUE(same(read_light_field(folder / "a.npz").value(), stored));
  EXPECT_EQ(detect_kind(folder / "a.npz").value(), LightFieldKind::kNpz);
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"events", array}, {"gain", other}}).ok());
  EXPECT_THAT(read_light_field(folder / "a.npz").error().text(), HasSubstr("events, gain"));
  EXPECT_EQ(detect_kind(folder / "a.npz").error().code, ErrorCode::kUnsupported);
}

TEST(DetectKind, SaysWhatIsNoLightField) {
  const TestFolder folder;
  EXPECT_EQ(detect_kind(folder / "nothing").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(detect_kind(folder.path()).error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(write_file(folder / "text", std::string("hello")).ok());
  EXPECT_EQ(detect_kind(folder / "text").error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(write_file(folder / "empty", std::string()).ok());
  EXPECT_EQ(read_light_field(folder / "empty").error().code, ErrorCode::kUnsupported);
}

TEST(RealData, LegoKnightsHasFullRangeGrey) {
  E2LF_REQUIRE_DATA("official/Lego_Knights");
  const LightField read = read_light_field(test_data("official/Lego_Knights")).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 512, 512, 1}));
  const auto [low, high] = std::minmax_element(read.data().begin(), read.data().end());
  EXPECT_EQ(*low, 17.0F / 255.0F);
  EXPECT_EQ(*high, 247.0F / 255.0F);
}

TEST(RealData, EverySceneHasItsSize) {
  E2LF_REQUIRE_DATA("lightfields");
  const std::map<std::string, std::pair<size_t, size_t>> scenes = {
      {"hci_cotton", {512, 512}},          {"hci_antinous", {512, 512}},    {"stf_chess_div2", {424, 240}},
      {"stf_jellybeans_div3", {256, 128}}, {"blender_shop_00", {468, 308}}, {"blender_shop_02", {468, 308}},
      {"blender_shop_11", {468, 308}},     {"blender_shop_20", {468, 308}}, {"blender_shop_22", {468, 308}},
      {"lytro_dino2067", {552, 383}},      {"lytro_toy", {625, 434}}};
  for (const auto& [name, size] : scenes) {
    const Result<LightField> read = read_light_field(test_data("lightfields") / name);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->shape(), (Shape{8, 8, size.second, size.first, 1})) << name;
  }
}

TEST(Npy, A13BooleansAreBlackAndWhite) {
  const TestFolder folder;
  NpyArray array = make_npy<uint8_t>({2, 2, 2, 3}, std::vector<uint8_t>(24, 1));
  array.type = "b1";
  ASSERT_TRUE(write_npy(folder / "mask.npy", array));
  ReadOptions all;
  all.views_y.count = all.views_x.count = 0;
  const auto read = read_light_field(folder / "mask.npy", all);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->at(1, 1, 1, 2), 1.0F);
  array.type = "u1";
  ASSERT_TRUE(write_npy(folder / "bytes.npy", array));
  const Error error = read_light_field(folder / "bytes.npy", all).error();
  EXPECT_EQ(error.option, "white");
  all.white = 1;
  EXPECT_EQ(read_light_field(folder / "bytes.npy", all)->at(0, 0, 0, 0), 1.0F);
}

TEST(Npy, A13A15WhatIsNotInTheRangeIsNamedWithIt) {
  const TestFolder folder;
  const auto error_of = [&](std::vector<float> values) {
    EXPECT_TRUE(write_npy(folder / "a.npy", make_npy<float>({1, 2, 1, 3, 1}, values)));
    ReadOptions all;
    all.views_y.count = all.views_x.count = 0;
    return read_light_field(folder / "a.npy", all).error();
  };
  const Error negative = error_of({-1, 0, 1, 0.5F, 0, 0});
  EXPECT_THAT(negative.text(), testing::AllOf(testing::HasSubstr("-1..1"), testing::HasSubstr("(x + 1) / 2")));
  EXPECT_EQ(negative.option, "");
  const Error words = error_of({0, 900, 1000, 0, 0, 0});
  EXPECT_THAT(words.text(), testing::AllOf(testing::HasSubstr("0..1000"), testing::HasSubstr("e.g. 1023")));
  EXPECT_EQ(words.option, "white");
  const Error nan = error_of({0, 0.5F, 1, 0, std::nanf(""), 0});
  EXPECT_THAT(nan.text(), testing::AllOf(testing::HasSubstr("NaN"), testing::HasSubstr("view column 1, y 0, x 1")));
  EXPECT_EQ(nan.option, "");
}

TEST(Npy, A13TransposedAxesAreRefused) {
  const TestFolder folder;
  ReadOptions keep;
  keep.views_y.count = keep.views_x.count = 0;
  ASSERT_TRUE(write_npy(folder / "t.npy", make_npy<uint8_t>({48, 64, 9, 9}, std::vector<uint8_t>(48 * 64 * 81, 9))));
  EXPECT_EQ(read_light_field(folder / "t.npy", keep).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::lightfield
