// SPDX-License-Identifier: MIT
#include "e2lf/eval/metrics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "testing/textured_plane.h"

namespace e2lf::eval {
namespace {

using lightfield::LightField;

LightField noise_light_field(const lightfield::Shape& shape, uint64_t seed) {
  LightField light_field(shape);
  const CounterRng rng(seed, 0);
  for (size_t i = 0; i < shape.size(); ++i) light_field.data()[i] = rng.uniform(i);
  return light_field;
}

TEST(Psnr, FollowsFromTheMeanSquaredError) {
  EXPECT_DOUBLE_EQ(psnr_from_mse(0.01), 20.0);
  EXPECT_EQ(psnr_from_mse(0), std::numeric_limits<double>::infinity());
  const std::vector<float> a{0.0F, 0.5F}, b{0.5F, 0.5F};
  EXPECT_DOUBLE_EQ(mean_squared_error(a, b), 0.125);
}

TEST(Compare, ViewsOfMemoryAreMeasuredAsTheirCopies) {
  const LightField truth = noise_light_field({4, 4, 30, 40, 1}, 1), other = noise_light_field({4, 4, 30, 40, 1}, 2);
  const auto crop = [](const LightField& whole) {
    LightFieldView view = whole;
    return LightFieldView(&view[1][0][3][5][0], {2, 2, 20, 15, 1}, {view.strides[0], 2 * view.strides[1], 40, 2, 1});
  };
  const LightField a(crop(truth)), b(crop(other));
  const auto of_views = compare(crop(truth), crop(other)).value(), of_copies = compare(a, b).value();
  EXPECT_EQ(of_views.mean.psnr_db, of_copies.mean.psnr_db);
  EXPECT_EQ(of_views.mean.ssim_gaussian, of_copies.mean.ssim_gaussian);
  EXPECT_EQ(of_views.epi.rms, of_copies.epi.rms);
  EXPECT_EQ(best_gain(crop(truth), crop(other)), best_gain(a, b));
  EXPECT_EQ(best_tone(crop(truth), crop(other)).black, best_tone(a, b).black);
}

TEST(Compare, AveragesTheDecibelsOfTheViews) {
  const LightField truth({1, 2, 12, 13, 1});
  LightField reconstruction(truth.shape());
  for (float& value : reconstruction.view(0, 0)) value = 0.5F;
  for (float& value : reconstruction.view(0, 1)) value = 0.125F;
  const auto result = compare(truth, reconstruction).value();
  ASSERT_EQ(result.views.size(), 2U);
  EXPECT_EQ(result.views[1].view_x, 1U);
  EXPECT_NEAR(result.views[0].metrics.psnr_db, -20 * std::log10(0.5), 1e-9);
  EXPECT_NEAR(result.views[1].metrics.psnr_db, -20 * std::log10(0.125), 1e-9);
  EXPECT_NEAR(result.mean.psnr_db, -20 * std::log10(0.25), 1e-9);
}

TEST(Compare, ClampsTheReconstructionUnlessToldNotTo) {
  LightField truth({1, 1, 11, 11, 1}), reconstruction({1, 1, 11, 11, 1});
  for (float& value : truth.data()) value = 1.0F;
  for (float& value : reconstruction.data()) value = 1.5F;
  EXPECT_EQ(compare(truth, reconstruction)->mean.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(compare(truth, reconstruction, /*clamp=*/false)->mean.psnr_db, -20 * std::log10(0.5), 1e-9);
}

TEST(Compare, AveragesTheSsimOfColourChannels) {
  const lightfield::Shape grey{1, 1, 14, 17, 1}, colour{1, 1, 14, 17, 3};
  LightField truth(colour), reconstruction(colour);
  double uniform = 0, gaussian = 0;
  for (size_t channel = 0; channel < 3; ++channel) {
    const auto a = noise_light_field(grey, channel), b = noise_light_field(grey, 10 + channel);
    for (size_t i = 0; i < grey.size(); ++i) {
      truth.data()[3 * i + channel] = a.data()[i];
      reconstruction.data()[3 * i + channel] = b.data()[i];
    }
    uniform += ssim(a.data(), b.data(), 14, 17, SsimWindow::kUniform7) / 3;
    gaussian += ssim(a.data(), b.data(), 14, 17, SsimWindow::kGaussian11) / 3;
  }
  const auto result = compare(truth, reconstruction).value();
  EXPECT_NEAR(result.mean.ssim_uniform7, uniform, 1e-12);
  EXPECT_NEAR(result.mean.ssim_gaussian, gaussian, 1e-12);
}

TEST(Compare, DoesNotDependOnTheNumberOfThreads) {
  const auto truth = noise_light_field({3, 3, 20, 21, 1}, 1), reconstruction = noise_light_field({3, 3, 20, 21, 1}, 2);
  set_num_threads(1);
  const auto one = compare(truth, reconstruction).value();
  set_num_threads(3);
  const auto three = compare(truth, reconstruction).value();
  set_num_threads(0);
  EXPECT_EQ(one.mean.psnr_db, three.mean.psnr_db);
  EXPECT_EQ(one.mean.ssim_uniform7, three.mean.ssim_uniform7);
  EXPECT_EQ(one.mean.ssim_gaussian, three.mean.ssim_gaussian);
}

TEST(Compare, RefusesDifferentShapes) {
  const auto result = compare(LightField({8, 8, 20, 20, 1}), LightField({8, 8, 20, 21, 1}));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kShape);
  EXPECT_NE(result.error().message.find("[8, 8, 20, 21, 1]"), std::string::npos);
}

TEST(Compare, RefusesViewsSmallerThanTheWindow) {
  const LightField tiny({1, 1, 10, 40, 1});
  ASSERT_FALSE(compare(tiny, tiny));
  EXPECT_EQ(compare(tiny, tiny).error().code, ErrorCode::kShape);
}

TEST(Compare, NamesTheViewThatHoldsNan) {
  const LightField truth({2, 3, 11, 11, 1});
  LightField reconstruction(truth.shape());
  reconstruction.at(1, 2, 5, 5) = std::numeric_limits<float>::quiet_NaN();
  const auto result = compare(truth, reconstruction);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(result.error().location, "view (1, 2)");
}

}  // namespace

namespace {

using lightfield::LightField;

TEST(BestGain, UndoesAFactor) {
  const LightField truth({1, 1, 1, 3}, std::vector{0.25F, 0.5F, 1.0F});
  const LightField half({1, 1, 1, 3}, std::vector{0.125F, 0.25F, 0.5F});
  EXPECT_FLOAT_EQ(best_gain(truth, half), 2.0F);
}

TEST(BestGain, IsTheProjection) {
  const LightField truth({1, 1, 1, 2}, std::vector{1.0F, 0.0F});
  const LightField field({1, 1, 1, 2}, std::vector{1.0F, 1.0F});
  EXPECT_FLOAT_EQ(best_gain(truth, field), 0.5F);
}

TEST(BestGain, OfBlackIsZero) {
  const LightField truth({1, 1, 1, 2}, std::vector{1.0F, 0.5F});
  EXPECT_EQ(best_gain(truth, LightField({1, 1, 1, 2})), 0.0F);
}

TEST(BestTone, UndoesGainAndBlackLevel) {
  const LightField truth({1, 1, 1, 3}, std::vector{0.25F, 0.5F, 1.0F});
  const LightField toned({1, 1, 1, 3}, std::vector{0.1F, 0.6F, 1.6F});  // (truth - 0.2) * 2
  const Tone tone = best_tone(truth, toned);
  EXPECT_FLOAT_EQ(tone.gain, 0.5F);
  EXPECT_FLOAT_EQ(tone.black, -0.4F);
  EXPECT_EQ(best_tone(truth, LightField({1, 1, 1, 3})).gain, 0.0F);
}

/// Every value of view (r, c) is r * step_y + c * step_x.
LightField ramp(float step_y, float step_x) {
  LightField light_field({3, 3, 4, 5, 1});
  for (size_t view = 0; view < 9; ++view) {
    for (float& value : light_field.view(view / 3, view % 3)) {
      value = step_y * static_cast<float>(view / 3) + step_x * static_cast<float>(view % 3);
    }
  }
  return light_field;
}

TEST(EpiError, MeasuresChangesFromViewToView) {
  // Errors of the changes: 0.1 in rows of views, 0.2 in columns, as many of each; the true changes are 0.25 and 0.
  const EpiError error = epi_error(ramp(0, 0.25F), ramp(0.2F, 0.15F), false);
  EXPECT_NEAR(error.rms, std::sqrt((0.01 + 0.04) / 2), 1e-7);
  EXPECT_NEAR(error.relative, std::sqrt((0.01 + 0.04) / 0.0625), 1e-6);
}

TEST(EpiError, IgnoresWhatIsWrongInEveryView) {
  LightField shifted = ramp(0.125F, 0.25F);
  for (float& value : shifted.data()) value += 0.5F;
  EXPECT_EQ(epi_error(ramp(0.125F, 0.25F), shifted, false).rms, 0);
}

TEST(EpiError, IsOneForTheSamePictureInAllViews) {
  const LightField truth = lightfield::render_light_field(lightfield::textured_plane_scene(1), {3, 3, 16, 16, 1});
  LightField same(truth.shape());
  for (size_t view = 0; view < 9; ++view) {
    std::copy(truth.view(1, 1).begin(), truth.view(1, 1).end(), same.view(view / 3, view % 3).begin());
  }
  EXPECT_DOUBLE_EQ(epi_error(truth, same, true).relative, 1);
}

TEST(EpiError, ClampsTheReconstructionWhenAsked) {
  const LightField truth = ramp(0, 0);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), true).rms, 0);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), false).rms, 1);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), false).relative, std::numeric_limits<double>::infinity());
}

TEST(EpiError, IsZeroWithoutNeighbours) {
  LightField one({1, 1, 2, 2, 1}), other({1, 1, 2, 2, 1});
  other.at(0, 0, 0, 0) = 1;
  EXPECT_EQ(epi_error(one, other, true).rms, 0);
}

}  // namespace

}  // namespace e2lf::eval
