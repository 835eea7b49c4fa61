// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

#include "e2lf/files/npy.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {
namespace {

namespace fs = std::filesystem;

/// Results of the paper's software on its test light field.
class OfficialSoftware : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("E2LF_DATA");
    folder_ = fs::path(data != nullptr ? data : "") / "official";
    if (data == nullptr || !fs::exists(folder_)) GTEST_SKIP() << "E2LF_DATA/official is absent";
    auto light_field = lightfield::read_light_field(folder_ / "Lego_Knights");
    ASSERT_TRUE(light_field) << light_field.error().text();
    light_field_ = *std::move(light_field);
    const auto file = read_safetensors(folder_ / "AcqNet.safetensors");
    ASSERT_TRUE(file) << file.error().text();
    codes_ = capture::Codes(4, 8, 8);
    codes_.values = file->find("mask_4x64", "AcqNet").value()->to_float("mask_4x64").value();
    ASSERT_EQ(codes_.values.size(), 4U * 64);
  }

  fs::path folder_;
  lightfield::LightField light_field_;
  capture::Codes codes_;
};

TEST_F(OfficialSoftware, CodedIntensitiesAgree) {
  const auto golden = read_npy(folder_ / "golden_I_4x64x64_crop_y224_x224_f32.npy").value().to_float("golden").value();
  const auto intensities = coded_intensities(codes_, light_field_);
  ASSERT_TRUE(intensities);
  for (size_t n = 0, i = 0; n < 4; ++n) {
    for (size_t y = 224; y < 288; ++y) {
      for (size_t x = 224; x < 288; ++x, ++i) ASSERT_NEAR(intensities->image(n)[y * 512 + x], golden[i], 1e-6);
    }
  }
}

TEST_F(OfficialSoftware, NoiseFreeEventsAgree) {
  const auto golden = read_npy(folder_ / "golden_noisefree_events_3x512x512_i8.npy").value().to_float("golden").value();
  EventModelOptions options;
  options.constants.sigma_w = options.constants.sigma_z = 0;
  const auto images = simulate_events(codes_, light_field_, options);
  ASSERT_TRUE(images);
  ASSERT_EQ(golden.size(), images->values.size());
  int different = 0;
  for (size_t i = 0; i < golden.size(); ++i) different += static_cast<int16_t>(golden[i]) != images->values[i] ? 1 : 0;
  RecordProperty("different", different);
  EXPECT_LE(different, 10);
}

TEST_F(OfficialSoftware, NoisyEventDensityAgrees) {
  const auto images = simulate_events(codes_, light_field_, {});
  ASSERT_TRUE(images);
  double events = 0;
  for (const int16_t count : images->values) events += std::abs(count);
  EXPECT_NEAR(events / (512 * 512), 8.48, 0.02);  // the release's figure at its default noise
}

}  // namespace
}  // namespace e2lf::sensor
