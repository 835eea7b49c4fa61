// SPDX-License-Identifier: MIT
#include "e2lf/view/document.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

namespace e2lf::view {
namespace {

TEST(Document, NamesCannotEndTheElementOfThePage) {
  Document document;
  document.add_item({{"name", "</script><script>alert(1)</script>"}});
  EXPECT_THAT(document.description(), testing::Not(testing::HasSubstr("<")));
  EXPECT_EQ(Json::parse(document.description())["items"][0]["name"], "</script><script>alert(1)</script>");
}

TEST(Document, NamesThatAreNoUtf8AreReplaced) {
  Document document;
  document.add_item({{"name", "caf\xE9"}});
  EXPECT_EQ(Json::parse(document.description())["items"][0]["name"], "caf\xEF\xBF\xBD");
}

TEST(Document, CountsComeBackFromTheirPart) {
  const std::vector<int16_t> counts = {0, 1, -1, INT16_MAX, INT16_MIN, 7};
  const auto bytes = counts_part(counts)();
  ASSERT_TRUE(bytes.ok());
  std::vector<int16_t> back(counts.size());
  uLongf size = 2 * back.size();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(back.data()), &size, bytes->data(), bytes->size()), Z_OK);
  EXPECT_EQ(size, 2 * back.size());
  EXPECT_EQ(back, counts);
}

TEST(Document, DisparitiesAreThousandthsWithTheirUsualRange) {
  Document document;
  document.add_item({{"kind", "light_field"}, {"height", 20}, {"width", 10}});
  lightfield::Image map(10, 20, 1);
  for (size_t i = 0; i < 200; ++i) map.pixels[i] = static_cast<float>(i) / 100.0F;
  map.pixels[3] = std::nanf("");
  map.pixels[199] = 100.0F;
  map.pixels[150] = -50.0F;
  lightfield::Image confidence(10, 20, 1);
  std::fill(confidence.pixels.begin(), confidence.pixels.end(), 1.0F);
  confidence.pixels[7] = 0.25F;
  confidence.pixels[150] = 0.01F;  // does not count for the range
  document.add_disparity(0, {{map}, {4, 3}, {confidence}});
  const Json disparity = Json::parse(document.description())["items"][0]["disparity"];
  EXPECT_EQ(disparity["view"], (Json{4, 3}));
  EXPECT_EQ(disparity["range"], (Json{0.01, 1.98}));
  const auto bytes = document.parts().at(disparity["maps"][0])();
  std::vector<int16_t> numbers(200);
  uLongf size = 400;
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(numbers.data()), &size, bytes->data(), bytes->size()), Z_OK);
  EXPECT_EQ(numbers[7], 70);
  EXPECT_EQ(numbers[3], -32768);
  EXPECT_EQ(numbers[199], 32000);
  const auto sure = document.parts().at(disparity["confidences"][0])();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(numbers.data()), &size, sure->data(), sure->size()), Z_OK);
  EXPECT_EQ(numbers[7], 250);
}

TEST(Document, CodesOfAnotherNumberOfPatternsAreLeftOut) {
  Document document;
  const capture::EventImages images(3, 2, 4);
  const capture::Codes fitting(4, 8, 8), other(5, 8, 8);
  document.add_event_images("a", {images}, &fitting);
  document.add_event_images("b", {images}, &other);
  const Json json = Json::parse(document.description());
  EXPECT_EQ(json["items"][0]["codes"]["patterns"].size(), 4U);
  EXPECT_FALSE(json["items"][1].contains("codes"));
  EXPECT_EQ(document.parts().size(), 2U);
}

TEST(Document, QualityIsThatOfEvalAsStoredAndWithTheBestTone) {
  const lightfield::Shape shape{1, 2, 4, 4, 1};
  lightfield::LightField truth(shape), reconstruction(shape);
  for (float& value : truth.view(0, 0)) value = 1.0F;
  for (float& value : reconstruction.view(0, 0)) value = 1.5F;   // clamped: equal
  for (float& value : reconstruction.view(0, 1)) value = 0.01F;  // an error of 1/100: 40 dB
  const Quality quality = quality_of(truth, reconstruction);
  EXPECT_TRUE(std::isinf(quality.psnr_db[0]));
  EXPECT_NEAR(quality.psnr_db[1], 40.0, 1e-4);
  // Two values of the truth for two of the reconstruction: a line fits both.
  EXPECT_NEAR(quality.tone.gain, 1 / 1.49, 1e-5);
  EXPECT_NEAR(quality.tone.black, 0.01, 1e-5);
  EXPECT_GT(quality.toned_psnr_db[0], 100);
  EXPECT_GT(quality.toned_psnr_db[1], 100);
}

TEST(Page, HasAPlaceForData) {
  EXPECT_NE(empty_page().find("<!--e2lf-data-->"), std::string_view::npos);
  EXPECT_EQ(empty_page().find("http"), std::string_view::npos) << "the page asks nobody for anything";
}

}  // namespace
}  // namespace e2lf::view
