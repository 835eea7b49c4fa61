// SPDX-License-Identifier: MIT
#include "e2lf/video/video_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/files/safetensors.h"
#include "testing/test_files.h"
#include "testing/video_networks.h"

namespace e2lf::video {
namespace {

using namespace model;
using testing::HasSubstr;

VideoModel small_video_model() {
  VideoModel model;
  model.name = "small";
  model.bins = 3;
  model.normalises_voxels = true;
  model.pad_multiple = 4;
  model.tone = FrameTone::kExpRobust;
  model.network = {
      3,
      {engine::conv("half", "input", 4, 5, true, "", 2), cell("cell", VideoOp::kConvGru, "half", 4, 3),
       cell("other", VideoOp::kConvLstm, "cell", 4, 3), engine::reshape("up", VideoOp::kUpsampleBilinear, {"other"}, 2),
       engine::conv("out", "up", 1, 1, false), engine::reshape("last", VideoOp::kSigmoid, {"out"})}};
  model.weights = engine::random_weights(model.network, 1);
  model.provenance = {{"seed", 7}};
  return model;
}

/// Writes the small model with its JSON changed and reads it again.
template <typename Change>
Error video_error_after(const Change& change) {
  const TestFolder folder;
  EXPECT_TRUE(write_video_model(folder / "m.safetensors", small_video_model()).ok());
  Safetensors file = *read_safetensors(folder / "m.safetensors");
  Json json = Json::parse(file.metadata.at("e2lf"));
  change(json);
  file.metadata["e2lf"] = json.dump();
  EXPECT_TRUE(write_safetensors(folder / "m.safetensors", file).ok());
  const auto model = read_video_model(folder / "m.safetensors");
  EXPECT_FALSE(model.ok());
  return model.ok() ? Error{} : model.error();
}

TEST(VideoModelFile, RoundTripsEveryField) {
  const TestFolder folder;
  const VideoModel model = small_video_model();
  ASSERT_TRUE(write_video_model(folder / "m.safetensors", model).ok());
  const auto read = read_video_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->name, model.name);
  EXPECT_EQ(read->bins, model.bins);
  EXPECT_EQ(read->normalises_voxels, model.normalises_voxels);
  EXPECT_EQ(read->pad_multiple, model.pad_multiple);
  EXPECT_EQ(read->tone, model.tone);
  EXPECT_EQ(read->network, model.network);
  EXPECT_EQ(read->weights, model.weights);
  EXPECT_EQ(read->provenance, model.provenance);
  EXPECT_TRUE(*is_video_model(folder / "m.safetensors"));
}

TEST(VideoModelFile, IsNoModelOfLightFields) {
  const TestFolder folder;
  ASSERT_TRUE(write_video_model(folder / "m.safetensors", small_video_model()).ok());
  const auto model = read_model(folder / "m.safetensors");
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(model.error().message, HasSubstr("`e2lf video`"));
  EXPECT_THAT(video_error_after([](Json& json) { json.erase("measurement"); }).message,
              HasSubstr("`e2lf reconstruct`"));
  EXPECT_THAT(video_error_after([](Json& json) { json["measurement"] = "spikes"; }).message, HasSubstr("voxel-grid"));
}

TEST(VideoModelFile, RefusesFieldsThatDoNotFit) {
  EXPECT_THAT(video_error_after([](Json& json) { json["bins"] = 4; }).message, HasSubstr("4 time bins"));
  EXPECT_THAT(video_error_after([](Json& json) { json["pad_multiple"] = 3; }).location, HasSubstr("pad_multiple"));
  EXPECT_THAT(video_error_after([](Json& json) { json["tone"] = "bright"; }).message, HasSubstr("exp-robust"));
  EXPECT_EQ(video_error_after([](Json& json) { json["format_version"] = 2; }).code, ErrorCode::kUnsupported);
  EXPECT_THAT(video_error_after([](Json& json) { json["binz"] = 2; }).location, HasSubstr("binz"));
  EXPECT_THAT(video_error_after([](Json& json) { json["network"]["layers"][1]["relu"] = true; }).message,
              HasSubstr("ReLU"));
  EXPECT_THAT(video_error_after([](Json& json) { json["network"]["layers"][1]["stride"] = 2; }).message,
              HasSubstr("stride 1"));
}

TEST(VideoModelFile, AModelOfLightFieldsRemembersNothing) {
  Model model;
  model.num_patterns = 4;
  model.views_y = model.views_x = 1;
  model.input = {{InputKind::kCounts, 1.0F}};
  model.network = {3, {cell("cell", VideoOp::kConvGru, "input", 1, 3)}};
  model.weights = engine::random_weights(model.network, 1);
  const auto valid = validate(model, "m");
  ASSERT_FALSE(valid.ok());
  EXPECT_THAT(valid.error().message, HasSubstr("previous frame"));
}

TEST(VideoModelSummary, HasTheFiguresOfFireNet) {
  VideoModel model;
  model.network = {5,
                   {engine::conv("head", "input", 16, 3), cell("cell1", VideoOp::kConvGru, "head", 16, 3),
                    engine::conv("a", "cell1", 16, 3), engine::conv("b", "a", 16, 3, true, "cell1"),
                    cell("cell2", VideoOp::kConvGru, "b", 16, 3), engine::conv("c", "cell2", 16, 3),
                    engine::conv("d", "c", 16, 3, true, "cell2"), engine::conv("out", "d", 1, 1, false)}};
  EXPECT_EQ(num_parameters(model.network), 37777U);
  EXPECT_EQ(macs_per_pixel(model.network), 5 * 16 * 9 + 2 * 3 * 32 * 16 * 9 + 4 * 16 * 16 * 9 + 16);
  EXPECT_EQ(receptive_radius(model.network), 9U);
}

TEST(NetworkCost, StridedConvolutionsAndBilinearSamplesReachBeyondTheirBlock) {
  const Network network{
      1, {engine::conv("a", "input", 1, 5, false, "", 2), engine::reshape("up", VideoOp::kUpsampleBilinear, {"a"}, 2)}};
  // Output pixel 0 sees coarse pixels 0 and -1; that one sees input pixels -4 to 0. Pixel 1: 0 and 1, up to 4.
  EXPECT_EQ(receptive_radius(network), 2U + 1U + 2U + 1U);
}

}  // namespace
}  // namespace e2lf::video
