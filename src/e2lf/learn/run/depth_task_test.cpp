// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/depth_task.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <numeric>
#include <torch/torch.h>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/pattern_draws.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

Config depth_config() {
  geometry::add_operations();  // of the bundled models
  Config config;
  config.name = "depth";
  config.network = {{.widths = {8, 12}, .blocks = {1, 1}}, "plane-sweep"};
  config.input = {{model::InputKind::kCumulative, 0.125F},
                  {model::InputKind::kLevel, 0.125F},
                  {model::InputKind::kIntensity, 4.0F},
                  {model::InputKind::kCamera, 1.0F}};
  config.patterns.codes = "e2lf-n4";
  config.patterns.known = {"e2lf-n4", "e2lf-n8"};
  config.sensor.camera = "evk4-lcos";
  config.sensor.cycles_share = 0.3;
  config.data.synthesiser.size = 32;
  config.data.pool = 16;
  config.train.patch = 32;
  config.train.batch = 4;
  config.train.warmup_steps = 2;
  config.train.learning_rate = 3e-3;
  config.train.clip_norm = 5;
  config.train.adam_decay = 0.99;
  config.train.centred = false;
  return config;
}

TEST(DepthLoss, IsThatOfALaplaceDistributionAndABoundedError) {
  const auto output = torch::zeros({1, 2, 1, 2});
  output[0][0][0][1] = 0.4;  // an error
  output[0][1].fill_(std::log(0.5));
  const DepthLoss found = depth_loss(output, torch::zeros({1, 1, 2}));
  const double exact = std::log(0.5), wrong = 0.4 / 0.5 + std::log(0.5) + 0.05 * 0.4 + 0.5 * 0.4 / 0.6;
  EXPECT_NEAR(found.loss.item<double>(), 0.5 * (exact + wrong), 1e-6);
  EXPECT_DOUBLE_EQ(found.share_off.item<double>(), 0.5);
}

TEST(DrawnPatterns, AreLitBehindBlackAndDiffer) {
  const std::vector<capture::Codes> known = {capture::default_codes()};
  size_t taken = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Draws draws(seed, 0), same(seed, 0);
    const capture::Codes codes = draw_patterns(3, known, draws);
    EXPECT_EQ(codes, draw_patterns(3, known, same));
    ASSERT_EQ(codes.num_patterns, 4U);
    EXPECT_TRUE(capture::is_black_first(codes));
    EXPECT_GE(*std::ranges::min_element(codes.values), 0.0F);
    EXPECT_LE(*std::ranges::max_element(codes.values), 1.0F);
    for (size_t n = 1; n < 4; ++n) {
      const auto pattern = codes.pattern(n);
      EXPECT_GT(std::accumulate(pattern.begin(), pattern.end(), 0.0F), 1.0F);
    }
    EXPECT_TRUE(describe_apertures({codes, capture::default_codes()}, torch::kCPU));
    if (codes == capture::default_codes()) ++taken;
  }
  // Half of the sequences are known, of which 0.6 keep their order, half are not turned, and a third is perfect.
  EXPECT_GT(taken, 3U);
  EXPECT_LT(taken, 40U);
}

/// Each view holds its own number, and each disparity the number of its view.
TEST(TransformedScenes, HaveTheDisparityOfTheViewThatTakesThePlace) {
  KnownScene scene{torch::empty({64, 3, 3}, torch::kByte), torch::empty({4, 3, 3})};
  for (int64_t view = 0; view < 64; ++view) scene.views[view].fill_(view);
  const int central[] = {27, 28, 35, 36};
  for (int64_t k = 0; k < 4; ++k) scene.disparity[k].fill_(central[k]);
  for (unsigned symmetry = 0; symmetry < 8; ++symmetry) {
    const auto [views, disparity] = transform_scene(scene, symmetry);
    EXPECT_EQ(views[36][0][0].item<int>(), disparity[0][0].item<int>()) << symmetry;
  }
  // Pixels move along.
  scene.views[36].copy_(torch::arange(9).reshape({3, 3}));
  scene.disparity[3].copy_(scene.views[36]);
  const auto [views, disparity] = transform_scene(scene, 4);
  EXPECT_TRUE(torch::equal(views[36].to(torch::kFloat), disparity));
}

/// Without noise, counts do not change from cycle to cycle, and each sample sees its own patterns.
TEST(SimulatedCycles, AreThoseOfEachSamplesPatterns) {
  torch::manual_seed(3);
  const auto views = torch::rand({2, 64, 8, 8});
  Draws draws(1, 0);
  const std::vector<capture::Codes> codes = {draw_patterns(3, {}, draws), draw_patterns(3, {}, draws)};
  const SampleConstants constants = repeat_constants({0.01F, 0.3F, 0.0F, 0.0F}, 2, torch::kCPU);
  auto cycles = torch::ones({2, 8, 8});
  cycles.slice(1, 4).fill_(4);
  const auto events = simulate_cycles(views, codes, constants, torch::zeros({2}), cycles);
  for (int64_t i = 0; i < 2; ++i) {
    const auto light = coded_intensities(views.narrow(0, i, 1), to_tensor(codes[static_cast<size_t>(i)], torch::kCPU));
    const auto noise = draw_noise(capture::MeasurementKind::kEventImages, 1, 4, 8, 8, torch::kCPU);
    const auto own = repeat_constants({0.01F, 0.3F, 0.0F, 0.0F}, 1, torch::kCPU);
    const auto expected = simulate_events(light, own, noise, EventModel::kReferenceAware);
    EXPECT_LE((events[i] != expected[0]).sum().item<int>(), 2) << "rounding at a threshold";
  }
}

TEST(DepthTraining, ResumesBitExactlyAndStoresAModelForAnyPatterns) {
  const Config config = depth_config();
  auto whole = Trainer::create(config);
  ASSERT_TRUE(whole) << whole.error().text();
  const auto folder = std::filesystem::path(testing::TempDir()) / cat("e2lf_depth_", ::getpid());
  std::filesystem::create_directories(folder);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(whole->train_step());
  auto first = Trainer::create(config), resumed = Trainer::create(config);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(first->train_step());
  ASSERT_TRUE(first->save_checkpoint(folder / "checkpoint"));
  ASSERT_TRUE(resumed->load_checkpoint(folder / "checkpoint"));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(resumed->train_step());
  for (const auto& [name, tensor] : whole->parameters()) {
    EXPECT_TRUE(torch::equal(tensor, resumed->parameters().at(name))) << name;
  }
  const auto model = whole->to_model();
  ASSERT_TRUE(model) << model.error().text();
  ASSERT_TRUE(model::write_model(folder / "depth.safetensors", *model));
  const auto read = model::read_model(folder / "depth.safetensors");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_TRUE(model::is_for_any_patterns(*read));
  EXPECT_TRUE(model::is_depth_network(*read));
  EXPECT_EQ(read->weights, model->weights);
  std::filesystem::remove_all(folder);
}

TEST(DepthTraining, ItsConfigurationGivesTheLayersOfTheBundledNetwork) {
  geometry::add_operations();
  const auto path = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / "e2lf-depth.json";
  const auto config = config_from_json(read_json(path).value(), path.string());
  ASSERT_TRUE(config) << config.error().text();
  EXPECT_TRUE(config->network.gives_disparity());
  const auto bundled = model::read_model(*bundled_file_named(kBundledModels, "e2lf-depth")).value();
  EXPECT_EQ(config->input, bundled.input);
  auto network = depth_network(config->network.widths, bundled.network.input_channels);
  network.layers.pop_back();  // the output, which takes the mean of two scales
  for (const model::Layer& layer : network.layers) {
    const auto found = std::ranges::find(bundled.network.layers, layer.name, &model::Layer::name);
    ASSERT_NE(found, bundled.network.layers.end()) << layer.name;
    model::Layer own = *found;
    if (layer.name == "sweep") own.attributes["offsets"] = layer.attributes.at("offsets");
    EXPECT_EQ(layer, own) << layer.name;
  }
}

/// The bundled network was trained on scenes, patterns and events of other programs.
TEST(DepthTraining, TheBundledNetworkIsRightMoreOftenThanAnUntrainedOne) {
  Config config = depth_config();
  config.network.widths = {40, 64, 88, 112, 128, 128};
  config.network.blocks.assign(6, 1);
  config.data.synthesiser.size = 128;
  config.train.patch = 128;
  double score[2] = {};
  for (const bool is_trained : {false, true}) {
    config.start = is_trained ? "e2lf-depth" : "";
    const auto trainer = Trainer::create(config);
    ASSERT_TRUE(trainer) << trainer.error().text();
    for (const auto& camera : trainer->cameras()) {
      for (const char* scene : {"synthesised 1", "synthesised 2"}) {
        const auto scores = trainer->evaluate({scene}, camera);
        ASSERT_TRUE(scores) << scores.error().text();
        EXPECT_GT(scores->front().events_per_pixel, 0.1);
        score[is_trained ? 1 : 0] += scores->front().score / 4;
      }
    }
  }
  EXPECT_LE(score[0], 100.0);
  EXPECT_LT(score[1], 0.8 * score[0]);
  RecordProperty("off_percent", std::to_string(score[1]));
}

}  // namespace
}  // namespace e2lf::learn
