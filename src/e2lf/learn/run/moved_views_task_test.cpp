// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <torch/torch.h>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

constexpr int64_t kSide = 64;

Config small_config() {
  Config config;
  config.name = "views";
  config.network = {{.widths = {8, 12}, .blocks = {1, 1}, .head_width = 4}};
  config.network.weak_texture = 0.02;
  config.input = {{model::InputKind::kMoved, 1.0F}};
  config.patterns.codes = "e2lf-n4";
  config.patterns.known = {"e2lf-n4", "e2lf-n8"};
  config.sensor.camera = "evk4-lcos";
  config.sensor.cycles_share = 0.3;
  config.data.synthesiser.size = kSide;
  config.data.synthetic_share = 1;
  config.data.pool = 16;
  config.train.patch = kSide;
  config.train.batch = 2;
  config.train.optimiser = "adam";
  config.train.warmup_steps = 2;
  config.train.learning_rate = 2e-3;
  config.train.clip_norm = 1;
  config.train.centred = false;
  return config;
}

model::Model bundled(const std::string& name) {
  geometry::add_operations();
  return model::read_model(*bundled_file_named(kBundledModels, name)).value();
}

torch::Tensor output_of(const model::Model& model, const torch::Tensor& input) {
  const NetworkModule module(model.network, torch::kCPU);
  EXPECT_TRUE(load_weights(module.parameters(), model.weights, model.name));
  return module.forward(input, torch::kFloat);
}

TEST(MovedPlanes, AreThoseOfTheComposedNetwork) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(7);
  constexpr int64_t kTwoScales = 128;                                   // px, of which half is what one scale needs
  const capture::Codes patterns = read_pattern_set("e2lf-n8").value();  // whose pictures share the places
  const model::Model disparity = geometry::for_patterns(bundled("e2lf-depth-first"), patterns).value();
  const int64_t transitions = 7;
  DepthInputs inputs{torch::randn({1, 3, transitions, kTwoScales, kTwoScales}),
                     torch::rand({1, static_cast<int64_t>(capture::conditioning_size(8))}) - 0.5,
                     torch::full({1, kTwoScales, kTwoScales}, 0.4)};
  inputs.conditioning.select(1, capture::kCyclesCondition).fill_(0.4);
  const auto camera = inputs.conditioning.unsqueeze(2).unsqueeze(3).expand({-1, -1, kTwoScales, kTwoScales});
  const auto channels = torch::cat({inputs.groups.flatten(1, 2), camera}, 1);

  const auto map = output_of(disparity, channels);
  const auto input = geometry::moved_input(patterns, disparity.input);
  ASSERT_TRUE(input) << input.error().text();
  const NetworkModule of_views(make_network(small_config()), torch::kCPU);
  const auto expected = of_views.forward(moved_planes(inputs, map, {*input}), torch::kFloat);

  model::Model views;
  views.name = "views";
  views.num_patterns = 4;
  views.input = {{model::InputKind::kMoved, 1.0F}};
  views.network = of_views.network();
  views.weights = to_weights(of_views.parameters());
  auto composed = geometry::composed_for_patterns(views, disparity, patterns);
  ASSERT_TRUE(composed) << composed.error().text();
  auto& layers = composed->network.layers;  // without those that follow the disparity
  layers.erase(std::ranges::find(layers, "views_output", &model::Layer::name) + 1, layers.end());
  EXPECT_LT((output_of(*composed, channels) - expected).abs().max().item<float>(),
            1e-4F * expected.abs().max().item<float>());
}

/// With the patterns of e2lf-n4, the first planes are what the network for these patterns reads, so that it is a start.
TEST(MovedPlanes, LetANetworkForE2lfN4StartAsItIs) {
  Config config = small_config();
  config.network = {};
  config.network.head_blocks = 4;
  config.network.widths = {80, 96, 128};
  config.network.blocks = {2, 2, 2};
  config.sensor.camera = "";
  config.sensor.cycles_share = 0;
  config.start = "e2lf-n4-camera";
  const auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer) << trainer.error().text();
  const auto scores = trainer->evaluate({"synthesised 1"}, trainer->cameras().front());
  ASSERT_TRUE(scores) << scores.error().text();
  Config untrained = config;
  untrained.start = "";
  const auto other = Trainer::create(untrained)->evaluate({"synthesised 1"}, trainer->cameras().front());
  EXPECT_GT(scores->front().score, other->front().score + 8);
}

Config small_depth_config() {
  Config config = small_config();
  config.name = "depth";
  config.network = {{.widths = {8, 12}, .blocks = {1, 1}}, "plane-sweep"};
  return config;
}

/// With the patterns of e2lf-n4, the network for these starts as it is.
TEST(MovedPlanes, LetADisparityOfE2lfN4StartAsItIs) {
  Config config = small_depth_config();
  config.network.widths = {40, 64, 88, 112, 128, 128};
  config.network.blocks.assign(6, 1);
  config.data.synthesiser.size = config.train.patch = 128;
  double score[2] = {};
  for (const bool is_trained : {false, true}) {
    config.start = is_trained ? "e2lf-n4-depth" : "";
    const auto trainer = Trainer::create(config);
    ASSERT_TRUE(trainer) << trainer.error().text();
    for (const char* scene : {"synthesised 1", "synthesised 2"}) {
      const auto scores = trainer->evaluate({scene}, trainer->cameras().front());
      ASSERT_TRUE(scores) << scores.error().text();
      score[is_trained ? 1 : 0] += scores->front().score / 2;
    }
  }
  EXPECT_LT(score[1], 0.8 * score[0]);
}

class MovedViewsRun : public testing::Test {
 protected:
  MovedViewsRun() { std::filesystem::create_directories(folder_); }
  ~MovedViewsRun() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / cat("e2lf_moved_views_run_", ::getpid());
};

TEST_F(MovedViewsRun, ResumesBitExactlyAndStoresAModelThatNamesItsDisparity) {
  for (const Config& config : {small_config(), small_depth_config()}) {
    auto whole = Trainer::create(config);
    ASSERT_TRUE(whole) << whole.error().text();
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(whole->train_step());
    auto first = Trainer::create(config), resumed = Trainer::create(config);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(first->train_step());
    ASSERT_TRUE(first->save_checkpoint(folder_ / "checkpoint"));
    ASSERT_TRUE(resumed->load_checkpoint(folder_ / "checkpoint"));
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(resumed->train_step());
    for (const auto& [name, tensor] : whole->parameters()) {
      EXPECT_TRUE(torch::equal(tensor, resumed->parameters().at(name))) << name;
    }
    const auto model = whole->to_model();
    ASSERT_TRUE(model) << model.error().text();
    ASSERT_TRUE(model::write_model(folder_ / "own.safetensors", *model));
    const auto read = model::read_model(folder_ / "own.safetensors");
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_TRUE(model::reads_moved_pictures(*read));
    EXPECT_EQ(model::is_depth_network(*read), config.network.gives_disparity());
    EXPECT_EQ(read->weights, model->weights);
    EXPECT_EQ(read->open_guide->guide.weak_texture, static_cast<float>(config.network.weak_texture));
    EXPECT_EQ(read->parts, std::vector{*bundled_file_named(kBundledModels, "e2lf-depth-first")});
    EXPECT_TRUE(geometry::for_patterns(*read, *bundled("e2lf-n4").codes));
  }
}

TEST_F(MovedViewsRun, JudgesTheViewsOfSeveralSetsWithBothSensors) {
  Config config = small_config();
  config.patterns.evaluated = {"e2lf-n4", "e2lf-n8"};
  config.train.steps = config.train.evaluate_steps = 1;
  auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer) << trainer.error().text();
  ASSERT_TRUE(trainer->run(folder_));
  const auto bytes = read_file(folder_ / "evaluation.csv").value();
  const std::string rows(bytes.begin(), bytes.end());
  for (const char* name : {":e2lf-n4,", ":e2lf-n8,", ":e2lf-n4@evk4-lcos,", ":e2lf-n8@evk4-lcos,", "mean,"}) {
    EXPECT_NE(rows.find(name), std::string::npos) << name << ": " << rows;
  }
}

TEST(MovedViewsTraining, RefusesWhatItCannotTrain) {
  Config config = small_config();
  for (const char* start : {"e2lf-depth-first", "e2lf-depth", "e2lf-n4-depth", "e2lf-n8-camera"}) {
    config.start = start;
    EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << start;
  }
  config = small_depth_config();
  for (const char* start : {"e2lf-any", "e2lf-n4-camera"}) {
    config.start = start;
    EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << start;
  }
  config = small_config();
  for (const char* disparity : {"e2lf-n4", "e2lf-n4-depth", "e2lf-depth"}) {
    config.network.disparity = disparity;
    EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << disparity;
  }
  config = small_config();
  config.train.patch = config.data.synthesiser.size = 32;
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << "e2lf-depth-first takes multiples of 64";
}

/// The stored model states the name alone, which must not lead to another network.
TEST_F(MovedViewsRun, RefusesADisparityThatABundledModelWouldReplace) {
  const auto own = folder_ / "e2lf-depth-first.safetensors", renamed = folder_ / "own-depth.safetensors";
  for (const auto& path : {own, renamed}) {
    std::filesystem::copy_file(*bundled_file_named(kBundledModels, "e2lf-depth-first"), path);
    Config config = small_config();
    config.network.disparity = path.string();
    EXPECT_EQ(Trainer::create(config).ok(), path == renamed) << path;
  }
}

Config bundled_config(const std::string& name) {
  const auto path = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / (name + ".json");
  const auto config = config_from_json(read_json(path).value(), path.string());
  EXPECT_TRUE(config) << config.error().text();
  return *config;
}

TEST(MovedViewsTraining, ConfigurationsGiveTheLayersOfTheBundledNetworks) {
  for (const std::string name : {"e2lf-any", "e2lf-depth"}) {
    const Config config = bundled_config(name);
    const model::Model model = bundled(name);
    EXPECT_EQ(config.input, model.input);
    EXPECT_EQ(make_network(config), model.network) << name;
  }
}

TEST(MovedViewsTraining, TheBundledNetworkIsBetterThanAnUntrainedOne) {
  Config config = small_config();
  config.network = bundled_config("e2lf-any").network;
  double score[2] = {};
  for (const bool is_trained : {false, true}) {
    config.start = is_trained ? "e2lf-any" : "";
    const auto trainer = Trainer::create(config);
    ASSERT_TRUE(trainer) << trainer.error().text();
    for (const auto& camera : trainer->cameras()) {
      const auto scores = trainer->evaluate({"synthesised 1"}, camera);
      ASSERT_TRUE(scores) << scores.error().text();
      score[is_trained ? 1 : 0] += scores->front().score / 2;
    }
  }
  EXPECT_GT(score[1], score[0] + 3);
  RecordProperty("psnr_db", std::to_string(score[1]));
}

}  // namespace
}  // namespace e2lf::learn
