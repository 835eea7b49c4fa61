// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/trainer.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <tuple>
#include <utility>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/commands.h"
#include "e2lf/model/network.h"
#include "testing/test_training_data.h"

namespace e2lf::learn {
namespace {

void expect_equal(const NamedTensors& a, const NamedTensors& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, tensor] : a) EXPECT_TRUE(torch::equal(tensor, b.at(name))) << name;
}

TEST(LearningRate, WarmsUpHoldsAndFallsToZero) {
  const TrainConfig train{.steps = 100, .learning_rate = 2.0, .warmup_steps = 10, .hold_steps = 60};
  EXPECT_DOUBLE_EQ(learning_rate(train, 0), 0.2);
  EXPECT_DOUBLE_EQ(learning_rate(train, 9), 2.0);
  EXPECT_DOUBLE_EQ(learning_rate(train, 59), 2.0);
  EXPECT_DOUBLE_EQ(learning_rate(train, 80), 1.0);
  EXPECT_NEAR(learning_rate(train, 100), 0.0, 1e-12);
}

TEST(Trainer, ResumesBitExactlyWhilePatternsAreLearnedAndAfter) {
  const TestData data;
  for (const uint64_t stop : {3U, 6U}) {
    auto whole = Trainer::create(data.config());
    ASSERT_TRUE(whole) << whole.error().text();
    for (int i = 0; i < 8; ++i) (void)whole->train_step();

    auto first = Trainer::create(data.config());
    for (uint64_t i = 0; i < stop; ++i) (void)first->train_step();
    ASSERT_TRUE(first->save_checkpoint(data.folder() / "checkpoint"));
    auto resumed = Trainer::create(data.config());
    ASSERT_TRUE(resumed->load_checkpoint(data.folder() / "checkpoint"));
    for (uint64_t i = stop; i < 8; ++i) (void)resumed->train_step();

    expect_equal(whole->parameters(), resumed->parameters());
    expect_equal(whole->average(), resumed->average());
    EXPECT_EQ(whole->to_model().value().codes, resumed->to_model().value().codes);
  }
}

/// Every measurement trains, resumes bit-exactly and gives a model that says it.
TEST(Trainer, LearnsFromEveryMeasurement) {
  const TestData data;
  using model::InputKind;
  const std::vector<std::tuple<std::vector<model::InputGroup>, size_t, capture::MeasurementKind>> measurements = {
      {{{InputKind::kImages, 4.0F}}, 1, capture::MeasurementKind::kCodedImages},
      {{{InputKind::kImages, 4.0F}}, 3, capture::MeasurementKind::kCodedImages},
      {{{InputKind::kCounts, 0.125F}, {InputKind::kImageSum, 1.0F}}, 4, capture::MeasurementKind::kHybrid},
      {{{InputKind::kLensArray, 1.0F}}, 1, capture::MeasurementKind::kLensArray}};
  for (const auto& [input, num_patterns, kind] : measurements) {
    auto config = data.config();
    config.input = input;
    config.patterns.num_patterns = num_patterns;
    config.patterns.black_first = false;
    auto whole = Trainer::create(config);
    ASSERT_TRUE(whole) << whole.error().text();
    const auto before = whole->to_model().value();
    for (int i = 0; i < 6; ++i) ASSERT_TRUE(std::isfinite(whole->train_step()->loss));
    auto first = Trainer::create(config), resumed = Trainer::create(config);
    for (int i = 0; i < 3; ++i) (void)first->train_step();
    ASSERT_TRUE(first->save_checkpoint(data.folder() / "checkpoint"));
    ASSERT_TRUE(resumed->load_checkpoint(data.folder() / "checkpoint"));
    for (int i = 3; i < 6; ++i) (void)resumed->train_step();
    expect_equal(whole->parameters(), resumed->parameters());
    const auto model = whole->to_model().value();
    EXPECT_NE(model.weights, before.weights);
    EXPECT_EQ(model.measurement(), kind);
    EXPECT_TRUE(model::write_model(data.folder() / "model", model)) << capture::measurement_name(kind);
    if (kind == capture::MeasurementKind::kLensArray) {
      EXPECT_EQ(capture::light_efficiency(*model.codes), std::vector<float>{1.0F});
    }
  }
}

TEST(Trainer, LeavesTheCodesOutOfTheModelWhenAsked) {
  const TestData data;
  auto config = data.config();
  EXPECT_TRUE(Trainer::create(config)->to_model().value().codes.has_value());
  config.patterns.in_model = false;
  const auto model = Trainer::create(config)->to_model().value();
  EXPECT_FALSE(model.codes.has_value());
  EXPECT_TRUE(model.black_first);
  EXPECT_TRUE(model::write_model(data.folder() / "model", model));
}

TEST(Trainer, TakesPatternsFromAFileOfPatterns) {
  const TestData data;
  auto config = data.config();
  capture::Codes codes(4, 8, 8);
  for (size_t i = 64; i < codes.values.size(); ++i) codes.values[i] = i % 3 == 0 ? 1.0F : 0.0F;
  config.patterns.codes = (data.folder() / "codes.json").string();
  ASSERT_TRUE(capture::write_codes(config.patterns.codes, codes));
  const auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer) << trainer.error().text();
  EXPECT_EQ(trainer->to_model().value().codes, codes);
  config.patterns.num_patterns = 5;
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kShape);
}

TEST(Trainer, TakesModelsAndCamerasByName) {
  const TestData data;
  auto config = data.config();
  config.patterns.codes = "e2lf-n4";
  config.sensor.camera = "evk4-lcos";
  const auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer) << trainer.error().text();
  const auto model = model::read_model(*bundled_model());
  EXPECT_EQ(trainer->to_model().value().codes, model->codes);
  EXPECT_EQ(trainer->to_model().value().camera->name, "evk4-lcos");
  for (std::string* name : {&config.sensor.camera, &config.patterns.codes, &config.start}) {
    const std::string before = std::exchange(*name, "nobodys");
    const auto unknown = Trainer::create(config);
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
    EXPECT_NE(unknown.error().message.find(name == &config.sensor.camera ? "evk4-lcos" : "e2lf-n4"), std::string::npos);
    *name = before;
  }
}

TEST(Trainer, EvaluatesSynthesisedScenesWhereNoneAreNamed) {
  auto config = TestData().config();
  config.data.file.clear();
  config.data.validation.clear();
  config.data.synthetic_share = 1.0;
  const TestData data;
  const auto run = data.folder() / "run";
  ASSERT_TRUE(write_file(data.folder() / "config.json", json_text(to_json(config))));
  const auto trained = train(data.folder() / "config.json", run, {});
  ASSERT_TRUE(trained) << trained.error().text();
  const auto page = read_file(run / "curves.html").value();
  EXPECT_NE(std::string(page.begin(), page.end()).find("synthesised 2"), std::string::npos);
}

/// The network of a model of N = 4 with two input groups, before the same with other groups and two patterns more: it
/// computes the same where the new transitions hold nothing.
TEST(Trainer, ContinuesANetworkWithMorePatternsAndOtherInputs) {
  torch::manual_seed(3);
  model::Model start;
  start.num_patterns = 4;
  start.input = {{model::InputKind::kCounts, 0.125F}, {model::InputKind::kIntensity, 4.0F}};
  const std::vector<model::InputGroup> groups = {
      {model::InputKind::kIntensity, 2.0F}, {model::InputKind::kCumulative, 1.0F}, {model::InputKind::kCounts, 0.125F}};
  model::UnetOptions options{.input_channels = 6, .widths = {8}, .blocks = {1}, .head_width = 4};
  options.head_blocks = 1;
  const NetworkModule narrow(model::unet(options), torch::kCPU);
  {
    torch::NoGradGuard no_grad;  // residual convolutions begin at zero, which would hide the layers before them
    for (auto [name, tensor] : narrow.parameters()) tensor.normal_(0.0, 0.2);
  }
  options.input_channels = 15;
  const NetworkModule wide(model::unet(options), torch::kCPU);
  const auto origins = input_origins(start, groups, 6);
  const auto weights = widen_inputs(narrow.network(), to_weights(narrow.parameters()), wide.network(), origins);
  ASSERT_TRUE(load_weights(wide.parameters(), weights, "start"));

  torch::NoGradGuard no_grad;
  const auto counts = torch::randn({1, 3, 8, 8}), intensities = torch::randn({1, 3, 8, 8});
  const auto unknown = torch::randn({1, 5, 8, 8}), later = torch::randn({1, 2, 8, 8});
  const auto before = narrow.forward(torch::cat({counts, intensities}, 1), torch::kFloat);
  const auto after = wide.forward(torch::cat({intensities * 0.5, later, unknown, counts, later}, 1), torch::kFloat);
  EXPECT_GT(before.abs().max().item<float>(), 0.1F);
  EXPECT_LT((before - after).abs().max().item<float>(), 1e-4F);
}

TEST(Trainer, ContinuesANetworkWhoseInputsAreInAnotherOrder) {
  torch::manual_seed(4);
  model::Model start;
  start.num_patterns = 3;
  start.input = {{model::InputKind::kCounts, 0.125F}, {model::InputKind::kCumulative, 1.0F}};
  const std::vector<model::InputGroup> groups = {{model::InputKind::kCumulative, 0.5F},
                                                 {model::InputKind::kCounts, 0.125F}};
  const auto description = model::unet({.input_channels = 4, .widths = {8}, .blocks = {1}, .head_width = 4});
  const NetworkModule first(description, torch::kCPU), second(description, torch::kCPU);
  torch::NoGradGuard no_grad;
  for (auto [name, tensor] : first.parameters()) tensor.normal_(0.0, 0.2);
  const auto weights =
      widen_inputs(description, to_weights(first.parameters()), description, input_origins(start, groups, 3));
  ASSERT_TRUE(load_weights(second.parameters(), weights, "start"));
  const auto counts = torch::randn({1, 2, 8, 8}), sums = torch::randn({1, 2, 8, 8});
  const auto before = first.forward(torch::cat({counts, sums}, 1), torch::kFloat);
  const auto after = second.forward(torch::cat({sums * 0.5, counts}, 1), torch::kFloat);
  EXPECT_GT(before.abs().max().item<float>(), 0.1F);
  EXPECT_LT((before - after).abs().max().item<float>(), 1e-4F);
}

TEST(Trainer, RefusesDevicesThatAreNotThere) {
  const TestData data;
  auto config = data.config();
  for (const char* name : {"gpu", "cuda:", "cuda:x", "cuda:-1", ""}) {
    config.device = name;
    EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kInvalidValue) << name;
  }
  config.device = "cuda:99";
  EXPECT_EQ(Trainer::create(config).error().code, ErrorCode::kMissingDependency);
}

TEST(Trainer, LowersTheLossOnOneScene) {
  const TestData data;
  auto config = data.config();
  config.data.synthetic_share = 0.0;
  config.patterns.learn_steps = 0;
  config.train.steps = 60;
  config.train.learning_rate = 5e-3;
  auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer);
  const double before = trainer->train_step().value().loss;
  double after = 0;
  for (int i = 0; i < 59; ++i) after = trainer->train_step().value().loss;
  EXPECT_LT(after, 0.3 * before);
}

TEST(Trainer, StopsAtANumberThatIsNotFiniteAndKeepsTheCheckpoint) {
  const TestData data;
  auto config = data.config();
  auto trainer = Trainer::create(config);
  ASSERT_TRUE(trainer->run(data.folder() / "run"));
  const auto size = std::filesystem::file_size(data.folder() / "run" / "checkpoint.safetensors");
  config.train.steps = 50;
  config.train.learning_rate = 1e30;
  auto diverging = Trainer::create(config);
  ASSERT_TRUE(diverging->load_checkpoint(data.folder() / "run" / "checkpoint.safetensors"));
  const auto result = diverging->run(data.folder() / "run");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidValue);
  EXPECT_NE(result.error().message.find("learning_rate"), std::string::npos);
  auto good = Trainer::create(config);
  EXPECT_TRUE(good->load_checkpoint(data.folder() / "run" / "checkpoint.safetensors"));
  EXPECT_GE(good->step(), 8U);
  EXPECT_EQ(std::filesystem::file_size(data.folder() / "run" / "checkpoint.safetensors"), size);
  for (const auto& [name, tensor] : good->parameters()) EXPECT_TRUE(tensor.isfinite().all().item<bool>()) << name;
}

TEST(Trainer, RefusesCheckpointsOfAnotherNetworkOrKind) {
  const TestData data;
  auto trainer = Trainer::create(data.config());
  const auto path = data.folder() / "checkpoint";
  ASSERT_TRUE(trainer->save_checkpoint(path));
  auto config = data.config();
  config.network.widths = {8, 12};
  auto other = Trainer::create(config);
  EXPECT_EQ(other->load_checkpoint(path).error().code, ErrorCode::kShape);
  EXPECT_EQ(other->load_checkpoint(data.path()).error().code, ErrorCode::kFormat);
  EXPECT_EQ(other->load_checkpoint(data.folder() / "none").error().code, ErrorCode::kNotFound);
}

TEST(Commands, TrainWritesLogsAndAModelThatReconstructionCanRead) {
  const TestData data;
  const auto run = data.folder() / "run";
  std::ofstream(data.folder() / "config.json") << to_json(data.config());
  const auto trained = train(data.folder() / "config.json", run, {"name=tiny"});
  ASSERT_TRUE(trained) << trained.error().text();
  const auto model = model::read_model(run / "tiny.safetensors");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->num_patterns, 4U);
  EXPECT_EQ(model->input.size(), 3U);
  for (const float value : model->codes->values) EXPECT_TRUE(value == 0.0F || value == 1.0F);
  EXPECT_EQ(model->provenance["samples"], 16);
  EXPECT_EQ(model->provenance["config"]["data"]["file"], "packed.safetensors");  // without the folder

  std::ifstream log(run / "log.csv");
  size_t lines = 0;
  for (std::string line; std::getline(log, line);) ++lines;
  EXPECT_EQ(lines, 9U);  // a header and one per step
  EXPECT_TRUE(std::filesystem::exists(run / "evaluation.csv"));
  EXPECT_EQ(train(data.folder() / "config.json", run).error().code, ErrorCode::kExists);
  EXPECT_EQ(export_run(run, run / "tiny.safetensors", /*overwrite=*/false).error().code, ErrorCode::kExists);
  for (const char* part : {"checkpoint.safetensors", "config.json", "log.csv"}) {
    EXPECT_EQ(export_run(run, run / part, /*overwrite=*/true).error().code, ErrorCode::kInvalidValue) << part;
  }
  EXPECT_EQ(export_run(run, data.folder() / "model.npz", /*overwrite=*/false).error().code, ErrorCode::kInvalidValue);
  std::ofstream(data.folder() / "earlier.safetensors") << "earlier";
  std::filesystem::create_symlink("earlier.safetensors", data.folder() / "link.safetensors");
  EXPECT_TRUE(export_run(run, data.folder() / "link.safetensors", /*overwrite=*/true));
  EXPECT_TRUE(model::read_model(data.folder() / "earlier.safetensors"));
  EXPECT_TRUE(resume(run, {"train.steps=10"}));
  EXPECT_EQ(resume(run, {"train.steps=9"}).error().code, ErrorCode::kInvalidValue);
  const auto table = evaluate_run(run, {"first", "second"});
  ASSERT_TRUE(table) << table.error().text();
  EXPECT_NE(table->find("second\t"), std::string::npos);
}

TEST(Commands, StoppingLeavesACheckpointToResumeFrom) {
  const TestData data;
  const auto run = data.folder() / "run";
  std::ofstream(data.folder() / "config.json") << to_json(data.config());
  int steps = 0;
  const auto stopped = train(data.folder() / "config.json", run, {}, {}, [&] { return ++steps < 3; });
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  const auto resumed = resume(run);
  EXPECT_TRUE(resumed) << resumed.error().text();
}

TEST(Commands, TakeDenormalsAsZeroSoThatMomentaCanFade) {
  if (!at::globalContext().setFlushDenormal(false)) GTEST_SKIP() << "this CPU cannot";
  const auto half = [] { return (torch::full({16}, 1e-39F) * 0.5).max().item<float>(); };
  EXPECT_GT(half(), 0.0F);
  EXPECT_FALSE(export_run("no such run", "no model", /*overwrite=*/false));
  EXPECT_EQ(half(), 0.0F);
}

}  // namespace
}  // namespace e2lf::learn
