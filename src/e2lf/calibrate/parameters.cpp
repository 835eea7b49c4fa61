// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/calibrate/fit.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;
using capture::SensorProfile;

constexpr double kLeastValue = 1e-6;  // the smallest value of a number that is fitted as a logarithm
constexpr double kLeastSpread = 1e-4;

struct Spread {
  capture::PixelConstant constant;
  bool is_logarithm;
  double spread;
};

constexpr Spread kSpreads[] = {
    {kReceptorRate, true, 0.5}, {kAmplifierRate, true, 0.7}, {kLeak, true, 0.7},          {kThresholdOn, true, 0.2},
    {kThresholdOff, true, 0.2}, {kMismatch, true, 0.5},      {kMismatchEach, true, 1},    {kNoise, true, 0.5},
    {kShotNoise, true, 0.7},    {kResetSpan, false, 0.3},    {kResetOffset, false, 0.05}, {kDarkOff, true, 0.7},
    {kDarkOn, true, 0.7},
};
constexpr double kTransmissionSpread = 0.1, kSlopeSpread = 0.1;

/// Returns the standard deviation of a constant whose relative 95 % range is stated by a camera.
double spread_of(const Spread& each, const capture::SensorProfile& start) {
  const auto relative = static_cast<double>(start.uncertainty[each.constant]);
  if (relative <= 0.0) return each.spread;
  return relative / kQuantile * (each.is_logarithm ? 1.0 : std::abs(start.pixel[each.constant]));
}

std::vector<Parameter> all_parameters(size_t num_lit, const capture::SensorProfile& start) {
  std::vector<Parameter> parameters;
  for (const Spread& each : kSpreads) {
    const double spread = std::max(spread_of(each, start), kLeastSpread);
    parameters.push_back({nullptr, static_cast<size_t>(each.constant), each.is_logarithm, spread,
                          capture::pixel_constant_key(each.constant)});
  }
  const double stated = start.transmission_uncertainty / kQuantile;
  const double transmission = stated > 0.0 ? stated : kTransmissionSpread, slope = stated > 0.0 ? stated : kSlopeSpread;
  for (size_t n = 1; n < num_lit; ++n) {
    parameters.push_back({&SensorProfile::transmission, n, true, transmission, cat("transmission[", n, "]")});
    parameters.push_back({&SensorProfile::transmission_slope_x, n, false, slope, cat("transmission.slope_x[", n, "]")});
    parameters.push_back({&SensorProfile::transmission_slope_y, n, false, slope, cat("transmission.slope_y[", n, "]")});
  }
  return parameters;
}

}  // namespace

double Parameter::get(const capture::SensorProfile& camera) const {
  if (list == nullptr) return camera.pixel.values[index];
  const std::vector<float>& values = camera.*list;
  return index < values.size() ? values[index] : is_transmission() ? 1.0 : 0.0;
}

void Parameter::set(capture::SensorProfile& camera, double value) const {
  if (list == nullptr) {
    camera.pixel.values[index] = static_cast<float>(value);
    return;
  }
  std::vector<float>& values = camera.*list;
  if (values.size() <= index) values.resize(index + 1, is_transmission() ? 1.0F : 0.0F);
  values[index] = static_cast<float>(value);
}

Result<std::vector<Parameter>> fit_parameters(size_t num_lit, const capture::SensorProfile& start,
                                              const std::vector<std::string>& held) {
  std::vector<Parameter> parameters = all_parameters(num_lit, start);
  std::vector<std::string> keys;
  for (const Parameter& each : parameters) keys.push_back(each.key);
  for (const std::string& key : held) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      return fail(ErrorCode::kInvalidValue, "", "there is no constant \"", key, "\"; ", suggestion(key, keys));
    }
    std::erase_if(parameters, [&](const Parameter& each) { return each.key == key; });
  }
  return parameters;
}

Eigen::VectorXd to_vector(const std::vector<Parameter>& parameters, const capture::SensorProfile& camera) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  Eigen::Index i = 0;
  for (const Parameter& each : parameters) {
    const double value = each.get(camera);
    values[i++] = each.is_logarithm ? std::log(std::max(value, kLeastValue)) : value;
  }
  return values;
}

void from_vector(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                 capture::SensorProfile& camera) {
  Eigen::Index i = 0;
  for (const Parameter& each : parameters) {
    const double value = values[i++];
    each.set(camera, each.is_logarithm ? std::exp(value) : value);
  }
}

}  // namespace e2lf::calibrate
