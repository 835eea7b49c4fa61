// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "e2lf/base/threads.h"
#include "e2lf/calibrate/count_distribution.h"

namespace e2lf::calibrate {
namespace {

constexpr double kOther = 1e-4;  // share of samples that the model does not explain, spread evenly
constexpr double kLeastExpected = 5.0;
constexpr double kBrightnessStep = 0.02, kMostBrightnessMove = 0.2, kLeastBrightnessMove = 1e-4;
constexpr double kDarkest = 0.0, kBrightest = 9.0;  // range of ln(I / eps) in which brightness is searched
constexpr size_t kBrightnessGrid = 19;
constexpr double kMostMove = 0.5;
constexpr size_t kMostIterations = 30;

using Shares = Eigen::VectorXd;  // of each combination of counts

Shares plain_shares(const capture::SensorProfile& camera, const OpenShares& open_shares, const Area& area,
                    double brightness) {
  const std::vector<double> model = predict(camera, open_shares, area, brightness);
  return Eigen::Map<const Eigen::VectorXd>(model.data(), static_cast<Eigen::Index>(model.size()));
}

Shares shares_of_model(const capture::SensorProfile& camera, const OpenShares& open_shares, const Area& area,
                       double brightness) {
  const Shares shares = plain_shares(camera, open_shares, area, brightness);
  return ((1.0 - kOther) * shares).array() + kOther / static_cast<double>(shares.size());
}

Shares shares_of_area(const Area& area) {
  return Eigen::Map<const Eigen::VectorXf>(area.histogram.data(), static_cast<Eigen::Index>(area.histogram.size()))
      .cast<double>();
}

/// Returns the deviance per sample: twice the amount by which its log probability falls short of the best possible one.
double deviance(const Shares& measured, const Shares& model) {
  double sum = model.sum() - measured.sum();
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    if (measured[i] > 0.0) sum += measured[i] * std::log(measured[i] / model[i]);
  }
  return 2.0 * sum;
}

/// Improves one brightness by scoring, with shorter steps if a full one makes the fit worse.
double improve_brightness(const capture::SensorProfile& camera, const OpenShares& open_shares, const Area& area,
                          const Shares& measured, double brightness, int iterations) {
  const auto shares = [&](double value) { return shares_of_model(camera, open_shares, area, value); };
  Shares model = shares(brightness);
  double misfit = deviance(measured, model);
  for (int i = 0; i < iterations; ++i) {
    const Shares slope = (shares(brightness + kBrightnessStep) - model) / kBrightnessStep;
    const Shares pull = slope.cwiseQuotient(model);
    double move = (measured - model).dot(pull) / (slope.dot(pull) + 1e-4);
    move = std::clamp(move, -kMostBrightnessMove, kMostBrightnessMove);
    bool is_better = false;
    for (int attempt = 0; attempt < 3 && !is_better && std::abs(move) > kLeastBrightnessMove; ++attempt, move *= 0.3) {
      const Shares moved = shares(brightness + move);
      const double moved_misfit = deviance(measured, moved);
      is_better = moved_misfit < misfit;
      if (!is_better) continue;
      brightness += move;
      misfit = moved_misfit;
      model = moved;
    }
    if (!is_better) break;
  }
  return brightness;
}

std::vector<double> weights_of(const std::vector<Area>& areas, double most_row_samples) {
  std::map<size_t, double> of_row;
  for (const Area& area : areas) of_row[area.row] += area.samples;
  std::vector<double> weights;
  for (const Area& area : areas) {
    weights.push_back(area.samples * std::min(1.0, most_row_samples / of_row[area.row]));
  }
  return weights;
}

/// Pearson's distance of the shares of an area from those of the model, per sample, and its degrees of freedom.
/// Combinations with fewer than five expected samples are merged, because rare ones contain no information by
/// themselves.
struct Pearson {
  double distance = 0.0, freedom = 0.0;
};

Pearson pearson_of_group(const Shares& measured, const Shares& model, const CountGroup& group, double samples) {
  std::vector<Eigen::Index> order(group.size());
  std::iota(order.begin(), order.end(), static_cast<Eigen::Index>(group.begin));
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return model[a] > model[b]; });
  Pearson result{0.0, -1.0};  // the shares sum to one
  double expected = 0.0, found = 0.0, all_expected = 0.0, all_found = 0.0;
  for (const Eigen::Index i : order) {
    expected += model[i];
    found += measured[i];
    if (expected * samples < kLeastExpected) continue;
    result.distance += (found - expected) * (found - expected) / expected;
    result.freedom += 1.0;
    all_expected += std::exchange(expected, 0.0);
    all_found += std::exchange(found, 0.0);
  }
  const double rest = std::max(1.0 - all_expected, kLeastExpected / samples), difference = 1.0 - all_found - rest;
  result.distance += difference * difference / rest;
  result.freedom += 1.0;
  return result;
}

Pearson pearson_of(const Shares& measured, const Shares& model, size_t transitions, double samples) {
  Pearson result{0.0, -1.0};  // the brightness is fitted
  for (const CountGroup& group : count_groups(transitions)) {
    const Pearson each = pearson_of_group(measured, model, group, samples);
    result.distance += each.distance;
    result.freedom += each.freedom;
  }
  result.freedom = std::max(result.freedom, 1.0);
  return result;
}

/// The data of a fit, and the equations at a model.
class Fitter {
 public:
  Fitter(const std::vector<Parameter>& parameters, const OpenShares& open_shares, const std::vector<Area>& areas,
         const capture::SensorProfile& start, const FitOptions& options)
      : parameters_(parameters),
        open_shares_(open_shares),
        areas_(areas),
        start_(to_vector(parameters, start)),
        spread_(start_.size()),
        misfit_(options.misfit),
        weights_(weights_of(areas, options.most_row_samples)),
        measured_(areas.size()) {
    for (Eigen::Index i = 0; i < spread_.size(); ++i) spread_[i] = parameters[static_cast<size_t>(i)].spread;
    for (size_t a = 0; a < areas.size(); ++a) measured_[a] = shares_of_area(areas[a]);
    for (double& weight : weights_) weight /= misfit_;
  }

  /// The equations at a model: normal matrix and right-hand side without the brightnesses, and the coefficients that
  /// recover those.
  struct Equations {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
    std::vector<Eigen::VectorXd> brightness_of_move;  ///< change of an area's brightness per unit of each parameter
    std::vector<double> brightness_alone;             ///< change without any parameter change
  };

  [[nodiscard]] Equations equations(const Model& model) const {
    const auto size = start_.size();
    std::vector<Eigen::MatrixXd> normals(areas_.size());
    std::vector<Eigen::VectorXd> rights(areas_.size());
    Equations result{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size),
                     std::vector<Eigen::VectorXd>(areas_.size()), std::vector<double>(areas_.size())};
    const std::vector<capture::SensorProfile> stepped = stepped_cameras(model.camera);
    parallel_for(areas_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t a = begin; a < end; ++a) {
        const Shares here = shares(model.camera, a, model.brightness[a]);
        const Eigen::VectorXd scale = here.cwiseSqrt().cwiseInverse();  // equalises the variance of all combinations
        Eigen::MatrixXd jacobian(here.size(), size);
        for (Eigen::Index i = 0; i < size; ++i) {
          const auto n = static_cast<size_t>(i);
          const Shares moved = shares(stepped[n], a, model.brightness[a]);
          jacobian.col(i) = scale.cwiseProduct(moved - here) / step_of(parameters_[n]);
        }
        const Shares brighter = shares(model.camera, a, model.brightness[a] + kBrightnessStep);
        const Eigen::VectorXd slope = scale.cwiseProduct(brighter - here) / kBrightnessStep;
        const Eigen::VectorXd residual = scale.cwiseProduct(measured_[a] - here);
        const double curvature = slope.squaredNorm() + 1e-9;
        result.brightness_of_move[a] = jacobian.transpose() * slope / curvature;
        result.brightness_alone[a] = residual.dot(slope) / curvature;
        jacobian -= slope * result.brightness_of_move[a].transpose();
        normals[a] = weights_[a] * jacobian.transpose() * jacobian;
        rights[a] = weights_[a] * jacobian.transpose() * residual;
      }
    });
    for (size_t a = 0; a < areas_.size(); ++a) {  // in order, so that the sums do not depend on the number of threads
      result.normal += normals[a];
      result.right += rights[a];
    }
    return result;
  }

  [[nodiscard]] double misfit(const Model& model) const {
    std::vector<double> parts(areas_.size());
    parallel_for(areas_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t a = begin; a < end; ++a) {
        parts[a] = weights_[a] * deviance(measured_[a], shares(model.camera, a, model.brightness[a]));
      }
    });
    double sum = 0.0;
    for (const double part : parts) sum += part;
    return sum;
  }

  [[nodiscard]] double strain(const Model& model) const {
    return (to_vector(parameters_, model.camera) - start_).cwiseQuotient(spread_).squaredNorm();
  }

  /// Solves the equations for the change of the parameters.
  [[nodiscard]] Eigen::VectorXd move_of(const Model& model, const Equations& equations, double damping) const {
    const Eigen::VectorXd values = to_vector(parameters_, model.camera);
    const Eigen::VectorXd firmness = spread_.cwiseAbs2().cwiseInverse();
    Eigen::MatrixXd matrix = equations.normal;
    matrix.diagonal() += firmness;
    const Eigen::VectorXd right = equations.right + firmness.cwiseProduct(start_ - values);
    matrix.diagonal() += damping * matrix.diagonal();
    return matrix.ldlt().solve(right).cwiseMax(-kMostMove).cwiseMin(kMostMove);
  }

  /// Returns the model after one damped step, with each brightness improved.
  [[nodiscard]] Model moved(const Model& model, const Equations& equations, double damping) const {
    const Eigen::VectorXd move = move_of(model, equations, damping);
    const Eigen::VectorXd values = to_vector(parameters_, model.camera);
    Model result = model;
    from_vector(parameters_, values + move, result.camera);
    keep_in_range(result.camera);
    parallel_for(areas_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t a = begin; a < end; ++a) {
        const double change = equations.brightness_alone[a] - equations.brightness_of_move[a].dot(move);
        const double guess = model.brightness[a] + std::clamp(change, -kMostMove, kMostMove);
        result.brightness[a] = improve_brightness(result.camera, open_shares_, areas_[a], measured_[a], guess, 2);
      }
    });
    return result;
  }

  [[nodiscard]] Misfit misfit_beyond_chance(const Model& model) const {
    double weighted = 0.0, full = 0.0, freedom = -static_cast<double>(parameters_.size()), samples = 0.0;
    std::set<size_t> rows;
    for (size_t a = 0; a < areas_.size(); ++a) {
      const Pearson pearson =
          pearson_of(measured_[a], plain_shares(model.camera, open_shares_, areas_[a], model.brightness[a]),
                     areas_[a].transitions, areas_[a].samples);
      weighted += misfit_ * weights_[a] * pearson.distance;
      full += areas_[a].samples * pearson.distance;
      freedom += pearson.freedom;
      samples += areas_[a].samples;
      rows.insert(areas_[a].row);
    }
    freedom = std::max(freedom, 1.0);
    const double own = std::max(full - freedom, 1e-3 * freedom) / samples;
    return {std::max(1.0, weighted / freedom), freedom / static_cast<double>(rows.size()) / own};
  }

 private:
  [[nodiscard]] Shares shares(const capture::SensorProfile& camera, size_t area, double brightness) const {
    return shares_of_model(camera, open_shares_, areas_[area], brightness);
  }
  static double step_of(const Parameter& parameter) { return 0.02 * std::min(parameter.spread, 0.5); }

  [[nodiscard]] std::vector<capture::SensorProfile> stepped_cameras(const capture::SensorProfile& camera) const {
    std::vector<capture::SensorProfile> stepped(parameters_.size(), camera);
    const Eigen::VectorXd values = to_vector(parameters_, camera);
    for (size_t i = 0; i < parameters_.size(); ++i) {
      Eigen::VectorXd moved = values;
      moved[static_cast<Eigen::Index>(i)] += step_of(parameters_[i]);
      from_vector(parameters_, moved, stepped[i]);
    }
    return stepped;
  }

  /// Keeps the constants within the range that camera files allow.
  static void keep_in_range(capture::SensorProfile& camera) {
    for (const Bound& bound : kFitBounds) {
      float& value = camera.pixel[bound.constant];
      value = std::clamp(value, bound.low, bound.high);
    }
  }

  const std::vector<Parameter>& parameters_;
  const OpenShares& open_shares_;
  const std::vector<Area>& areas_;
  Eigen::VectorXd start_, spread_;
  double misfit_;
  std::vector<double> weights_;
  std::vector<Shares> measured_;
};

}  // namespace

OpenShares open_shares(const capture::Codes& codes) {
  const auto of_whole = capture::codes_of_whole_cycle(codes);
  return {capture::light_efficiency(of_whole.value_or(codes)), of_whole.has_value()};
}

std::vector<double> predict(const capture::SensorProfile& camera, const OpenShares& open_shares, const Area& area,
                            double brightness) {
  const double full = std::exp(brightness), leak = camera.pixel[capture::PixelConstant::kLeak];
  PixelLight light;
  light.is_whole = open_shares.is_whole;
  std::vector<double> of_inverses;
  for (size_t n = 0; n < open_shares.of_codes.size(); ++n) {
    const double open = open_shares.of_codes[n];
    const double passed =
        n == 0 ? open
               : open * capture::transmission_at(camera, n - 1, static_cast<float>(area.x), static_cast<float>(area.y));
    light.of_patterns.push_back(full * (passed + leak * (1.0 - open)) + 1.0);
    of_inverses.push_back(full * std::max(1.0 - passed, 0.0) + 1.0);
  }
  light.inverse = of_inverses.back();
  if (light.is_whole) {
    light.of_patterns.insert(light.of_patterns.end(), of_inverses.begin(), of_inverses.end());
    light.of_patterns.push_back(light.of_patterns.front());
  }
  std::vector<double> result(area.histogram.size());
  count_distribution(camera.pixel, light, result);
  return result;
}

std::vector<double> fit_brightness(const capture::SensorProfile& camera, const OpenShares& open_shares,
                                   const std::vector<Area>& areas) {
  std::vector<double> brightness(areas.size());
  parallel_for(areas.size(), 1, [&](size_t begin, size_t end) {
    for (size_t a = begin; a < end; ++a) {
      const Shares measured = shares_of_area(areas[a]);
      double least = 1e300;
      for (size_t i = 0; i < kBrightnessGrid; ++i) {
        const double guess = kDarkest + (kBrightest - kDarkest) * static_cast<double>(i) / (kBrightnessGrid - 1);
        const double misfit = deviance(measured, shares_of_model(camera, open_shares, areas[a], guess));
        if (misfit < least) {
          least = misfit;
          brightness[a] = guess;
        }
      }
      brightness[a] = improve_brightness(camera, open_shares, areas[a], measured, brightness[a], 8);
    }
  });
  return brightness;
}

Eigen::VectorXd next_move(const std::vector<Parameter>& parameters, const OpenShares& open_shares,
                          const std::vector<Area>& areas, const capture::SensorProfile& start, const Model& model,
                          const FitOptions& options) {
  const Fitter fitter(parameters, open_shares, areas, start, options);
  return fitter.move_of(model, fitter.equations(model), 0.0);
}

Fit fit_camera(const std::vector<Parameter>& parameters, const OpenShares& open_shares, const std::vector<Area>& areas,
               const capture::SensorProfile& start, const Model& first, const FitOptions& options) {
  const Fitter fitter(parameters, open_shares, areas, start, options);
  const auto cost = [&](const Model& model) { return fitter.misfit(model) + fitter.strain(model); };
  Fit fit{first, {}, {}};
  double least = cost(fit.model), damping = 1e-2;
  for (size_t i = 0; i < kMostIterations; ++i) {
    if (options.progress) options.progress(i, kMostIterations);
    const auto equations = fitter.equations(fit.model);
    const double before = least;
    for (int attempt = 0; attempt < 6; ++attempt, damping *= 5.0) {
      Model moved = fitter.moved(fit.model, equations, damping);
      const double moved_cost = cost(moved);
      if (moved_cost >= least) continue;
      least = moved_cost;
      fit.model = std::move(moved);
      damping = std::max(damping / 10.0, 1e-6);
      break;
    }
    if (before - least < 1e-4 * before) break;
  }
  fit.misfit = fitter.misfit_beyond_chance(fit.model);
  fit.information = fitter.equations(fit.model).normal * options.misfit / fit.misfit.weighted;
  return fit;
}

}  // namespace e2lf::calibrate
