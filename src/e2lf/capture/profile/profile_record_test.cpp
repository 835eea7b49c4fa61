// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/capture/measurement/recorded_setup.h"

namespace e2lf::capture {
namespace {

SensorProfile test_camera() {
  SensorProfile camera;
  camera.name = "caf\xc3\xa9";
  camera.event_model = "pixel";
  for (size_t i = 0; i < kNumPixelConstants; ++i) camera.pixel.values[i] = 0.03125F + 0.001F * static_cast<float>(i);
  camera.pixel[PixelConstant::kEps] = 0.01F;
  camera.transmission = {1.0F, 0.975F, 1.07F};
  camera.transmission_slope_x = {0.0F, 0.0485F, 0.0634F};
  return camera;
}

void expect_same(const SensorProfile& a, const SensorProfile& b) {
  EXPECT_EQ(to_json(a), to_json(b));
  EXPECT_EQ(a.pixel, b.pixel);
}

TEST(CameraRecord, ComesBackFromAHeaderAmongOtherLines) {
  HeaderLines header = setup_to_header({.camera = test_camera()});
  header.insert(header.begin(), {"date", "2026-01-01 00:00:00"});
  const auto setup = setup_from_header(header, "r.raw");
  ASSERT_TRUE(setup) << setup.error().text();
  ASSERT_TRUE(setup->camera);
  expect_same(*setup->camera, test_camera());
  EXPECT_FALSE(setup_from_header({{"date", "today"}}, "r.raw")->camera);
}

TEST(CameraRecord, ALineOfTheHeaderIsShortEnoughForReadersOfRaw) {
  EXPECT_LT(setup_to_header({.camera = test_camera()}).front().second.size(), 3000U);
}

TEST(CameraRecord, ComesBackFromAnArrayWithTheViews) {
  NpzArrays arrays;
  setup_to_arrays({.camera = test_camera(), .views = Orientation{true, false}}, arrays);
  const auto setup = setup_from_arrays(arrays, "e.npz");
  ASSERT_TRUE(setup) << setup.error().text();
  expect_same(*setup->camera, test_camera());
  EXPECT_EQ(setup->views, (Orientation{true, false}));
}

TEST(CameraRecord, RefusesWhatIsNoCameraWithItsPlace) {
  const auto text = setup_from_header({{"e2lf_camera", "{\"name\": 3}"}}, "r.raw");
  EXPECT_EQ(text.error().location.rfind("r.raw: e2lf_camera", 0), 0U) << text.error().location;
  const std::vector<float> numbers = {1.0F, 2.0F};
  EXPECT_EQ(setup_from_arrays({{"camera", make_npy<float>({2}, numbers)}}, "e.npz").error().code, ErrorCode::kShape);
}

TEST(ViewsRecord, ComesBackFromAHeader) {
  const HeaderLines header = setup_to_header({.views = kTurned});
  ASSERT_EQ(header, (HeaderLines{{"e2lf_views", "turned"}}));
  EXPECT_EQ(setup_from_header(header, "x")->views, kTurned);
  EXPECT_FALSE(setup_from_header({{"width", "4"}}, "x")->views);
  EXPECT_FALSE(setup_from_header({{"e2lf_views", "sideways"}}, "x").ok());
}

TEST(CameraRecord, KeepsHowTheViewsComeOut) {
  SensorProfile camera;
  EXPECT_FALSE(to_json(camera).contains("views"));
  camera.views = Orientation{false, true};
  EXPECT_EQ(camera_from_json(to_json(camera), "x").value().views, camera.views);
}

}  // namespace
}  // namespace e2lf::capture
