// SPDX-License-Identifier: MIT
#include "e2lf/compare/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/compare/tables.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/inversion.h"
#include "e2lf/sensor/event_model.h"
#include "testing/test_files.h"

namespace e2lf::compare {
namespace {

using lightfield::LightField;

/// The inversion on a small rendered scene before the paper's sensor.
Plan inversion_plan(size_t cycles, float gain) {
  Plan plan;
  plan.methods.resize(1);
  plan.methods[0].config.name = "inversion";
  plan.methods[0].config.algorithm = "inversion";
  plan.methods[0].codes = capture::default_codes();
  plan.scenes.resize(1);
  plan.scenes[0].name = "demo";
  plan.scenes[0].rendered_seed = 1;
  plan.scenes[0].group.width = 48;
  plan.scenes[0].group.height = 32;
  plan.sensors.resize(1);
  plan.sensors[0].config.name = "paper";
  plan.sensors[0].config.cycles = cycles;
  plan.sensors[0].config.gain = gain;
  plan.jobs.push_back({0, 0, 0, 7, {}, {}});
  return plan;
}

Result<Outcome> measure(const Plan& plan, const Job& job, const LightField& truth) {
  return JobRunner(plan).run(job, truth);
}

TEST(Measure, IsWhatSimulationInversionAndComparisonGive) {
  const Plan plan = inversion_plan(1, 1.0F);
  const LightField truth = load_scene(plan.scenes[0]).value();
  const Outcome measured = measure(plan, plan.jobs[0], truth).value();

  sensor::EventModelOptions options;
  options.seed = 7;
  const auto images = sensor::simulate_events(plan.methods[0].codes, truth, options).value();
  const LightField field = recon::reconstruct_by_inversion(images, plan.methods[0].codes, {}).value();
  const auto quality = eval::compare(truth, field).value();
  EXPECT_EQ(measured.figures["psnr_db"], quality.mean.psnr_db);
  EXPECT_EQ(measured.figures["ssim"], quality.mean.ssim_uniform7);
  EXPECT_EQ(measured.figures["views_psnr_db"].size(), 64U);
  EXPECT_EQ(measured.figures["num_patterns"], 4);
  // Three patterns of 10 ms and 0.592 ms between; the paper's cycle.
  EXPECT_NEAR(measured.figures["measurement_ms"].get<double>(), 31.8, 0.1);
  EXPECT_NEAR(measured.figures["cycle_ms"].get<double>(), 94.7, 0.1);
}

/// A model of four patterns that shows one of its input channels in every view.
model::Model channel_model(std::vector<model::InputGroup> input, size_t channel) {
  model::Model model;
  model.name = "channel";
  model.num_patterns = 4;
  model.codes = capture::default_codes();
  model.input = std::move(input);
  model::Layer layer;
  layer.name = "a";
  layer.inputs = {"input"};
  layer.out_channels = 64;
  const size_t channels = model::num_input_channels(model.input, model.num_patterns);
  model.network = {channels, {layer}};
  model.weights["a.bias"].resize(64);
  model.weights["a.weight"].resize(64 * channels);
  for (size_t view = 0; view < 64; ++view) model.weights["a.weight"][view * channels + channel] = 1.0F;
  return model;
}

TEST(Measure, IntensityImagesCostNoEvents) {
  const TestFolder folder;
  Plan plan = inversion_plan(1, 0.5F);
  ComparedMethod& method = plan.methods[0];
  method.config.algorithm = "network";
  method.model = folder / "m.safetensors";
  method.measurement = capture::MeasurementKind::kCodedImages;
  ASSERT_TRUE(model::write_model(method.model, channel_model({{model::InputKind::kImages, 1.0F}}, 1)));
  plan.sensors[0].camera.constants.sigma_i = 0;
  const LightField truth = load_scene(plan.scenes[0]).value();
  const Outcome measured = measure(plan, plan.jobs[0], truth).value();
  EXPECT_EQ(measured.figures["events_per_pixel"], 0);
  EXPECT_EQ(measured.figures["bits_per_pixel"], 8 * 4 / 64.0);
  EXPECT_NEAR(measured.figures["measurement_ms"].get<double>(), 4 * 10.592, 1e-9);
  EXPECT_FALSE(measured.figures.contains("cycle_ms"));
  // The scene's gain is undone, and the image is that of Eq. 1.
  const auto intensities = sensor::coded_intensities(method.codes, truth).value();
  for (size_t i = 0; i < intensities.image_size(); ++i) {
    ASSERT_NEAR(measured.light_field.data()[i], intensities.image(1)[i], 1e-5);
  }
}

TEST(Measure, NetworksThatAreToldTheCameraKeepTheImageOfAHybrid) {
  const TestFolder folder;
  const std::vector<model::InputGroup> input = {
      {model::InputKind::kCounts, 1.0F}, {model::InputKind::kImageSum, 1.0F}, {model::InputKind::kCamera, 1.0F}};
  for (const size_t cycles : {1, 3}) {
    Plan plan = inversion_plan(cycles, 1.0F);
    ComparedMethod& method = plan.methods[0];
    method.config.algorithm = "network";
    method.model = folder / cat("m", cycles, ".safetensors");
    method.measurement = capture::MeasurementKind::kHybrid;
    ASSERT_TRUE(model::write_model(method.model, channel_model(input, 3)));
    plan.sensors[0].camera.constants.sigma_i = 0;
    const LightField truth = load_scene(plan.scenes[0]).value();
    const auto measured = measure(plan, plan.jobs[0], truth);
    ASSERT_TRUE(measured) << measured.error().text();
    const auto intensities = sensor::coded_intensities(method.codes, truth).value();
    for (size_t i = 0; i < intensities.image_size(); ++i) {
      float sum = 0;
      for (size_t n = 0; n < 4; ++n) sum += intensities.image(n)[i];
      ASSERT_NEAR(measured->light_field.data()[i], sum, 1e-5);
    }
  }
}

TEST(Measure, SeveralCyclesAreBetterAndCostMore) {
  const Plan one = inversion_plan(1, 1.0F), four = inversion_plan(4, 1.0F);
  const LightField truth = load_scene(one.scenes[0]).value();
  const Json of_one = measure(one, one.jobs[0], truth).value().figures;
  const Json of_four = measure(four, four.jobs[0], truth).value().figures;
  EXPECT_GT(of_four["psnr_db"].get<double>(), of_one["psnr_db"].get<double>());
  EXPECT_NEAR(of_four["events_per_pixel"].get<double>() / of_one["events_per_pixel"].get<double>(), 4, 0.2);
  EXPECT_DOUBLE_EQ(of_four["measurement_ms"].get<double>(), 4 * of_one["measurement_ms"].get<double>());
}

TEST(Measure, TheGainIsThatOfTheSceneUndoneOrFitted) {
  Plan plan = inversion_plan(1, 0.25F);
  const LightField truth = load_scene(plan.scenes[0]).value();
  EXPECT_EQ(measure(plan, plan.jobs[0], truth).value().figures["gain"], 4.0);
  const double undone = measure(plan, plan.jobs[0], truth).value().figures["psnr_db"].get<double>();
  plan.methods[0].config.fit_gain = true;
  EXPECT_GT(measure(plan, plan.jobs[0], truth).value().figures["psnr_db"].get<double>(), undone);
}

TEST(Measure, ErrorsNameMethodSceneAndSensor) {
  Plan plan = inversion_plan(1, 1.0F);
  for (float& value : plan.methods[0].codes.values) value = 1.0F;
  const LightField truth = load_scene(plan.scenes[0]).value();
  const auto failed = measure(plan, plan.jobs[0], truth);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().location, "inversion on demo, sensor paper");
}

TEST(Measure, MethodsShareEventsAndJobsShareMethods) {
  Plan plan = inversion_plan(2, 1.0F);
  plan.methods.push_back(plan.methods[0]);
  plan.methods[1].config.camera = "evk4-lcos";
  plan.methods.push_back(plan.methods[0]);
  std::ranges::reverse(plan.methods[2].codes.values);
  plan.scenes.push_back(plan.scenes[0]);
  const LightField truth = load_scene(plan.scenes[0]).value();
  JobRunner runner(plan);
  for (size_t scene = 0; scene < 2; ++scene) {
    for (size_t method = 0; method < 3; ++method) {
      for (const uint64_t seed : {7, 8}) {
        const Job job{method, scene, 0, seed, {}, {}};
        EXPECT_EQ(runner.run(job, truth)->figures["psnr_db"], measure(plan, job, truth)->figures["psnr_db"]);
      }
    }
  }
  EXPECT_EQ(runner.num_prepared(), 3U);
  EXPECT_EQ(runner.num_simulated(), 2U * 2U * 2U) << "two scenes, seeds and sets of patterns";
}

TEST(Measure, SumsThatSaturateAreCounted) {
  const TestFolder folder;
  Plan plan = inversion_plan(3, 1.0F);
  ComparedMethod& method = plan.methods[0];
  method.config.algorithm = "network";
  method.model = folder / "m.safetensors";
  ASSERT_TRUE(model::write_model(
      method.model, channel_model({{model::InputKind::kCounts, 1.0F}, {model::InputKind::kCamera, 1.0F}}, 1)));
  const LightField truth = load_scene(plan.scenes[0]).value();
  EXPECT_EQ(measure(plan, plan.jobs[0], truth)->figures["saturated_events"], 0);
  plan.sensors[0].config.cycles = 40;
  plan.sensors[0].camera.constants = {.eps = 1e-6F, .tau = 0.01F, .sigma_w = 0, .sigma_z = 0};
  EXPECT_GT(measure(plan, plan.jobs[0], truth)->figures["saturated_events"], 0);
}

TEST(Look, HasViewInsetEpiAndError) {
  LightField truth({8, 8, 32, 48, 1}), field = truth;
  for (float& value : field.data()) value = 0.1F;
  const lightfield::Image alone = look(field, nullptr), compared = look(field, &truth);
  EXPECT_EQ(alone.width, 48U);
  EXPECT_EQ(alone.height, 32U + 4U + 8U * 5U);
  EXPECT_EQ(compared.width, 2U * 48U + 4U);
  EXPECT_FLOAT_EQ(alone.pixels[0], 0.1F);
  // Half of the error that is white.
  EXPECT_FLOAT_EQ(compared.pixels[48 + 4], 0.5F);
  // The frame of the inset in the lower right corner.
  EXPECT_FLOAT_EQ(alone.pixels[31 * 48 + 47], 1.0F);
}

TEST(Measure, ComparesDisparitiesWithThoseRendered) {
  Plan plan = inversion_plan(1, 1.0F);
  const LightField truth = load_scene(plan.scenes[0]).value();
  const lightfield::Image disparity = scene_disparity(plan.scenes[0], truth).value();
  ASSERT_EQ(disparity.width, 48U);
  const Outcome outcome = JobRunner(plan).run(plan.jobs[0], truth, disparity).value();
  EXPECT_EQ(outcome.disparity.width, 48U);
  EXPECT_GT(outcome.figures["bad_07_percent"].get<double>(), outcome.figures["bad_20_percent"].get<double>() - 1e-9);
  EXPECT_TRUE(outcome.figures["disparity_slope"].is_number());
  plan.scenes[0].group.height = 20;
  EXPECT_TRUE(scene_disparity(plan.scenes[0], load_scene(plan.scenes[0]).value())->pixels.empty());
}

TEST(Measure, CropsTheDisparitiesBesideAScene) {
  const TestFolder folder;
  const lightfield::Shape shape{2, 2, 40, 60, 1};
  ASSERT_TRUE(lightfield::write_views(folder.path(), LightField(shape), lightfield::LightFieldFormat::kPng8).ok());
  std::vector<float> map(shape.view_size());
  for (size_t i = 0; i < map.size(); ++i) map[i] = static_cast<float>(i);
  ASSERT_TRUE(write_npy(folder.path() / "gt_disparity.npy", make_npy<float>({40, 60}, map)).ok());
  ComparedScene scene;
  scene.path = folder.path();
  scene.group.width = 50;
  scene.group.height = 36;
  const lightfield::Image disparity = scene_disparity(scene, LightField({2, 2, 36, 50, 1})).value();
  ASSERT_EQ(disparity.pixels.size(), 36U * 50U);
  EXPECT_EQ(disparity.pixels[0], 2 * 60 + 5);
  scene.group.width = scene.group.height = 0;
  EXPECT_EQ(scene_disparity(scene, LightField({2, 2, 36, 50, 1})).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::compare
