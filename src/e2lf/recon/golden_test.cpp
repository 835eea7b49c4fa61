// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/recon/inversion.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::recon {
namespace {

namespace fs = std::filesystem;

constexpr size_t kSide = 512;   // of the test scene
constexpr size_t kGolden = 64;  // side of the golden crops

/// Data and outputs of the paper's software.
class OfficialSoftware : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("E2LF_DATA");
    folder_ = fs::path(data != nullptr ? data : "") / "official";
    if (data == nullptr || !fs::exists(folder_)) GTEST_SKIP() << "E2LF_DATA/official is absent";
    auto model = model::import_release(folder_);
    ASSERT_TRUE(model) << model.error().text();
    model_ = *std::move(model);
  }

  [[nodiscard]] capture::EventImages scene_events() const {
    const auto counts =
        read_npy(folder_ / "golden_noisefree_events_3x512x512_i8.npy").value().to_float("golden").value();
    capture::EventImages images(3, kSide, kSide);
    images.values.assign(counts.begin(), counts.end());
    return images;
  }

  [[nodiscard]] lightfield::LightField scene() const {
    return lightfield::read_light_field(folder_ / "Lego_Knights").value();
  }

  /// The release's reconstruction of the 64x64 pixels from (y0, x0) equals the golden one. Only what those pixels see
  /// is reconstructed, with true borders where the image ends.
  void expect_golden(const capture::EventImages& images, const fs::path& golden_path, size_t y0, size_t x0) const {
    const size_t reach = model::receptive_radius(model_.network);
    const size_t top = y0 - std::min(y0, reach), left = x0 - std::min(x0, reach);
    const size_t bottom = std::min(y0 + kGolden + reach, images.height);
    const size_t right = std::min(x0 + kGolden + reach, images.width);
    capture::EventImages part(images.count, bottom - top, right - left);
    for (size_t k = 0; k < part.count; ++k) {
      for (size_t y = 0; y < part.height; ++y) {
        const auto row = images.image(k).subspan((top + y) * images.width + left, part.width);
        std::copy(row.begin(), row.end(), part.image(k).begin() + static_cast<ptrdiff_t>(y * part.width));
      }
    }
    const auto reconstructor = Reconstructor::create(model_, {engine::Precision::kFloat32});
    ASSERT_TRUE(reconstructor) << reconstructor.error().text();
    const auto light_field = reconstructor->reconstruct(part);
    ASSERT_TRUE(light_field) << light_field.error().text();

    const auto golden = read_npy(folder_ / golden_path).value().to_float(golden_path.string()).value();
    ASSERT_EQ(golden.size(), 64 * kGolden * kGolden);
    double largest = 0;
    for (size_t i = 0; i < golden.size(); ++i) {
      const size_t view = i / (kGolden * kGolden), y = i / kGolden % kGolden, x = i % kGolden;
      const float value = light_field->at(view / 8, view % 8, y0 - top + y, x0 - left + x);
      largest = std::max(largest, std::abs(double{value} - double{golden[i]}));
    }
    EXPECT_LE(largest, 1e-4);
  }

  fs::path folder_;
  model::Model model_;
};

TEST_F(OfficialSoftware, NoiseFreeReconstructionAgrees) {
  expect_golden(scene_events(), "golden_noisefree_recon_64x64x64_crop_y224_x224_f32.npy", 224, 224);
}

TEST_F(OfficialSoftware, ReconstructionOfTheRealCaptureAgrees) {
  const auto file = capture::read_event_images(folder_ / "Animals");
  ASSERT_TRUE(file) << file.error().text();
  expect_golden(file->cycles.at(0), "Animals/golden_recon_64x64x64_crop_y328_x608_f32.npy", 328, 608);
  expect_golden(file->cycles.at(0), "Animals/golden_recon_64x64x64_crop_y0_x0_f32.npy", 0, 0);
}

TEST_F(OfficialSoftware, EveryCodedIntensityOfTheTestSceneLiesWithinOneThreshold) {
  const double eps = 0.01, tau = 0.30;
  const auto level = [&](double value) { return std::log(value + eps) / tau; };
  const auto light_field = scene();
  const auto images = scene_events();
  const auto counted = invert_events(images, {});
  const auto estimate = invert_events(images, {.centred = true});
  ASSERT_TRUE(counted);
  ASSERT_TRUE(estimate);
  double squared_error = 0;
  for (size_t n = 1; n < 4; ++n) {
    for (size_t pixel = 0; pixel < images.image_size(); ++pixel) {
      float sum = 0;
      for (size_t view = 0; view < 64; ++view) {
        sum += model_.codes->pattern(n)[view] * light_field.data()[view * images.image_size() + pixel];
      }
      // In thresholds; a ten-thousandth is what float32 logarithms may add.
      const double truth = level(double{sum} / 64);
      ASSERT_NEAR(truth, level(counted->image(n)[pixel]), 1 + 1e-4);
      squared_error += std::pow(level(estimate->image(n)[pixel]) - truth, 2);
    }
  }
  // Uniform within one threshold would be 0.29; transitions without events leave either side open.
  EXPECT_LE(std::sqrt(squared_error / (3 * kSide * kSide)), 0.5);
}

TEST_F(OfficialSoftware, InversionWithoutANetworkShowsTheTestScene) {
  const auto truth = scene();
  capture::SensorConstants constants;
  constants.sigma_w = constants.sigma_z = 0;
  const auto estimate = reconstruct_by_inversion(scene_events(), *model_.codes, constants);
  ASSERT_TRUE(estimate) << estimate.error().text();
  double squared_error = 0;
  for (size_t i = 0; i < truth.data().size(); ++i) {
    squared_error += std::pow(std::clamp(estimate->data()[i], 0.0F, 1.0F) - truth.data()[i], 2);
  }
  EXPECT_GT(-10 * std::log10(squared_error / static_cast<double>(truth.data().size())), 22.0);
}

TEST_F(OfficialSoftware, DarkCaptureIsBrightened) {
  const auto file = capture::read_event_images(folder_ / "Animals");
  ASSERT_TRUE(file);
  const auto estimate = reconstruct_by_inversion(file->cycles.at(0), *model_.codes, model_.constants);
  ASSERT_TRUE(estimate) << estimate.error().text();
  EXPECT_GT(auto_gain(*estimate), 2.0F);  // the release multiplies this dark capture by 5
}

}  // namespace
}  // namespace e2lf::recon
