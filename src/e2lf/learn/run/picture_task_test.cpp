// SPDX-License-Identifier: MIT
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
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

constexpr int64_t kSide = 64;

Config picture_config() {
  Config config;
  config.name = "picture";
  config.network = {{.widths = {8, 12}, .blocks = {1, 1}}, "picture"};
  config.input = {{model::InputKind::kCentral, 1.0F}};
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

TEST(CentralPictures, AreThoseOfTheComposedNetwork) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(7);
  constexpr int64_t kTwoScales = 128;  // px, of which half is what one scale needs
  const model::Model e2lf_n4 = bundled("e2lf-n4");
  const model::Model disparity = geometry::for_patterns(bundled("e2lf-depth"), *e2lf_n4.codes).value();
  DepthInputs inputs{torch::randn({1, 3, 3, kTwoScales, kTwoScales}),
                     torch::rand({1, static_cast<int64_t>(capture::conditioning_size(4))}) - 0.5,
                     torch::full({1, kTwoScales, kTwoScales}, 0.4)};
  inputs.conditioning.select(1, capture::kCyclesCondition).fill_(0.4);
  const auto camera = inputs.conditioning.unsqueeze(2).unsqueeze(3).expand({-1, -1, kTwoScales, kTwoScales});
  const auto channels = torch::cat({inputs.groups.flatten(1, 2), camera}, 1);

  const auto map = output_of(disparity, channels);
  const auto central = geometry::central_input(*e2lf_n4.codes, disparity.input);
  ASSERT_TRUE(central) << central.error().text();
  const CentralPictures moved = move_to_centre(inputs, map, {*central});
  const NetworkModule of_picture(picture_network({8, 12}), torch::kCPU);
  const auto expected = moved.base + of_picture.forward(moved.planes, torch::kFloat).squeeze(1);
  EXPECT_GT(moved.base.std().item<float>(), 0.01F);

  model::Model picture;
  picture.name = "picture";
  picture.num_patterns = 4;
  picture.input = {{model::InputKind::kCentral, 1.0F}};
  picture.network = of_picture.network();
  picture.weights = to_weights(of_picture.parameters());
  const auto composed = geometry::rendered_for_patterns(picture, disparity, *e2lf_n4.codes);
  ASSERT_TRUE(composed) << composed.error().text();
  const auto view = output_of(*composed, channels).select(1, 36);
  EXPECT_LT((view - expected).abs().max().item<float>(), 1e-4F * expected.abs().max().item<float>());
}

class PictureRun : public testing::Test {
 protected:
  PictureRun() { std::filesystem::create_directories(folder_); }
  ~PictureRun() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / cat("e2lf_picture_run_", ::getpid());
};

TEST_F(PictureRun, ResumesBitExactlyAndStoresAModelThatNamesItsDisparity) {
  const Config config = picture_config();
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
  ASSERT_TRUE(model::write_model(folder_ / "picture.safetensors", *model));
  const auto read = model::read_model(folder_ / "picture.safetensors");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_TRUE(model::is_picture_network(*read));
  EXPECT_EQ(read->weights, model->weights);
  EXPECT_EQ(read->parts, std::vector{*bundled_file_named(kBundledModels, "e2lf-depth")});
  EXPECT_TRUE(geometry::for_patterns(*read, *bundled("e2lf-n4").codes));
}

TEST_F(PictureRun, JudgesTheCentralViewOfSeveralSetsWithBothSensors) {
  Config config = picture_config();
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

TEST(PictureTraining, RefusesWhatItCannotTrain) {
  Config config = picture_config();
  config.start = "e2lf-depth";
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue);
  config = picture_config();
  config.network.disparity = "e2lf-n4";
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue);
  config = picture_config();
  config.train.patch = config.data.synthesiser.size = 32;
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << "e2lf-depth takes multiples of 64";
}

/// The stored model states the name alone, which must not lead to another network.
TEST_F(PictureRun, RefusesADisparityThatABundledModelWouldReplace) {
  const auto own = folder_ / "e2lf-depth.safetensors", renamed = folder_ / "own-depth.safetensors";
  for (const auto& path : {own, renamed}) {
    std::filesystem::copy_file(*bundled_file_named(kBundledModels, "e2lf-depth"), path);
    Config config = picture_config();
    config.network.disparity = path.string();
    EXPECT_EQ(Trainer::create(config).ok(), path == renamed) << path;
  }
}

Config bundled_config() {
  const auto path = std::filesystem::path(E2LF_SOURCE_TREE) / "configs" / "e2lf-any.json";
  const auto config = config_from_json(read_json(path).value(), path.string());
  EXPECT_TRUE(config) << config.error().text();
  return *config;
}

TEST(PictureTraining, ItsConfigurationGivesTheLayersOfTheBundledNetwork) {
  const Config config = bundled_config();
  const model::Model model = bundled("e2lf-any");
  EXPECT_EQ(config.input, model.input);
  EXPECT_EQ(picture_network(config.network.widths), model.network);
}

TEST(PictureTraining, TheBundledNetworkIsSharperThanAnUntrainedOne) {
  Config config = picture_config();
  config.network.widths = bundled_config().network.widths;
  config.network.blocks.assign(config.network.widths.size(), 1);
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
