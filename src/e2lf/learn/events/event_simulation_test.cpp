// SPDX-License-Identifier: MIT
#include "e2lf/learn/events/event_simulation.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "e2lf/sensor/event_model.h"

namespace e2lf::learn {
namespace {

constexpr auto kDouble = torch::kDouble;

SampleConstants noise_free(int64_t batch, torch::ScalarType type = torch::kFloat) {
  auto constants = repeat_constants({.sigma_w = 0.0F, .sigma_z = 0.0F}, batch, torch::kCPU);
  for (auto* value : {&constants.eps, &constants.tau, &constants.sigma_w, &constants.sigma_z}) *value = value->to(type);
  return constants;
}

SensorNoise draw_noise_like(const torch::Tensor& intensities) {
  return draw_noise(capture::MeasurementKind::kEventImages, intensities.size(0), intensities.size(1),
                    intensities.size(2), intensities.size(3), torch::kCPU);
}

/// Largest difference between the gradient of `loss` at x and central differences.
double gradient_error(const std::function<torch::Tensor(const torch::Tensor&)>& loss, torch::Tensor x) {
  x = x.detach().clone().set_requires_grad(true);
  loss(x).backward();
  torch::NoGradGuard no_grad;
  double worst = 0;
  constexpr double kStep = 1e-5;
  auto values = x.detach().clone();
  for (int64_t i = 0; i < values.numel(); ++i) {
    auto element = values.view(-1)[i];
    const double at = element.item<double>();
    element.fill_(at + kStep);
    const double above = loss(values).item<double>();
    element.fill_(at - kStep);
    const double below = loss(values).item<double>();
    element.fill_(at);
    worst = std::max(worst, std::abs((above - below) / (2 * kStep) - x.grad().view(-1)[i].item<double>()));
  }
  return worst;
}

TEST(CodedIntensities, HaveTheGradientOfDifferences) {
  torch::manual_seed(1);
  const auto light_field = torch::rand({2, 64, 2, 3}, kDouble), weights = torch::randn({2, 4, 2, 3}, kDouble);
  const auto loss = [&](const torch::Tensor& codes) {
    return (coded_intensities(light_field, torch::sigmoid(codes)).square() * weights).sum();
  };
  EXPECT_LT(gradient_error(loss, torch::randn({4, 64}, kDouble)), 1e-8);
}

TEST(InputForm, HasTheGradientOfDifferencesInEveryGroup) {
  torch::manual_seed(2);
  const std::vector<model::InputGroup> groups = {
      {model::InputKind::kCounts, 0.125F}, {model::InputKind::kCumulative, 0.5F}, {model::InputKind::kIntensity, 4.0F}};
  const auto weights = torch::randn({1, 9, 2, 2}, kDouble);
  const auto loss = [&](const torch::Tensor& events) {
    return (form_inputs(events, groups, noise_free(1, kDouble)).square() * weights).sum();
  };
  EXPECT_LT(gradient_error(loss, torch::rand({1, 3, 2, 2}, kDouble) * 3.0 + 0.5), 1e-7);
}

/// The same measurement as `sensor` makes of the same light field.
TEST(MeasuredImages, AreThoseOfTheSimulator) {
  torch::manual_seed(4);
  const auto light_field = torch::rand({1, 64, 16, 24});
  lightfield::LightField scene({8, 8, 16, 24});
  std::copy_n(light_field.data_ptr<float>(), scene.data().size(), scene.data().begin());
  const capture::Codes codes = capture::default_codes();
  const auto intensities = coded_intensities(light_field, to_tensor(codes, torch::kCPU));
  using capture::MeasurementKind;
  for (const auto kind : {MeasurementKind::kCodedImages, MeasurementKind::kHybrid, MeasurementKind::kLensArray}) {
    const auto noise = draw_noise(kind, 1, 4, 16, 24, torch::kCPU);
    EXPECT_EQ(noise.w.defined(), kind == MeasurementKind::kHybrid);
    const auto images = measure_images(kind, light_field, intensities, 0.0, noise.image).contiguous();
    const auto expected = sensor::measure_images(kind, codes, scene, {.sigma = 0}).value();
    ASSERT_EQ(images.numel(), static_cast<int64_t>(expected.values.size())) << capture::measurement_name(kind);
    for (size_t i = 0; i < expected.values.size(); ++i) {
      ASSERT_NEAR(images.data_ptr<float>()[i], expected.values[i], 1e-5F) << capture::measurement_name(kind);
    }
    const auto noisy = measure_images(kind, light_field, intensities, 0.01, noise.image);
    EXPECT_NEAR((noisy - images).std().item<double>(), 0.01, 0.0015);
  }
  EXPECT_FALSE(measure_images(MeasurementKind::kEventImages, light_field, intensities, 0.0, {}).defined());
}

/// Lenses whose brightness grows evenly from lens to lens: so does the plane of each view between their centres, as
/// recon::network_input() has it.
TEST(InputForm, LensesAreJoinedInStraightLines) {
  auto image = torch::zeros({1, 1, 16, 32});
  for (int64_t y = 0; y < 16; ++y) {
    for (int64_t x = 0; x < 32; ++x) image[0][0][y][x] = (y % 8 * 8 + x % 8) / 64.0 + (x / 8) * 0.5;
  }
  const auto planes = form_inputs({}, {{model::InputKind::kLensArray, 2.0F}}, noise_free(1), image);
  ASSERT_EQ(planes.sizes(), (std::vector<int64_t>{1, 64, 16, 32}));
  EXPECT_NEAR(planes[0][9][5][0].item<double>(), 2 * 9 / 64.0, 1e-6);  // before the first centre
  EXPECT_NEAR(planes[0][9][5][15].item<double>(), 2 * (9 / 64.0 + 0.5 * (15.5 / 8 - 0.5)), 1e-6);
}

TEST(InputForm, MatchesItsDefinitionAndLimitsIntensitiesToOne) {
  const auto events = torch::tensor({5.0F, -2.0F, 0.0F, 90.0F, 0.0F, 0.0F}).reshape({1, 3, 1, 2}).contiguous();
  // Pixel 0: E = 5, 0, 0; pixel 1: E = -2, 90, 0.
  const auto form = [&](model::InputKind kind) { return form_inputs(events, {{kind, 2.0F}}, noise_free(1)); };
  EXPECT_TRUE(torch::equal(form(model::InputKind::kCounts), events * 2.0));
  const auto cumulative = form(model::InputKind::kCumulative);
  EXPECT_EQ(cumulative[0][2][0][0].item<float>(), 10.0F);
  EXPECT_EQ(cumulative[0][2][0][1].item<float>(), 176.0F);
  const auto level = form(model::InputKind::kLevel);
  EXPECT_EQ(level[0][2][0][0].item<float>(), 11.0F);
  EXPECT_EQ(level[0][0][0][1].item<float>(), -5.0F);
  const auto intensity = form(model::InputKind::kIntensity);
  EXPECT_NEAR(intensity[0][0][0][0].item<float>(), 2 * 0.01 * std::expm1(0.3 * 5.5), 1e-6);
  EXPECT_NEAR(intensity[0][2][0][0].item<float>(), 2 * 0.01 * std::expm1(0.3 * 5.5), 1e-6);
  EXPECT_NEAR(intensity[0][0][0][1].item<float>(), 2 * 0.01 * std::expm1(-0.3 * 2.5), 1e-6);
  EXPECT_NEAR(intensity[0][1][0][1].item<float>(), 2.0, 1e-5);
}

TEST(SimulateEvents, PassesTheGradientOfTheUnroundedStepsThrough) {
  const double eps = 0.01, tau = 0.3;
  const auto intensities =
      torch::tensor({0.1, 0.4, 0.2}, kDouble).reshape({1, 3, 1, 1}).contiguous().set_requires_grad(true);
  auto constants = noise_free(1, kDouble);
  constants.eps.fill_(eps);
  constants.tau.fill_(tau);
  const auto events = simulate_events(intensities, constants, draw_noise_like(intensities), EventModel::kQuantised);
  EXPECT_EQ(events.flatten()[0].item<double>(), std::trunc(std::log(0.41 / 0.11) / tau));
  EXPECT_EQ(events.flatten()[1].item<double>(), std::trunc(std::log(0.21 / 0.41) / tau));
  events.sum().backward();
  // d(E_1 + E_2)/dI: I_2 cancels between the two transitions.
  const auto gradient = intensities.grad().flatten();
  EXPECT_NEAR(gradient[0].item<double>(), -1 / (tau * 0.11), 1e-9);
  EXPECT_NEAR(gradient[1].item<double>(), 0.0, 1e-9);
  EXPECT_NEAR(gradient[2].item<double>(), 1 / (tau * 0.21), 1e-9);
}

TEST(SimulateEvents, CountsFromTheResidueOfEachPixelsReference) {
  const float eps = 0.01F, tau = 0.3F;
  // Two pixels go from black by 3.4 thresholds; the reference of the second is 0.7 too high. Then both go on by one.
  const auto log_intensity = std::log(eps) + tau * torch::tensor({0.0F, 0.0F, 3.4F, 3.4F, 4.4F, 4.4F});
  const auto intensities = (log_intensity.exp() - eps).reshape({1, 3, 1, 2});
  const auto constants = repeat_constants({.eps = eps, .tau = tau, .sigma_w = 0.0F, .sigma_z = 0.0F}, 1, torch::kCPU);
  auto noise = draw_noise_like(intensities);
  noise.residue = torch::tensor({0.0F, 0.7F}).reshape({1, 1, 2});
  const auto events = simulate_events(intensities, constants, noise, EventModel::kReferenceAware);
  EXPECT_TRUE(torch::equal(events.flatten(), torch::tensor({3.0F, 2.0F, 1.0F, 1.0F})));
}

class SensorParity : public testing::TestWithParam<std::tuple<EventModel, bool>> {};

TEST_P(SensorParity, CountsTheSameEventsAsTheSensorWithoutNoise) {
  torch::manual_seed(3);
  constexpr size_t kHeight = 33, kWidth = 47;
  const auto views = torch::rand({1, 64, kHeight, kWidth}).square();
  const lightfield::LightField field(
      {8, 8, kHeight, kWidth}, std::vector<float>(views.data_ptr<float>(), views.data_ptr<float>() + views.numel()));
  const auto [event_model, black_first] = GetParam();
  auto codes = (torch::rand({5, 64}) > 0.7).to(torch::kFloat);
  if (black_first) codes[0].zero_();

  sensor::EventModelOptions options{.constants = {.sigma_w = 0.0F, .sigma_z = 0.0F}};
  options.model =
      event_model == EventModel::kQuantised ? sensor::EventModel::kQuantised : sensor::EventModel::kReferenceAware;
  const auto expected = sensor::simulate_events(to_codes(codes, 8, 8), field, options);
  ASSERT_TRUE(expected) << expected.error().text();
  const auto intensities = coded_intensities(views, codes);
  const auto events =
      simulate_events(intensities, noise_free(1), draw_noise_like(intensities), event_model).contiguous();

  ASSERT_EQ(static_cast<size_t>(events.numel()), expected->values.size());
  size_t different = 0;
  for (size_t i = 0; i < expected->values.size(); ++i) {
    different += std::lround(events.data_ptr<float>()[i]) != expected->values[i] ? 1 : 0;
  }
  EXPECT_LE(different, 3U);  // quotients within float rounding of a whole number
  EXPECT_GT(events.abs().sum().item<float>(), 100.0F);
}

INSTANTIATE_TEST_SUITE_P(Models, SensorParity,
                         testing::Combine(testing::Values(EventModel::kQuantised, EventModel::kReferenceAware),
                                          testing::Bool()));

TEST(SimulateEvents, DrawsNoiseOfTheGivenWidths) {
  torch::manual_seed(4);
  auto constants = repeat_constants({.tau = 0.01F, .sigma_w = 0.2F, .sigma_z = 0.0F}, 1, torch::kCPU);
  const auto dark = torch::full({1, 2, 200, 200}, 0.5F);
  const auto steps = simulate_events(dark, constants, draw_noise_like(dark), EventModel::kQuantised);
  // Rounding 20 g toward zero leaves a variance of 20^2 - E|20 g| + 1/3 for a standard normal g.
  EXPECT_NEAR(steps.std().item<double>(), std::sqrt(400.0 - 20.0 * std::sqrt(2.0 / M_PI) + 1.0 / 3.0), 0.3);
  EXPECT_NEAR(steps.mean().item<double>() * 0.01, 0.0, 0.004);
}

TEST(Patterns, AreBlackFirstAndBecomeBinaryAsTheScaleGrows) {
  torch::manual_seed(5);
  const Patterns patterns(4, PatternTie::kBlackFirst, torch::kCPU);
  EXPECT_EQ(patterns.codes(4.0).sizes(), (std::vector<int64_t>{4, 64}));
  EXPECT_EQ(patterns.codes(4.0)[0].abs().sum().item<float>(), 0.0F);
  EXPECT_GT((patterns.codes(4.0) - patterns.binary_codes()).abs().max().item<float>(), 0.1F);
  EXPECT_LT((patterns.codes(1e5) - patterns.binary_codes()).abs().mean().item<float>(), 0.01F);
  const auto codes = to_codes(patterns.binary_codes(), 8, 8);
  EXPECT_TRUE(torch::equal(to_tensor(codes, torch::kCPU), patterns.binary_codes()));
}

TEST(Patterns, ComplementaryOnesOpenEveryCellHalfTheTime) {
  torch::manual_seed(6);
  Patterns patterns(4, PatternTie::kComplementary, torch::kCPU);
  EXPECT_TRUE(torch::allclose(patterns.codes(7.0).sum(0), torch::full({64}, 2.0)));
  EXPECT_TRUE(torch::equal(patterns.binary_codes()[1], 1.0 - patterns.binary_codes()[0]));
  const auto wanted = torch::cat({torch::eye(64).slice(0, 0, 1), 1.0 - torch::eye(64).slice(0, 0, 1)}).repeat({2, 1});
  patterns.start_at(wanted);
  EXPECT_TRUE(torch::equal(patterns.binary_codes(), wanted));
}

TEST(Patterns, StartAtCodes) {
  torch::manual_seed(7);
  for (const auto tie : {PatternTie::kNone, PatternTie::kBlackFirst}) {
    auto wanted = (torch::rand({4, 64}) > 0.5).to(torch::kFloat);
    wanted[0].zero_();
    Patterns patterns(4, tie, torch::kCPU);
    patterns.start_at(wanted);
    EXPECT_TRUE(torch::equal(patterns.binary_codes(), wanted));
    Patterns more(6, tie, torch::kCPU);
    const auto discs = more.binary_codes().slice(0, 4).clone();
    more.start_at(wanted);
    EXPECT_TRUE(torch::equal(more.binary_codes(), torch::cat({wanted, discs})));
  }
}

}  // namespace
}  // namespace e2lf::learn
