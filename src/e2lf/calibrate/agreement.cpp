// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <span>

#include "e2lf/base/threads.h"
#include "e2lf/calibrate/calibrate.h"
#include "e2lf/calibrate/count_distribution.h"

namespace e2lf::calibrate {
namespace {

constexpr double kLeastRowSamples = 300.0;
constexpr double kLeastDeviation = 1e-6;

/// Means over areas, and covariances within each, of transitions of the same group.
struct MomentSum {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  explicit MomentSum(Eigen::Index transitions)
      : mean(Eigen::VectorXd::Zero(transitions)), covariance(Eigen::MatrixXd::Zero(transitions, transitions)) {}
};

/// Adds the moments of a histogram.
template <typename Value>
void add_moments(std::span<const Value> histogram, double weight, MomentSum& to) {
  const auto transitions = static_cast<size_t>(to.mean.size());
  MomentSum sums(to.mean.size());  // with means of products
  Eigen::VectorXd counts(to.mean.size());
  for (const CountGroup& group : count_groups(transitions)) {
    const auto cells = histogram.subspan(group.begin, group.size());
    const double total = std::accumulate(cells.begin(), cells.end(), 0.0);
    const auto first = static_cast<Eigen::Index>(group.first), count = static_cast<Eigen::Index>(group.transitions);
    for (size_t cell = 0; cell < cells.size(); ++cell) {
      const double share = cells[cell] / total;
      if (share <= 0.0) continue;
      size_t rest = cell;
      for (Eigen::Index n = first + count; n-- > first; rest /= group.num_counts) {
        counts[n] = group.count_at(rest % group.num_counts);
      }
      const auto of_group = counts.segment(first, count);
      sums.mean.segment(first, count) += share * of_group;
      sums.covariance.block(first, first, count, count) += (share * of_group) * of_group.transpose();
    }
  }
  to.mean += weight * sums.mean;
  to.covariance += weight * (sums.covariance - sums.mean * sums.mean.transpose());
}

Moments moments_of(const MomentSum& sum) {
  const Eigen::VectorXd deviation = sum.covariance.diagonal().cwiseMax(kLeastDeviation * kLeastDeviation).cwiseSqrt();
  Moments result{{sum.mean.begin(), sum.mean.end()}, {deviation.begin(), deviation.end()}, {}};
  for (const CountGroup& group : count_groups(result.mean.size())) {
    const auto first = static_cast<Eigen::Index>(group.first), count = static_cast<Eigen::Index>(group.transitions);
    for (Eigen::Index apart = 1; apart < count; ++apart) {
      for (Eigen::Index n = first; n + apart < first + count; ++n) {
        result.correlation.push_back(sum.covariance(n, n + apart) / deviation[n] / deviation[n + apart]);
      }
    }
  }
  return result;
}

/// Computes the agreement of several areas together. Standard deviations and correlations are those within areas, each
/// of which has one brightness.
Agreement agreement_of(const std::vector<const Area*>& areas, const std::vector<std::vector<double>>& predictions) {
  const size_t cells = areas.front()->histogram.size(), transitions = areas.front()->transitions;
  const auto groups = static_cast<double>(count_groups(transitions).size());
  Agreement result;
  for (const Area* area : areas) result.samples += area->samples;
  const auto size = static_cast<Eigen::Index>(transitions);
  MomentSum measured(size), simulated(size);
  std::vector<double> difference(cells), model(cells);
  for (size_t a = 0; a < areas.size(); ++a) {
    const double weight = areas[a]->samples / result.samples;
    add_moments(std::span<const float>(areas[a]->histogram), weight, measured);
    add_moments(std::span<const double>(predictions[a]), weight, simulated);
    for (size_t cell = 0; cell < cells; ++cell) {
      difference[cell] += weight * (areas[a]->histogram[cell] - predictions[a][cell]);
      model[cell] += weight * predictions[a][cell];
    }
  }
  for (size_t cell = 0; cell < cells; ++cell) {
    result.total_variation += 0.5 / groups * std::abs(difference[cell]);
    // The expected deviation of a share of this number of samples from its probability.
    const double p = std::clamp(model[cell], 0.0, 1.0);
    const double apart = std::min(std::sqrt(2.0 * p * (1.0 - p) / (std::numbers::pi * result.samples)), 2.0 * p);
    result.chance += 0.5 / groups * apart;
  }
  result.measured = moments_of(measured);
  result.simulated = moments_of(simulated);
  for (size_t n = 0; n < std::min<size_t>(transitions, 2); ++n) result.brightness += result.measured.mean[n];
  return result;
}

}  // namespace

std::vector<Agreement> compare(const capture::SensorProfile& camera, const OpenShares& open_shares,
                               const std::vector<Area>& areas) {
  const std::vector<double> brightness = fit_brightness(camera, open_shares, areas);
  std::vector<std::vector<double>> predictions(areas.size());
  parallel_for(areas.size(), 1, [&](size_t begin, size_t end) {
    for (size_t a = begin; a < end; ++a) predictions[a] = predict(camera, open_shares, areas[a], brightness[a]);
  });
  std::vector<Agreement> agreements;
  std::map<size_t, std::vector<size_t>> rows;
  for (size_t a = 0; a < areas.size(); ++a) rows[areas[a].row].push_back(a);
  for (const auto& [row, members] : rows) {
    std::vector<const Area*> group;
    std::vector<std::vector<double>> expected;
    for (const size_t a : members) {
      group.push_back(&areas[a]);
      expected.push_back(predictions[a]);
    }
    Agreement agreement = agreement_of(group, expected);
    if (agreement.samples >= kLeastRowSamples) agreements.push_back(std::move(agreement));
  }
  return agreements;
}

}  // namespace e2lf::calibrate
