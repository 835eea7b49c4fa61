// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/calibrate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "e2lf/base/text.h"

namespace e2lf::calibrate {
namespace {

constexpr double kDetermined = 0.5;  // ratio of standard deviation to spread below which a constant is determined
// Areas found by search have systematic errors (selection by noise, textures, parallax), so that more pixels of a row
// contain no more information.
constexpr double kFoundRowSamples = 400.0;
constexpr double kNearBound = 1e-3;
constexpr size_t kGroups = 8;
constexpr double kShareOfOwnError = 0.1;  // the share of the misfit of a row that may be due to the model's own error
constexpr float kMostUncertainty = 0.95F;
constexpr size_t kLeastAreas = 4;

/// Returns the group of squares that is left out together; neighbours are in different groups.
size_t group_of(size_t square_y, size_t square_x) {
  return (square_y * 3 + square_x / 2) % kGroups;
}

Eigen::VectorXd spreads_of(const std::vector<Parameter>& parameters) {
  Eigen::VectorXd spreads(static_cast<Eigen::Index>(parameters.size()));
  for (size_t i = 0; i < parameters.size(); ++i) spreads[static_cast<Eigen::Index>(i)] = parameters[i].spread;
  return spreads;
}

using AreaKey = std::array<size_t, 3>;

AreaKey key_of(const Area& area) {
  return {area.scene, area.row, area.cell};
}

/// Returns the standard deviations from the curvature, with the starting values as an additional measurement.
Eigen::VectorXd deviations(const Eigen::MatrixXd& information, const Eigen::VectorXd& spreads) {
  Eigen::MatrixXd matrix = information;
  matrix.diagonal() += spreads.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd inverse = matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return inverse.diagonal().cwiseMax(0.0).cwiseSqrt();
}

/// Returns the keys of the constants that the data do not determine. The least determined one is removed repeatedly
/// until the rest is determined.
std::vector<std::string> undetermined(std::vector<Parameter> parameters, Eigen::MatrixXd information) {
  std::vector<std::string> keys;
  while (!parameters.empty()) {
    const Eigen::VectorXd spreads = spreads_of(parameters);
    Eigen::Index worst = 0;
    const double ratio = deviations(information, spreads).cwiseQuotient(spreads).maxCoeff(&worst);
    if (ratio <= kDetermined) break;
    keys.push_back(parameters[static_cast<size_t>(worst)].key);
    parameters.erase(parameters.begin() + worst);
    std::vector<Eigen::Index> rest;
    for (Eigen::Index i = 0; i < information.rows(); ++i) {
      if (i != worst) rest.push_back(i);
    }
    information = Eigen::MatrixXd(information(rest, rest));
  }
  return keys;
}

Result<void> check(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                   const capture::SensorProfile& start) {
  E2LF_RETURN_IF_ERROR(check_scenes(scenes));
  const size_t transitions = scenes.front().cycles.front().count;
  if (codes.num_patterns != transitions + 1) {
    return fail(ErrorCode::kShape, "", codes.num_patterns, " patterns do not make ", transitions,
                " transitions; give the patterns of these events");
  }
  if (!capture::is_black_first(codes)) {
    return fail(ErrorCode::kInvalidValue, "", "a calibration needs patterns that begin with black; use others");
  }
  if (!start.is_pixel()) {
    return fail(ErrorCode::kInvalidValue, "", "the starting camera is of the event model ", start.event_model,
                "; start with a camera of the model pixel");
  }
  return {};
}

/// Performs one calibration.
class Calibrator {
 public:
  /// Finds the flat areas of all scenes.
  Calibrator(const std::vector<StillScene>& scenes, const std::vector<PixelState>& states, const OpenShares& shares,
             const capture::SensorProfile& start, const CalibrationOptions& options)
      : scenes_(scenes), shares_(shares), start_(start), options_(options) {
    for (const StillScene& scene : scenes) {
      flat_.push_back(options.is_even ? even_areas(scene, states) : find_flat_areas(scene, states));
    }
    areas_ = areas_where([](size_t, size_t) { return true; });
  }

  [[nodiscard]] const std::vector<Area>& areas() const { return areas_; }

  [[nodiscard]] size_t num_flat_pixels() const {
    ptrdiff_t sum = 0;
    for (const FlatAreas& flat : flat_) sum += std::count(flat.is_flat.begin(), flat.is_flat.end(), true);
    return static_cast<size_t>(sum);
  }

  /// Returns the starting camera, with the brightness of each area that fits it.
  [[nodiscard]] Model first_model() const { return {start_, fit_brightness(start_, shares_, areas_)}; }

  [[nodiscard]] Fit fit(const std::vector<Parameter>& parameters, const Model& from, FitOptions fit_options,
                        size_t part) const {
    if (options_.progress) {
      fit_options.progress = [this, part](size_t done, size_t total) {
        options_.progress(100 * part + 100 * done / total, kParts * 100);
      };
    }
    return fit_camera(parameters, shares_, areas_, start_, from, fit_options);
  }

  /// Returns the standard deviations of the parameters if parts of the picture are left out: a jackknife with one step
  /// each, in the linear approximation at the result.
  [[nodiscard]] Eigen::VectorXd deviations_over_picture(const std::vector<Parameter>& parameters, const Model& whole,
                                                        const FitOptions& fit_options) const {
    std::map<AreaKey, double> brightness;
    for (size_t a = 0; a < areas_.size(); ++a) brightness[key_of(areas_[a])] = whole.brightness[a];
    std::vector<Eigen::VectorXd> moves;
    for (size_t group = 0; group < kGroups; ++group) {
      if (options_.progress) options_.progress(300 + 100 * group / kGroups, kParts * 100);
      const auto areas = areas_where([&](size_t y, size_t x) { return group_of(y, x) != group; });
      if (areas.empty()) continue;
      Model model{whole.camera, {}};
      for (const Area& area : areas) model.brightness.push_back(brightness.at(key_of(area)));
      moves.push_back(next_move(parameters, shares_, areas, start_, model, fit_options));
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size())), squares = mean;
    for (const auto& each : moves) mean += each / static_cast<double>(moves.size());
    for (const auto& each : moves) squares += (each - mean).cwiseAbs2();
    const auto count = static_cast<double>(moves.size());
    return (squares * (count - 1.0) / std::max(count, 1.0)).cwiseSqrt();
  }

  static constexpr size_t kParts = 4;

 private:
  [[nodiscard]] std::vector<Area> areas_where(const SquareFilter& is_counted) const {
    std::vector<Area> all;
    for (size_t c = 0; c < scenes_.size(); ++c) {
      std::ranges::move(collect_areas(scenes_[c], c, flat_[c], is_counted), std::back_inserter(all));
    }
    return all;
  }

  const std::vector<StillScene>& scenes_;
  const OpenShares& shares_;
  const capture::SensorProfile& start_;
  const CalibrationOptions& options_;
  std::vector<FlatAreas> flat_;
  std::vector<Area> areas_;
};

/// The parameters that the data determine, with their uncertainty.
struct Solution {
  capture::SensorProfile camera;
  std::vector<Parameter> determined;
  Eigen::VectorXd deviation;  ///< of each determined parameter
};

/// Fits all parameters; then again with the deviance divided by the misfit found. Where areas are even, the second fit
/// gives more weight to many samples if the model is accurate enough, and a third one omits the parameters that are not
/// determined. Where areas were found by search, the receptor's rate keeps its value: the result would mostly follow
/// from the remaining texture, and an error in it changes the brightness. The prior decides how far the others move.
Solution solve(const Calibrator& calibrator, std::vector<Parameter> all, bool is_even) {
  const std::string receptor_rate = capture::pixel_constant_key(capture::PixelConstant::kReceptorRate);
  if (!is_even) std::erase_if(all, [&](const Parameter& each) { return each.key == receptor_rate; });
  const Model first = calibrator.first_model();
  FitOptions options{.most_row_samples = is_even ? kRowSamples : kFoundRowSamples};
  Fit fit = calibrator.fit(all, first, options, 0);
  const double trusted = kShareOfOwnError * fit.misfit.row_samples;
  if (is_even && trusted > options.most_row_samples) options.most_row_samples = trusted;
  options.misfit = fit.misfit.weighted;
  fit = calibrator.fit(all, fit.model, options, 1);
  const std::vector<std::string> open = is_even ? undetermined(all, fit.information) : std::vector<std::string>();
  std::vector<Parameter> determined;
  for (const Parameter& each : all) {
    if (std::find(open.begin(), open.end(), each.key) == open.end()) {
      determined.push_back(each);
    } else {
      each.set(fit.model.camera, each.get(first.camera));
    }
  }
  if (!open.empty()) fit = calibrator.fit(determined, fit.model, options, 2);
  const Eigen::VectorXd deviation = deviations(fit.information, spreads_of(determined))
                                        .cwiseMax(calibrator.deviations_over_picture(determined, fit.model, options));
  return {fit.model.camera, std::move(determined), deviation};
}

/// Returns the estimate of a constant from its fitted value and standard deviation.
Estimate estimate_of(const Parameter& parameter, const capture::SensorProfile& camera, double deviation,
                     bool is_determined) {
  Estimate result{parameter.key, parameter.get(camera), 0.0, 0.0, is_determined};
  const double width = kQuantile * deviation;
  result.low = parameter.is_logarithm ? result.value * std::exp(-width) : result.value - width;
  result.high = parameter.is_logarithm ? result.value * std::exp(width) : result.value + width;
  return result;
}

/// Returns warnings about suspicious constants: those that left their prior uncertainty or ended at a bound.
std::vector<std::string> warnings_of(const std::vector<Parameter>& parameters, const capture::SensorProfile& start,
                                     const capture::SensorProfile& found) {
  std::vector<std::string> warnings;
  const Eigen::VectorXd before = to_vector(parameters, start), after = to_vector(parameters, found);
  for (size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& each = parameters[i];
    const double value = each.get(found);
    const double spreads =
        std::abs(after[static_cast<Eigen::Index>(i)] - before[static_cast<Eigen::Index>(i)]) / each.spread;
    if (spreads > kQuantile) {
      warnings.push_back(cat(each.key, " went from ", static_cast<float>(each.get(start)), " to ",
                             static_cast<float>(value),
                             ", which is outside the uncertainty of the starting camera; check the input, or hold the "
                             "constant"));
    }
    for (const Bound& bound : kFitBounds) {
      if (each.list != nullptr || each.index != static_cast<size_t>(bound.constant)) continue;
      const bool is_low = each.is_logarithm ? value < kNearBound * each.get(start) : value <= bound.low;
      if (!is_low && value < bound.high) continue;
      warnings.push_back(cat(each.key, " ends at the bound ", is_low ? bound.low : bound.high,
                             ": the input contradicts the model; hold the constant"));
    }
  }
  return warnings;
}

void note_uncertainty(const std::vector<Parameter>& parameters, const Eigen::VectorXd& deviation,
                      capture::SensorProfile& camera) {
  for (size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    const auto width = static_cast<float>(kQuantile * deviation[static_cast<Eigen::Index>(i)]);
    if (parameter.list == nullptr) {
      const auto value = static_cast<float>(std::abs(parameter.get(camera)));
      const float relative = parameter.is_logarithm ? width : width / std::max(value, 1e-6F);
      camera.uncertainty.values[parameter.index] = std::min(relative, kMostUncertainty);
    } else if (parameter.is_transmission()) {
      camera.transmission_uncertainty = std::min(std::max(camera.transmission_uncertainty, width), kMostUncertainty);
    }
  }
}

}  // namespace

Result<Calibration> calibrate(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                              const capture::SensorProfile& start, const CalibrationOptions& options) {
  E2LF_RETURN_IF_ERROR(check(scenes, codes, start));
  const OpenShares shares = open_shares(codes);
  E2LF_ASSIGN_OR_RETURN(const std::vector<Parameter> all,
                        fit_parameters(shares.of_codes.size() - 1, start, options.held));
  Calibration result;
  result.states = find_bad_pixels(scenes);
  const Calibrator calibrator(scenes, result.states, shares, start, options);
  result.flat_pixels = calibrator.num_flat_pixels();
  if (calibrator.areas().size() < kLeastAreas) {
    return fail(ErrorCode::kInvalidValue, "", "the scene has too few flat areas (", calibrator.areas().size(),
                " were found, ", kLeastAreas,
                " are needed); record a grey card and state that it is even, or record a scene with larger uniform "
                "areas")
        .about("even");
  }
  const Solution solution = solve(calibrator, all, options.is_even);
  result.camera = solution.camera;
  for (const Parameter& each : all) {
    const auto& determined = solution.determined;
    const auto place = std::find_if(determined.begin(), determined.end(),
                                    [&](const Parameter& other) { return other.key == each.key; });
    const bool is_determined = place != determined.end();
    const double deviation = is_determined ? solution.deviation[place - determined.begin()] : each.spread;
    result.estimates.push_back(estimate_of(each, result.camera, deviation, is_determined));
  }
  result.warnings = warnings_of(solution.determined, start, result.camera);
  note_uncertainty(solution.determined, solution.deviation, result.camera);
  result.agreement = compare(result.camera, shares, calibrator.areas());
  if (options.progress) options.progress(Calibrator::kParts, Calibrator::kParts);
  return result;
}

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
