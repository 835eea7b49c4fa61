// SPDX-License-Identifier: MIT
#include "bench/program/camera_settings.h"

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"

namespace e2lf::bench {
namespace {

using capture::SensorProfile;
using enum capture::PixelConstant;

constexpr float kAtOnceHz = 1e9F;
constexpr double kEvk4EventsPerS = 1.066e9;

void make_fast(SensorProfile& camera) {
  camera.pixel[kReceptorRate] = camera.pixel[kAmplifierRate] = kAtOnceHz;
}

void make_equal(SensorProfile& camera) {
  camera.pixel[kMismatch] = camera.pixel[kMismatchEach] = 0.0F;
}

void make_silent(SensorProfile& camera) {
  camera = without_noise(std::move(camera));
}

void make_even(SensorProfile& camera) {
  camera.transmission.clear();
  camera.transmission_slope_x.clear();
  camera.transmission_slope_y.clear();
  camera.pixel[kLeak] = 0.0F;
}

}  // namespace

std::vector<CameraSetting> camera_settings(const SensorProfile& camera) {
  E2LF_REQUIRE(camera.is_pixel(), "the camera has physical pixels");
  std::vector<CameraSetting> settings;
  const auto add = [&](std::string name, const auto& change) {
    CameraSetting& setting = settings.emplace_back(CameraSetting{.name = std::move(name), .camera = camera});
    change(setting);
  };
  add("the camera", [](CameraSetting&) {});
  add("without a lag of its pixels", [](CameraSetting& s) { make_fast(s.camera); });
  add("without mismatch of thresholds", [](CameraSetting& s) { make_equal(s.camera); });
  add("without noise", [](CameraSetting& s) { make_silent(s.camera); });
  add("with an even aperture that closes fully", [](CameraSetting& s) { make_even(s.camera); });
  add("without any of these", [](CameraSetting& s) {
    make_fast(s.camera);
    make_equal(s.camera);
    make_silent(s.camera);
    make_even(s.camera);
  });
  for (const int us : {100, 300, 1000}) {
    add(cat("with a refractory period of ", us, " us"), [&](CameraSetting& s) { s.defects.refractory_us = us; });
  }
  for (const int hz : {1, 5}) {
    add(cat("with ", hz, " leak events per s and pixel"), [&](CameraSetting& s) { s.defects.leak_rate_hz = hz; });
  }
  add("with 0.1 % hot pixels", [](CameraSetting& s) { s.defects.hot_share = 0.001; });
  for (const int part : {1, 4, 16}) {
    add(cat("read out at ", part == 1 ? "" : "1/", part == 1 ? "" : std::to_string(part), part == 1 ? "" : " of ",
            "1.066 G events/s"),
        [&](CameraSetting& s) { s.readout_events_per_s = kEvk4EventsPerS / part; });
  }
  for (const int ms : {1, 3}) {
    add(cat("with a rise of the display over ", ms, " ms"), [&](CameraSetting& s) { s.rise_us = 1000 * ms; });
  }
  for (const size_t px : {1, 2, 4, 8}) {
    add(cat("of a scene that moves ", px, " px in a cycle"), [&](CameraSetting& s) { s.motion_px = px; });
  }
  return settings;
}

}  // namespace e2lf::bench
