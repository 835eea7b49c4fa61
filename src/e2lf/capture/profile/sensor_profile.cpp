// SPDX-License-Identifier: MIT
#include "e2lf/capture/profile/sensor_profile.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::capture {

namespace {

constexpr Choice<Orientation> kOrientations[] = {
    {"upright", {}}, {"turned", kTurned}, {"flipped-x", {true, false}}, {"flipped-y", {false, true}}};

}  // namespace

const char* orientation_name(const Orientation& orientation) {
  return word_of(orientation, kOrientations);
}

Result<Orientation> orientation_from_name(const std::string& name, const std::string& location) {
  return choice_of(name, kOrientations, "orientation of views", location);
}

namespace {

using enum PixelConstant;

struct KeyRange {
  const char* key;
  float low, high;  // range of the value
};

/// In the order of PixelConstant.
constexpr KeyRange kPixelKeys[] = {
    {"eps", 1e-6F, 1e3F},        {"receptor_rate_hz", 1e-3F, 1e9F}, {"amplifier_rate_hz", 1e-3F, 1e9F},
    {"leak", 0.0F, 0.5F},        {"threshold_on", 0.01F, 10.0F},    {"threshold_off", 0.01F, 10.0F},
    {"mismatch", 0.0F, 1.0F},    {"mismatch_each", 0.0F, 1.0F},     {"noise", 0.0F, 10.0F},
    {"shot_noise", 0.0F, 10.0F}, {"reset_span", 0.0F, 2.0F},        {"reset_offset", -10.0F, 10.0F},
    {"dark_off", 0.0F, 0.5F},    {"dark_on", 0.0F, 0.5F},           {"black_time_s", 0.0F, 1e3F},
    {"lit_time_s", 0.0F, 1e3F},
};
static_assert(std::size(kPixelKeys) == kNumPixelConstants);

constexpr float kMostSlope = 2.0F;  // slope of the logarithm of a transmission, from the centre to the edge

struct ValueWithUncertainty {
  float value = 0.0F, uncertainty = 0.0F;
};

Result<ValueWithUncertainty> read_constant(const Json& json, const std::string& location, const KeyRange& range) {
  if (json.is_null()) return fail(ErrorCode::kInvalidValue, location, "the constant is missing; give its value");
  ValueWithUncertainty result;
  std::string source;
  OptionReader reader(json, location);
  reader.read("value", result.value).read("uncertainty", result.uncertainty).read("source", source);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!(result.value >= range.low && result.value <= range.high)) {
    return fail(ErrorCode::kInvalidValue, location, result.value, " is out of range; give a value from ", range.low,
                " to ", range.high);
  }
  if (!(result.uncertainty >= 0.0F && result.uncertainty < 1.0F)) {
    return fail(ErrorCode::kInvalidValue, location, result.uncertainty,
                " is not a relative uncertainty; use a number of at least 0 and below 1");
  }
  return result;
}

Result<void> read_pixel(OptionReader constants, SensorProfile& camera) {
  for (size_t i = 0; i < kNumPixelConstants; ++i) {
    const char* key = kPixelKeys[i].key;
    E2LF_ASSIGN_OR_RETURN(const auto constant,
                          read_constant(constants.child(key), constants.child_location(key), kPixelKeys[i]));
    camera.pixel.values[i] = constant.value;
    camera.uncertainty.values[i] = constant.uncertainty;
  }
  camera.constants.eps = camera.pixel[kEps];
  camera.constants.tau = 0.5F * (camera.pixel[kThresholdOn] + camera.pixel[kThresholdOff]);
  return constants.finish();
}

constexpr std::pair<KeyRange, float SensorConstants::*> kPaperKeys[] = {
    {{"eps", 1e-6F, 1e3F}, &SensorConstants::eps},
    {{"tau", 0.01F, 10.0F}, &SensorConstants::tau},
    {{"sigma_w", 0.0F, 10.0F}, &SensorConstants::sigma_w},
    {{"sigma_z", 0.0F, 10.0F}, &SensorConstants::sigma_z},
};

Result<void> read_paper(OptionReader constants, SensorProfile& camera) {
  for (const auto& [range, field] : kPaperKeys) {
    E2LF_ASSIGN_OR_RETURN(const auto constant,
                          read_constant(constants.child(range.key), constants.child_location(range.key), range));
    camera.constants.*field = constant.value;
  }
  return constants.finish();
}

Result<void> read_transmission(const Json& json, const std::string& location, SensorProfile& camera) {
  if (json.is_null()) return {};
  std::string source;
  OptionReader reader(json, location);
  reader.read("value", camera.transmission).read("uncertainty", camera.transmission_uncertainty);
  reader.read("slope_x", camera.transmission_slope_x).read("slope_y", camera.transmission_slope_y);
  reader.read("source", source);
  E2LF_RETURN_IF_ERROR(reader.finish());
  for (const float share : camera.transmission) {
    if (share > 0.0F && share <= 100.0F) continue;
    return fail(ErrorCode::kInvalidValue, location, share, " is not a transmission; use numbers near 1");
  }
  for (const auto* slopes : {&camera.transmission_slope_x, &camera.transmission_slope_y}) {
    if (slopes->size() > camera.transmission.size()) {
      return fail(ErrorCode::kInvalidValue, location, "there are more slopes than transmissions; give one for each");
    }
    for (const float slope : *slopes) {
      if (std::abs(slope) <= kMostSlope) continue;
      return fail(ErrorCode::kInvalidValue, location, slope, " is not a slope of a transmission; use numbers near 0");
    }
  }
  return {};
}

Json json_numbers(const std::vector<float>& values) {
  Json json = Json::array();
  for (const float value : values) json.push_back(json_number(value));
  return json;
}

/// Returns 0 for a part that follows at once, and 1 for one that never does.
float lag(float rate_hz) {
  constexpr float kUsualRate = 30.0F;
  return kUsualRate / (kUsualRate + rate_hz);
}

}  // namespace

float transmission_at(const SensorProfile& camera, size_t n, float x, float y) {
  const auto entry = [n](const std::vector<float>& values, float otherwise) {
    return n < values.size() ? values[n] : otherwise;
  };
  const float slope = entry(camera.transmission_slope_x, 0.0F) * x + entry(camera.transmission_slope_y, 0.0F) * y;
  return entry(camera.transmission, 1.0F) * (slope == 0.0F ? 1.0F : std::exp(slope));
}

const char* pixel_constant_key(PixelConstant constant) {
  return kPixelKeys[static_cast<size_t>(constant)].key;
}

Result<SensorProfile> camera_from_json(const Json& json, const std::string& location) {
  SensorProfile camera;
  OptionReader reader(json, location + ": $");
  std::optional<std::string> views;
  reader.read("name", camera.name).read("event_model", camera.event_model).read("views", views);
  const Json& constants = reader.child("constants");
  const Json& transmission = reader.child("transmission");
  E2LF_RETURN_IF_ERROR(reader.finish());
  const std::string& model = camera.event_model;
  std::vector<std::string> known = words_of(kEventModels);
  known.emplace_back("pixel");
  if (std::ranges::find(known, model) == known.end()) {
    return fail(ErrorCode::kInvalidValue, reader.child_location("event_model"), "unknown event model \"", model,
                "\"; use ", join(known, " or "));
  }
  if (views) {
    E2LF_ASSIGN_OR_RETURN(camera.views, orientation_from_name(*views, reader.child_location("views")));
  }
  const OptionReader constants_reader(constants, reader.child_location("constants"));
  E2LF_RETURN_IF_ERROR(camera.is_pixel() ? read_pixel(constants_reader, camera) : read_paper(constants_reader, camera));
  E2LF_RETURN_IF_ERROR(read_transmission(transmission, reader.child_location("transmission"), camera));
  return camera;
}

Result<SensorProfile> read_camera(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
  return camera_from_json(json, path.string());
}

Json to_json(const SensorProfile& camera) {
  Json constants = Json::object();
  if (camera.is_pixel()) {
    for (size_t i = 0; i < kNumPixelConstants; ++i) {
      constants[kPixelKeys[i].key] = {{"value", json_number(camera.pixel.values[i])},
                                      {"uncertainty", json_number(camera.uncertainty.values[i])}};
    }
  } else {
    for (const auto& [range, field] : kPaperKeys) {
      constants[range.key] = {{"value", json_number(camera.constants.*field)}};
    }
  }
  Json json = {{"name", camera.name}, {"event_model", camera.event_model}, {"constants", constants}};
  if (!camera.transmission.empty()) {
    json["transmission"] = {{"value", json_numbers(camera.transmission)}};
    Json& transmission = json["transmission"];
    if (!camera.transmission_slope_x.empty()) transmission["slope_x"] = json_numbers(camera.transmission_slope_x);
    if (!camera.transmission_slope_y.empty()) transmission["slope_y"] = json_numbers(camera.transmission_slope_y);
    transmission["uncertainty"] = json_number(camera.transmission_uncertainty);
  }
  if (camera.views) json["views"] = orientation_name(*camera.views);
  return json;
}

SensorProfile without_noise(SensorProfile camera) {
  camera.constants.sigma_w = camera.constants.sigma_z = 0.0F;
  for (const PixelConstant constant : {kNoise, kShotNoise, kDarkOff, kDarkOn}) camera.pixel[constant] = 0.0F;
  return camera;
}

std::vector<float> conditioning_vector(const ConditioningSource& source, size_t num_patterns) {
  E2LF_REQUIRE(num_patterns >= 2, "at least two patterns make an event image");
  E2LF_REQUIRE(source.cycles >= 1, "counts are averaged over at least one cycle");
  const auto threshold = [](float tau) { return 4.0F * (tau / 0.3F - 1.0F); };
  const PixelConstants& pixel = source.values;
  std::vector<float> conditioning;
  if (source.pixel) {
    conditioning = {1.0F,
                    threshold(pixel[kThresholdOn]),
                    threshold(pixel[kThresholdOff]),
                    pixel[kNoise] / 0.1F,
                    0.0F,
                    pixel[kMismatch] / 0.1F,
                    pixel[kMismatchEach] / 0.1F,
                    pixel[kResetSpan],
                    pixel[kResetOffset] / 0.1F,
                    lag(pixel[kReceptorRate]),
                    lag(pixel[kAmplifierRate]),
                    pixel[kLeak] * 500.0F,
                    pixel[kShotNoise] / 0.1F,
                    pixel[kDarkOff] * 20.0F,
                    pixel[kDarkOn] * 20.0F};
  } else {
    const SensorConstants& paper = source.constants;
    const float tau = threshold(paper.tau);
    conditioning = {0.0F, tau, tau, paper.sigma_w / 0.1F, paper.sigma_z / 0.04F, 0.0F, 0.0F, source.residue};
    conditioning.resize(kNumFixedConditions - 1);
  }
  conditioning.push_back(cycles_condition(static_cast<float>(source.cycles)));
  E2LF_REQUIRE(conditioning.size() == kNumFixedConditions, "the conditioning vector has a fixed length");
  const auto transmission = [&](size_t k) { return k < source.transmission.size() ? source.transmission[k] : 1.0F; };
  for (size_t k = 1; k + 1 < num_patterns; ++k)
    conditioning.push_back(5.0F * (transmission(k) / transmission(0) - 1.0F));
  return conditioning;
}

std::vector<float> conditioning_vector(const SensorProfile& camera, size_t num_patterns, size_t cycles) {
  return conditioning_vector({.pixel = camera.is_pixel(),
                              .constants = camera.constants,
                              .values = camera.pixel,
                              .transmission = camera.transmission,
                              .cycles = cycles},
                             num_patterns);
}

}  // namespace e2lf::capture
