// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/base/isa.h"
#include "e2lf/base/result.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/learn/data/batches.h"
#include "e2lf/learn/data/synthesiser.h"
#include "testing/test_training_data.h"

namespace e2lf::learn {
namespace {

TEST(ReadDataset, GivesScenesAndTexturesByName) {
  const TestData data;
  const auto dataset = read_dataset(data.path(), torch::kCPU);
  ASSERT_TRUE(dataset) << dataset.error().text();
  ASSERT_EQ(dataset->scenes.size(), 2U);
  EXPECT_EQ(dataset->textures.size(), 1U);
  const auto scene = dataset->find("second");
  ASSERT_TRUE(scene);
  EXPECT_EQ((*scene)->views.sizes(), (std::vector<int64_t>{64, 32, 32}));
  const auto missing = dataset->find("secnd");
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("second"), std::string::npos);
}

TEST(ReadDataset, RefusesTensorsThatAreNotPackedData) {
  const TestData data;
  const auto refuse = [&](const std::string& name, Tensor tensor) {
    Safetensors file;
    file.tensors[name] = std::move(tensor);
    EXPECT_TRUE(write_safetensors(data.path(), file));
    return read_dataset(data.path(), torch::kCPU).error();
  };
  const std::vector<uint8_t> bytes(64, 1);
  const std::vector<float> floats(4, 1.0F);
  EXPECT_EQ(refuse("picture/a", make_npy<uint8_t>({8, 8}, bytes)).code, ErrorCode::kFormat);
  EXPECT_EQ(refuse("texture/a", make_npy<float>({2, 2}, floats)).code, ErrorCode::kFormat);
  EXPECT_EQ(refuse("texture/a", make_npy<uint8_t>({64}, bytes)).code, ErrorCode::kShape);
  EXPECT_EQ(refuse("disparity/a", make_npy<float>({4, 1, 1}, floats)).code, ErrorCode::kFormat) << "no light field";
  EXPECT_EQ(refuse("disparity/a", make_npy<float>({2, 2}, floats)).code, ErrorCode::kShape);
  EXPECT_EQ(refuse("disparity/a", make_npy<uint8_t>({4, 4, 4}, bytes)).code, ErrorCode::kFormat);
  const auto error = refuse("lightfield/a", make_npy<uint8_t>({4, 4, 2, 2}, bytes));
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_NE(error.message.find("lightfield/a"), std::string::npos);
}

TEST(TransformViews, MovesViewsAndPixelsTogether) {
  const auto views = torch::arange(64 * 5 * 3).reshape({8, 8, 5, 3});
  const auto flat = views.reshape({64, 5, 3});
  const auto flipped_y = transform_views(flat, 1).reshape({8, 8, 5, 3});
  const auto flipped_x = transform_views(flat, 2).reshape({8, 8, 5, 3});
  const auto transposed = transform_views(flat, 4).reshape({8, 8, 3, 5});
  EXPECT_TRUE(torch::equal(flipped_y[0][2][1][2], views[7][2][3][2]));
  EXPECT_TRUE(torch::equal(flipped_x[0][2][1][2], views[0][5][1][0]));
  EXPECT_TRUE(torch::equal(transposed[0][2][1][4], views[2][0][4][1]));
  for (unsigned symmetry = 0; symmetry < 4; ++symmetry) {
    EXPECT_TRUE(torch::equal(transform_views(transform_views(flat, symmetry), symmetry), flat)) << symmetry;
  }
}

TEST(Synthesise, DependsOnTheSeedAlone) {
  const SynthesiserOptions options{.size = 32};
  const auto first = synthesise({}, options, 5, torch::kCPU).views;
  EXPECT_EQ(first.sizes(), (std::vector<int64_t>{64, 32, 32}));
  EXPECT_TRUE(torch::equal(first, synthesise({}, options, 5, torch::kCPU).views));
  EXPECT_FALSE(torch::equal(first, synthesise({}, options, 6, torch::kCPU).views));
}

TEST(ViewsOf, AgreesWithTorchsSampling) {
  torch::manual_seed(4);
  const auto map = [] { return torch::rand({60, 60}); };
  // The last plane looks far beyond the border of its map.
  const std::vector<Surface> surfaces = {{{.centre = 2.5, .slope_y = 0.02, .slope_x = -0.01}, map(), {}},
                                         {{.centre = -0.3}, map(), map().round()},
                                         {{.centre = -1.7, .slope_x = 0.025}, map(), map()},
                                         {{.centre = -9.0}, map(), 0.5 * map()}};
  const auto reference = views_of_reference(surfaces, 40);
  for (const std::string& isa : available_isas()) {
    set_max_isa(isa).value();
    const auto views = views_of(surfaces, 40);
    ASSERT_EQ(views.sizes(), (std::vector<int64_t>{64, 40, 40}));
    EXPECT_LT((views - reference).abs().max().item<float>(), 2e-3F) << isa;
    EXPECT_LT((views - reference).abs().mean().item<float>(), 1e-4F) << isa;
  }
  set_max_isa("").value();
}

TEST(ViewsOf, SkipsOnlyWhatIsNotCovered) {
  torch::manual_seed(4);
  Surface specks{
      {.centre = 1.2, .slope_x = 0.02}, torch::rand({60, 60}), torch::rand({60, 60}).gt(0.98).to(torch::kFloat)};
  const Surface wall{{.centre = -0.4}, torch::rand({60, 60}), {}};
  for (const bool has_relief : {false, true}) {
    if (has_relief) specks.relief = torch::linspace(-1.5, 1.5, 60).expand({60, 60}).contiguous();
    const auto difference = views_of({wall, specks}, 40) - views_of_reference({wall, specks}, 40);
    EXPECT_LT(difference.abs().max().item<float>(), 2e-3F) << has_relief;
  }
}

TEST(ViewsOf, SurfacesBesideTheContractAreRefused) {
  const auto map = torch::rand({20, 20});
  EXPECT_THROW((void)views_of({}, 8), ContractError);
  EXPECT_THROW((void)views_of({{{}, map, map}}, 8), ContractError);
  EXPECT_THROW((void)views_of({{{}, map, {}}, {{}, map, {}}}, 8), ContractError);
  EXPECT_THROW((void)views_of({{{}, map, {}}, {{}, torch::rand({21, 21}), torch::rand({21, 21})}}, 8), ContractError);
}

TEST(Surfaces, MoveByTheirOffset) {
  torch::manual_seed(1);
  const Surface still{{.centre = 0.7, .slope_x = 0.01}, torch::rand({60, 60}), {}};
  Surface moved = still;
  moved.plane.offset_x = 1.0;
  moved.plane.offset_y = -2.0;
  for (const auto& render : {views_of, views_of_reference}) {
    const auto before = render({still}, 32), after = render({moved}, 32);
    // What was at (y, x) is now at (y - 2, x + 1).
    const auto expected = before.slice(1, 2, 32).slice(2, 0, 31), found = after.slice(1, 0, 30).slice(2, 1, 32);
    EXPECT_LT((expected - found).abs().max().item<double>(), 5e-3);
    EXPECT_GT((before - after).abs().mean().item<double>(), 0.05);
  }
}

TEST(Synthesise, AMovingSceneIsTheStillOneAtTimeZeroToTheBit) {
  SynthesiserOptions options{.size = 32, .motion_px_per_cycle = 4.0, .still_share = 0.0};
  const auto still = synthesise({}, options, 5, torch::kCPU).views;
  const auto moving = synthesise({}, options, 5, torch::kCPU, {-1.0, 0.0});
  EXPECT_TRUE(torch::equal(moving.views, still));
  ASSERT_EQ(moving.at_times.size(0), 2);
  EXPECT_TRUE(torch::equal(moving.at_times[1], still));
  EXPECT_FALSE(torch::equal(moving.at_times[0], still));
  options.still_share = 1.0;
  EXPECT_FALSE(synthesise({}, options, 5, torch::kCPU, {-1.0, 0.0}).at_times.defined());
}

TEST(Synthesise, WithoutDisparityAllViewsAreEqual) {
  SynthesiserOptions options{.size = 32, .max_disparity = 0.0, .slant_share = 0.0};
  const auto views = synthesise({}, options, 7, torch::kCPU).views;
  EXPECT_TRUE(torch::equal(views, views.slice(0, 0, 1).expand_as(views)));
}

TEST(Synthesise, APlaneMovesByTheSameDisparityAlongRowsAndColumns) {
  torch::manual_seed(8);
  const auto photo = at::upsample_bicubic2d(torch::rand({1, 1, 60, 60}) * 255.0, {240, 240}, false)[0][0];
  const std::vector<torch::Tensor> photos = {photo.clamp(0, 255).to(torch::kByte)};
  const SynthesiserOptions options{.size = 64,
                                   .max_disparity = 3.0,
                                   .max_layers = 1,
                                   .slant_share = 0.0,
                                   .highlight_share = 0.0,
                                   .procedural_share = 0.0};
  size_t moving = 0;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const auto views = synthesise(photos, options, seed, torch::kCPU).views.to(torch::kFloat).reshape({8, 8, 64, 64});
    // A point at x in view (r, c) is at x + d in view (r, c + 1), and at x + 4 d four views on.
    const auto mismatch = [&](int64_t shift, bool rows) {
      const auto a = views[2][2], b = rows ? views[6][2] : views[2][6];
      const auto near = a.slice(0, 16, 48).slice(1, 16, 48);
      const auto far = b.slice(0, 16 + (rows ? shift : 0), 48 + (rows ? shift : 0))
                           .slice(1, 16 + (rows ? 0 : shift), 48 + (rows ? 0 : shift));
      return (near - far).square().mean().item<double>();
    };
    double moved[2] = {0, 0};
    for (const bool rows : {false, true}) {
      int64_t best = 0;
      for (int64_t shift = -12; shift <= 12; ++shift) {
        if (mismatch(shift, rows) < mismatch(best, rows)) best = shift;
      }
      // The lowest point of the parabola through the best whole shift and its neighbours.
      const double before = mismatch(best - 1, rows), at = mismatch(best, rows), after = mismatch(best + 1, rows);
      moved[rows] = static_cast<double>(best) + 0.5 * (before - after) / (before - 2.0 * at + after);
    }
    EXPECT_NEAR(moved[0], moved[1], 0.2) << "seed " << seed;
    moving += std::abs(moved[0]) > 0.5 ? 1 : 0;
  }
  EXPECT_GE(moving, 4U);
}

TEST(Batches, DependOnTheStepAloneAndNeverShowValidationScenes) {
  const TestData data;
  auto config = data.config();
  config.data.synthetic_share = 0.0;
  config.data.validation = {"first"};
  const auto create = [&] {
    return Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  };
  auto batches = create(), again = create();
  ASSERT_TRUE(batches) << batches.error().text();
  EXPECT_EQ(batches->trained_scenes(), std::vector<std::string>{"second"});
  (void)batches->at(0);
  const auto batch = batches->at(3);
  EXPECT_TRUE(torch::equal(batch.light_field, again->at(3).light_field));
  EXPECT_FALSE(torch::equal(batch.light_field, batches->at(4).light_field));
  EXPECT_EQ(batch.light_field.sizes(), (std::vector<int64_t>{2, 64, 16, 16}));
  // "first" holds values up to 99, "second" from 100 on.
  const auto brightness = batch.light_field / batch.gain.reshape({-1, 1, 1, 1});
  EXPECT_GE(brightness.min().item<float>(), 99.5F / 255.0F);
  config.data.exclude = {"second"};
  EXPECT_EQ(create().error().code, ErrorCode::kInvalidValue);
  config.data.exclude = {"third"};
  EXPECT_EQ(create().error().code, ErrorCode::kNotFound);
  EXPECT_EQ(create().error().location, "data.exclude");
}

TEST(Batches, AResumedPoolHoldsTheSameLightFields) {
  const TestData data;
  auto config = data.config();
  config.data.synthetic_share = 1.0;
  config.data.pool = 34;
  config.data.pool_per_step = 1.0;
  const auto create = [&] {
    return Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  };
  auto running = create(), resumed = create();
  for (uint64_t step = 0; step < 5; ++step) (void)running->at(step);
  EXPECT_TRUE(torch::equal(running->at(5).light_field, resumed->at(5).light_field));
}

TEST(Batches, MovingScenesEndAsTheStillOnesDo) {
  const TestData data;
  auto config = data.config();
  config.data.synthetic_share = 1.0;
  config.train.batch = 32;
  const auto create = [&] {
    return Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  };
  const auto still = create()->at(2);
  config.data.synthesiser.motion_px_per_cycle = 6.0;
  const auto moving = create()->at(2);
  EXPECT_TRUE(torch::equal(still.light_field, moving.light_field));
  ASSERT_FALSE(still.moving.places.defined());
  ASSERT_TRUE(moving.moving.places.defined());
  const auto codes = to_tensor(capture::default_codes(), torch::kCPU);
  const auto before = coded_light(still.light_field, codes, {}),
             after = coded_light(moving.light_field, codes, moving.moving);
  EXPECT_TRUE(torch::allclose(before.intensities.select(1, 3), after.intensities.select(1, 3), 1e-4, 1e-5));
  EXPECT_TRUE(torch::allclose(before.full, after.full.select(1, 3), 1e-4, 1e-5));
  double most = 0.0;
  for (int64_t i = 0; i < 32; ++i) {
    const bool moves = (moving.moving.places == i).any().item<bool>();
    EXPECT_TRUE(moves || torch::equal(before.intensities[i], after.intensities[i])) << i;
    most = std::max(most, (before.intensities[i] - after.intensities[i]).abs().max().item<double>());
  }
  EXPECT_GT(most, 1e-3);  // a patch of one tone looks the same wherever it moves
}

TEST(Batches, SharesMakeUpTheBatch) {
  const TestData data;
  auto config = data.config();
  config.train.batch = 4;
  const auto create = [&] {
    return Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  };
  auto whole = create(), shared = create();
  const auto batch = whole->at(3), first = shared->at(3, {0, 2}), second = shared->at(3, {1, 2});
  EXPECT_TRUE(torch::equal(batch.light_field, torch::cat({first.light_field, second.light_field})));
  EXPECT_TRUE(torch::equal(batch.gain, torch::cat({first.gain, second.gain})));
  EXPECT_TRUE(torch::equal(batch.constants.tau, torch::cat({first.constants.tau, second.constants.tau})));
  EXPECT_TRUE(torch::equal(batch.noise.w, torch::cat({first.noise.w, second.noise.w})));
  EXPECT_TRUE(torch::equal(batch.noise.z, torch::cat({first.noise.z, second.noise.z})));
}

TEST(Batches, TakePatchesFromAGridFromTheTopLeft) {
  const TestData data;  // scenes of 32x32
  auto config = data.config();
  config.data.synthetic_share = 0.0;
  config.data.validation = {"second"};
  config.train.patch = 20;
  config.data.patch_stride = 10;
  config.sensor.full_gain_share = 1.0;
  config.train.batch = 40;
  auto dataset = read_dataset(data.path(), torch::kCPU).value();
  const auto views = dataset.find("first").value()->views;
  std::vector<torch::Tensor> places;
  for (const int64_t y : {0, 10}) {
    for (const int64_t x : {0, 10}) places.push_back(views.slice(1, y, y + 20).slice(2, x, x + 20));
  }
  auto batches = Batches::create(config, std::move(dataset), torch::kCPU);
  const auto batch = batches->at(0).light_field.mul(255.0).round().to(torch::kByte);
  std::vector<int> seen(places.size());
  for (int64_t i = 0; i < batch.size(0); ++i) {
    for (size_t place = 0; place < places.size(); ++place) {
      for (unsigned symmetry = 0; symmetry < 8; ++symmetry) {
        if (torch::equal(batch[i], transform_views(places[place], symmetry))) ++seen[place];
      }
    }
  }
  EXPECT_EQ(std::accumulate(seen.begin(), seen.end(), 0), 40);
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(Batches, DrawConditionsFromTheirRanges) {
  const TestData data;
  auto config = data.config();
  config.train.batch = 200;
  config.data.synthetic_share = 0.0;
  auto batches = Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  const auto batch = batches->at(0);
  const auto nominal = (batch.constants.sigma_w == config.sensor.nominal.sigma_w).to(torch::kFloat).mean();
  EXPECT_NEAR(nominal.item<double>(), config.sensor.nominal_share, 0.12);
  const auto noise_free = (batch.constants.sigma_w == 0.0).to(torch::kFloat).mean();
  EXPECT_NEAR(noise_free.item<double>(), (1 - config.sensor.nominal_share) * config.sensor.noise_free_share, 0.06);
  EXPECT_NEAR((batch.gain == 1.0).to(torch::kFloat).mean().item<double>(), config.sensor.full_gain_share, 0.12);
  EXPECT_GE(batch.gain.min().item<double>(), config.sensor.gain[0] - 1e-6);
  EXPECT_LE(batch.constants.tau.max().item<double>(), config.sensor.tau[1] + 1e-6);
  EXPECT_LT(batch.constants.sigma_w.min().item<double>(), 0.05);
  EXPECT_EQ(batch.noise.residue.abs().max().item<double>(), 0.0);
}

TEST(Batches, GiveAShareOfTheSamplesThatAreNotNominalAResidue) {
  const TestData data;
  auto config = data.config();
  config.train.batch = 200;
  config.data.synthetic_share = 0.0;
  config.sensor.residue_share = 0.5;
  auto batches = Batches::create(config, read_dataset(data.path(), torch::kCPU).value(), torch::kCPU);
  const auto batch = batches->at(0);
  const auto widest = batch.noise.residue.flatten(1).amax(1);
  const auto nominal = (batch.constants.sigma_w == config.sensor.nominal.sigma_w).flatten();
  EXPECT_EQ(widest.masked_select(nominal).max().item<double>(), 0.0);
  EXPECT_NEAR((widest > 0.0).to(torch::kFloat).mean().item<double>(), 0.5 * (1 - config.sensor.nominal_share), 0.12);
  EXPECT_LT(widest.max().item<double>(), 1.0);
  // Of 60 samples with one, half have a whole threshold, the other half any part of it.
  const auto whole = (widest > 0.95).to(torch::kFloat).sum() / (widest > 0.0).to(torch::kFloat).sum();
  EXPECT_NEAR(whole.item<double>(), 0.525, 0.2);
}

}  // namespace
}  // namespace e2lf::learn
