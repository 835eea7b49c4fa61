// SPDX-License-Identifier: MIT
#include "e2lf/model/composition.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "e2lf/engine/engine.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/geometry/operations.h"
#include "testing/test_files.h"

namespace e2lf::geometry {
namespace {

using model::InputKind, model::Layer, model::Model;

constexpr size_t kHeight = 48, kWidth = 64;

Model model_of_two_patterns(const std::string& name, std::vector<model::InputGroup> input) {
  add_operations();
  Model model;
  model.name = name;
  model.num_patterns = 2;
  model.views_y = 1;
  model.views_x = 3;
  model.codes = capture::Codes(2, 1, 3);
  model.codes->values = {0, 0, 0, 1, 0, 1};
  model.input = std::move(input);
  model.network.input_channels = num_input_channels(model.input, model.num_patterns);
  return model;
}

/// A network whose three views are its input.
Model equal_views() {
  Model model = model_of_two_patterns("views", {{InputKind::kCounts, 1.0F}});
  model.network.layers = {{.name = "views", .inputs = {"input"}, .out_channels = 3}};
  model.weights = {{"views.weight", {1, 1, 1}}, {"views.bias", {0, 0, 0}}};
  return model;
}

/// A network whose disparity is `constant` plus `slope` times the level, and whose logarithm of the scale is -1.
Model known_disparity(float constant, float slope = 0.0F) {
  Model model = model_of_two_patterns("disparity", {{InputKind::kCounts, 1.0F}, {InputKind::kLevel, 1.0F}});
  model.network.layers = {{.name = "head", .inputs = {"input"}, .out_channels = 8, .kernel = 2, .stride = 2},
                          {.name = "output", .op = GeometryOp::kPixelShuffle, .inputs = {"head"}, .stride = 2}};
  std::vector<float>& weight = model.weights["head.weight"];
  weight.assign(size_t{8} * 2 * 4, 0.0F);
  for (size_t pixel = 0; pixel < 4; ++pixel) weight[(pixel * 2 + 1) * 4 + pixel] = slope;
  model.weights["head.bias"] = {constant, constant, constant, constant, -1, -1, -1, -1};
  return model;
}

std::vector<float> run(const Model& model, const std::vector<float>& input, size_t channels) {
  const auto valid = validate(model, model.name);
  EXPECT_TRUE(valid) << valid.error().text();
  std::vector<float> output(channels * kHeight * kWidth);
  const auto engine = engine::Engine::create(model.network, model.weights, {});
  EXPECT_TRUE(engine && engine->run(input, kHeight, kWidth, output));
  return output;
}

/// Two input channels of kHeight x kWidth px: value(x) and zeros.
template <typename Value>
std::vector<float> plane_of(const Value& value) {
  std::vector<float> input(2 * kHeight * kWidth);
  for (size_t i = 0; i < kHeight * kWidth; ++i) input[i] = value(static_cast<double>(i % kWidth));
  return input;
}

size_t center_of(size_t channel) {
  return (channel * kHeight + kHeight / 2) * kWidth + kWidth / 2;
}

TEST(TwoScales, AverageTheDisparityAndTheLogarithmOfItsScale) {
  constexpr float kShare = 0.75F;
  const auto both = at_two_scales(known_disparity(0.4F, 2.0F), kShare);
  ASSERT_TRUE(both) << both.error().text();
  std::vector<float> input = plane_of([](double) { return 0.0F; });
  for (size_t i = 0; i < kHeight * kWidth; ++i) input[kHeight * kWidth + i] = 0.3F;  // the level
  const std::vector<float> output = run(*both, input, 2);
  // A constant of the half scale is doubled, as the means over 2x2 px have half of the disparity.
  EXPECT_NEAR(output[center_of(0)], (0.4F + 0.6F) * (kShare + 2 * (1 - kShare)), 1e-6);
  EXPECT_NEAR(output[center_of(1)], -1 + (1 - kShare) * std::numbers::ln2, 1e-6);
  EXPECT_EQ(at_two_scales(known_disparity(0), 1.5F).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(at_two_scales(equal_views(), 0.5F).error().code, ErrorCode::kInvalidValue);
}

TEST(Guided, MovesTheViewsOfWeakTextureByTheDisparity) {
  constexpr float kDisparity = 2.0F;
  const auto model = guided(equal_views(), known_disparity(kDisparity), {});
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->provenance.at("guided_by"), "disparity");
  const auto wave = [](double x) { return static_cast<float>(0.5 + 0.004 * std::sin(x * std::numbers::pi / 8)); };
  const std::vector<float> output = run(*model, plane_of(wave), 3);
  for (size_t view = 0; view < 3; ++view) {
    const double x = kWidth / 2.0 - (static_cast<double>(view) - 1) * double{kDisparity};
    EXPECT_NEAR(output[center_of(view)], wave(x), 3e-4) << view;
  }
}

TEST(Guided, LeavesTheViewsOfStrongTextureAsTheyAre) {
  const auto model = guided(equal_views(), known_disparity(2.0F), {.weak_texture = 0.01F});
  const auto stripes = [](double x) { return static_cast<size_t>(x) % 4 < 2 ? 0.3F : 0.7F; };
  const std::vector<float> output = run(*model, plane_of(stripes), 3);
  for (size_t view = 0; view < 3; ++view) EXPECT_NEAR(output[center_of(view)], stripes(kWidth / 2.0), 1e-5) << view;
}

/// A network whose disparity is the fourth condition, the noise, and which reads the last `groups` inputs beside them.
Model disparity_of_noise(size_t groups) {
  Model disparity = known_disparity(0.0F);
  disparity.input.erase(disparity.input.begin(), disparity.input.end() - static_cast<ptrdiff_t>(groups));
  disparity.input.push_back({InputKind::kCamera, 1.0F});
  const size_t noise = groups + 3, channels = groups + num_input_channels(InputKind::kCamera, 2);
  disparity.network.input_channels = channels;
  std::vector<float> weight(8 * channels * 4, 0.0F);
  for (size_t pixel = 0; pixel < 4; ++pixel) weight[(pixel * channels + noise) * 4 + pixel] = 1.0F;
  disparity.weights["head.weight"] = weight;
  return disparity;
}

TEST(Guided, BuildsThePapersSensorIntoADisparityThatIsConditionedOnTheCamera) {
  // The conditions state a noise of 0.175 in units of 0.1; the disparity is therefore 1.75.
  const auto known = guided(equal_views(), known_disparity(1.75F), {});
  const auto wave = [](double x) { return static_cast<float>(0.5 + 0.004 * std::sin(x * std::numbers::pi / 8)); };
  const std::vector<float> input = plane_of(wave), expected = run(*known, input, 3);
  for (const size_t groups : {2, 1}) {  // as many inputs as the views, and fewer
    const auto with_paper = guided(equal_views(), disparity_of_noise(groups), {});
    ASSERT_TRUE(with_paper) << with_paper.error().text();
    EXPECT_FALSE(is_conditioned_on_camera(*with_paper));
    const std::vector<float> output = run(*with_paper, input, 3);
    for (size_t view = 0; view < 3; ++view) EXPECT_NEAR(output[center_of(view)], expected[center_of(view)], 1e-6);
  }
}

TEST(Guided, RefusesNetworksThatDoNotFitTogether) {
  Model of_others = known_disparity(0);
  of_others.codes->values = {0, 0, 0, 1, 1, 0};
  Model of_other_scale = known_disparity(0), in_other_order = known_disparity(0);
  of_other_scale.input.front().scale = 2.0F;
  std::swap(in_other_order.input[0], in_other_order.input[1]);
  for (const Model& disparity : {of_others, of_other_scale, in_other_order, equal_views()}) {
    EXPECT_EQ(guided(equal_views(), disparity, {}).error().code, ErrorCode::kInvalidValue);
  }
  EXPECT_EQ(guided(known_disparity(0), known_disparity(0), {}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(guided(equal_views(), known_disparity(0), {.weak_texture = 0}).error().code, ErrorCode::kInvalidValue);
}

/// Writes a file of a composed model.
void write_composed(const TestFolder& folder, const std::string& name, const Json& composed_of) {
  Safetensors file;
  file.metadata["e2lf"] = Json({{"format_version", 1}, {"name", name}, {"composed_of", composed_of}}).dump();
  ASSERT_TRUE(write_safetensors(folder / (name + ".safetensors"), file));
}

/// Writes a model with another share of the full scale.
void write_with_share(const TestFolder& folder, const Model& model, const Json& share) {
  const auto path = folder / (model.name + ".safetensors");
  ASSERT_TRUE(write_model(path, model));
  Safetensors file = *read_safetensors(path);
  Json header = Json::parse(file.metadata.at("e2lf"));
  header["share_of_full_scale"] = share;
  file.metadata["e2lf"] = header.dump();
  ASSERT_TRUE(write_safetensors(path, file));
}

TEST(ComposedFile, IsComposedOfThePartsBesideIt) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(folder / "views.safetensors", equal_views()));
  write_with_share(folder, known_disparity(0.5F, 1.0F), 0.75);
  write_composed(folder, "both", {{"views", "views"}, {"disparity", "disparity"}, {"share_of_full_scale", 0.25}});
  const auto read = model::read_model(folder / "both.safetensors");
  ASSERT_TRUE(read) << read.error().text();
  const auto expected = guided(equal_views(), *at_two_scales(known_disparity(0.5F, 1.0F), 0.25F), {});
  EXPECT_EQ(read->name, "both");
  EXPECT_EQ(read->network, expected->network);
  EXPECT_EQ(read->weights, expected->weights);
  EXPECT_EQ(read->codes, equal_views().codes);
  EXPECT_EQ(read->parts, (std::vector{folder / "views.safetensors", folder / "disparity.safetensors"}));
  // What is read is written as one file that needs no parts.
  ASSERT_TRUE(write_model(folder / "alone.safetensors", *read));
  const auto alone = model::read_model(folder / "alone.safetensors");
  EXPECT_EQ(alone->network, read->network);
  EXPECT_TRUE(alone->parts.empty());
}

TEST(ComposedFile, WaitsForPatternsIfItsViewsStateNone) {
  const TestFolder folder;
  Model views = equal_views(), disparity = known_disparity(0.5F);
  views.codes.reset();
  ASSERT_TRUE(write_model(folder / "views.safetensors", views));
  ASSERT_TRUE(write_model(folder / "disparity.safetensors", disparity));
  write_composed(folder, "both", {{"views", "views"}, {"disparity", "disparity"}});
  const auto fixed = model::read_model(folder / "both.safetensors");
  ASSERT_TRUE(fixed) << fixed.error().text();
  EXPECT_TRUE(fixed->open_guide && !fixed->codes);
  // Two networks for the same camera, whose patterns no file states, are composed at once.
  disparity.codes.reset();
  ASSERT_TRUE(write_model(folder / "disparity.safetensors", disparity));
  EXPECT_FALSE(model::read_model(folder / "both.safetensors").value().open_guide);
  disparity.codes = equal_views().codes;
  disparity.any_patterns["stem.bias"] = {{1}, {0.0F}};
  ASSERT_TRUE(write_model(folder / "disparity.safetensors", disparity));
  write_composed(folder, "both", {{"views", "views"}, {"disparity", "disparity"}, {"weak_texture", 0.02}});
  const auto read = model::read_model(folder / "both.safetensors");
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_TRUE(read->open_guide);
  EXPECT_EQ(read->open_guide->guide.weak_texture, 0.02F);
  EXPECT_EQ(read->open_guide->disparity.name, "disparity");
  EXPECT_FALSE(read->codes);
  EXPECT_FALSE(write_model(folder / "alone.safetensors", *read));
  const auto stated = model::read_stated_model(folder / "disparity.safetensors");
  ASSERT_TRUE(stated) << stated.error().text();
  EXPECT_TRUE(stated->is_for_any_patterns);
  EXPECT_EQ(stated->model.codes, disparity.codes);
  EXPECT_EQ(stated->model.network, disparity.network);
  EXPECT_TRUE(model::read_stated_model(folder / "both.safetensors")->guide);
}

TEST(ComposedFile, NamesWhatIsMissingOrDoesNotFit) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(folder / "views.safetensors", equal_views()));
  ASSERT_TRUE(write_model(folder / "disparity.safetensors", known_disparity(0.5F)));
  const auto error_of = [&](const Json& composed_of) {
    write_composed(folder, "both", composed_of);
    return model::read_model(folder / "both.safetensors").error().code;
  };
  write_composed(folder, "other", {{"views", "views"}, {"disparity", "disparity"}});
  EXPECT_EQ(error_of({{"views", "views"}, {"disparity", "none"}}), ErrorCode::kNotFound);
  EXPECT_EQ(error_of({{"views", "../views"}, {"disparity", "disparity"}}), ErrorCode::kNotFound);
  EXPECT_EQ(error_of({{"views", "both"}, {"disparity", "disparity"}}), ErrorCode::kUnsupported);
  EXPECT_EQ(error_of({{"views", "other"}, {"disparity", "disparity"}}), ErrorCode::kUnsupported);
  EXPECT_EQ(error_of({{"views", "disparity"}, {"disparity", "views"}}), ErrorCode::kInvalidValue);
  EXPECT_EQ(error_of({{"views", "views"}, {"disparity", "disparity"}, {"limit", 1}}), ErrorCode::kInvalidValue);
  EXPECT_EQ(error_of({{"views", "views"}, {"disparity", "disparity"}, {"share_of_full_scale", 0.5}}),
            ErrorCode::kFormat);
  write_with_share(folder, known_disparity(0.5F), "much");
  EXPECT_EQ(model::read_model(folder / "disparity.safetensors").error().code, ErrorCode::kFormat);
}

}  // namespace
}  // namespace e2lf::geometry
