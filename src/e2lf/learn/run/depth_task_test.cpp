// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <torch/torch.h>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/run/task.h"
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
  config.data.synthetic_share = 1;
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
  const StepLoss found = depth_loss(output, torch::zeros({1, 1, 2}));
  const double exact = std::log(0.5), wrong = 0.4 / 0.5 + std::log(0.5) + 0.05 * 0.4 + 0.5 * 0.4 / 0.6;
  EXPECT_NEAR(found.loss.item<double>(), 0.5 * (exact + wrong), 1e-6);
  EXPECT_DOUBLE_EQ(found.figure.item<double>(), 0.5);
  auto half_known = torch::zeros({1, 1, 2});
  half_known[0][0][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NEAR(depth_loss(output, half_known).loss.item<double>(), exact, 1e-6);
  EXPECT_EQ(depth_loss(output, half_known / 0).loss.item<double>(), 0.0) << "nothing is known";
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

/// A ramp, whose views move by 1 px per view step: the scaled part moves by as much of its own slope.
TEST(ScaledParts, HaveDisparitiesOfTheirOwnScale) {
  constexpr int64_t kHeight = 40, kWidth = 60, kPart = 30;
  const auto column = torch::arange(64).remainder(8).reshape({64, 1, 1}) - 4;
  const auto ramp = 2 * (torch::arange(kWidth) - column) + 60;
  const Scene scene{"ramp", ramp.expand({64, kHeight, kWidth}).to(torch::kByte), torch::ones({4, kHeight, kWidth})};
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Draws draws(seed, 0);
    const KnownScene part = scaled_part(scene, kPart, draws);
    ASSERT_EQ(part.views.sizes(), (at::IntArrayRef{64, kPart, kPart}));
    ASSERT_EQ(part.disparity.sizes(), (at::IntArrayRef{4, kPart, kPart}));
    const auto at = [&](int64_t view, int64_t x) { return part.views[view][15][x].item<double>(); };
    const double slope = (at(36, 25) - at(36, 5)) / 20, moved = (at(32, 15) - at(39, 15)) / 7;
    EXPECT_NEAR(part.disparity[3][0][0].item<double>(), moved / slope, 0.05 * moved / slope);
    EXPECT_GE(part.disparity.min().item<double>(), 0.7);
    EXPECT_LE(part.disparity.max().item<double>(), 2.0 + 0.1);
  }
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

/// A packed file with scenes whose disparities are all known, known for view (4, 4), and not known.
std::filesystem::path pack_known_scenes(const std::filesystem::path& folder) {
  Safetensors file;
  const std::vector<uint8_t> views(64 * 48 * 64, 100);
  std::vector<float> maps(4 * 48 * 64, 0.25F);
  for (const char* scene : {"all", "one", "none"}) {
    file.tensors[cat("lightfield/", scene)] = make_npy<uint8_t>({8, 8, 48, 64}, views);
  }
  file.tensors["disparity/all"] = make_npy<float>({4, 48, 64}, maps);
  std::fill_n(maps.begin(), 3 * 48 * 64, std::numeric_limits<float>::quiet_NaN());
  file.tensors["disparity/one"] = make_npy<float>({4, 48, 64}, maps);
  EXPECT_TRUE(write_safetensors(folder / "packed.safetensors", file));
  return folder / "packed.safetensors";
}

class DepthRun : public testing::Test {
 protected:
  DepthRun() { std::filesystem::create_directories(folder_); }
  ~DepthRun() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / cat("e2lf_depth_run_", ::getpid());
};

TEST_F(DepthRun, TrainsOnRealScenesAndJudgesSeveralSetsWithBothSensors) {
  Config config = depth_config();
  config.data.file = pack_known_scenes(folder_).string();
  config.data.synthetic_share = 0;
  config.data.validation = {"one"};
  config.patterns.evaluated = {"e2lf-n4", "e2lf-n8"};
  config.train.steps = config.train.evaluate_steps = 2;
  auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer) << trainer.error().text();
  ASSERT_TRUE(trainer->run(folder_)) << "the constant disparity of real scenes";
  const auto bytes = read_file(folder_ / "evaluation.csv").value();
  const std::string rows(bytes.begin(), bytes.end());
  for (const char* name : {"one:e2lf-n4", "one:e2lf-n8", "one:e2lf-n4@evk4-lcos", "one:e2lf-n8@evk4-lcos", "mean"}) {
    EXPECT_NE(rows.find(cat(",", name, ",")), std::string::npos) << name << ": " << rows;
  }
  EXPECT_EQ(trainer->evaluate({"none"}, {}).error().code, ErrorCode::kNotFound);
  config.data.exclude = {"all"};
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << "no scene is left";
}

TEST(DepthBatchesOfFixedPatterns, AllHaveThoseOfTheConfiguration) {
  Config config = depth_config();
  config.patterns.drawn = false;
  const capture::Codes codes = capture::whole_cycle(capture::default_codes());
  auto batches = DepthBatches::create(config, codes, {}, torch::kCPU);
  ASSERT_TRUE(batches) << batches.error().text();
  const DepthBatch batch = batches->at(0);
  EXPECT_EQ(batch.codes, std::vector(config.train.batch, codes));
  EXPECT_EQ(batch.events.size(1), static_cast<int64_t>(codes.num_patterns) - 1);
}

TEST(DepthTraining, StartsFromNetworksOnEventsOfAnyPatternsAlone) {
  Config config = depth_config();
  for (const char* start : {"e2lf-n4-depth", "e2lf-depth"}) {
    config.start = start;
    EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << start;
  }
}

/// Of the networks for the patterns of e2lf-n4, at a smaller size.
TEST(DepthTraining, ConfigurationsOfFixedPatternsGiveModelsForThem) {
  for (const char* name : {"e2lf-n4-depth", "e2lf-n4-cycle-depth"}) {
    const auto path = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / cat(name, ".json");
    auto config = config_from_json(read_json(path).value(), path.string());
    ASSERT_TRUE(config) << config.error().text();
    const Config small = depth_config();
    config->network.widths = small.network.widths;
    config->network.blocks = small.network.blocks;
    config->data = small.data;
    config->train = small.train;
    config->start = "";
    auto trainer = Trainer::create(*config);
    ASSERT_TRUE(trainer) << trainer.error().text();
    ASSERT_TRUE(trainer->train_step());
    const auto model = trainer->to_model();
    ASSERT_TRUE(model) << model.error().text();
    const auto bundled = model::read_model(*bundled_file_named(kBundledModels, name)).value();
    EXPECT_EQ(model->name, name);
    EXPECT_EQ(model->codes, bundled.codes);
    EXPECT_EQ(model->num_patterns, bundled.num_patterns);
  }
}

TEST(DepthTraining, ItsConfigurationGivesTheLayersOfTheBundledNetwork) {
  geometry::add_operations();
  const auto path = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / "e2lf-depth-first.json";
  const auto config = config_from_json(read_json(path).value(), path.string());
  ASSERT_TRUE(config) << config.error().text();
  EXPECT_TRUE(config->network.gives_disparity());
  const auto bundled = model::read_model(*bundled_file_named(kBundledModels, "e2lf-depth-first")).value();
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
    config.start = is_trained ? "e2lf-depth-first" : "";
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
