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

/// The sums of a histogram from which moments are computed.
struct Sums {
  std::vector<double> mean;
  std::vector<double> product;  ///< transitions x transitions, of those of the same group
};

template <typename Value>
Sums sums_of(std::span<const Value> histogram, size_t transitions) {
  Sums sums{std::vector<double>(transitions), std::vector<double>(transitions * transitions)};
  std::vector<double> counts(transitions);
  for (const CountGroup& group : count_groups(transitions)) {
    const auto cells = histogram.subspan(group.begin, group.size());
    const double total = std::accumulate(cells.begin(), cells.end(), 0.0);
    const size_t end = group.first + group.transitions;
    for (size_t cell = 0; cell < cells.size(); ++cell) {
      const double share = cells[cell] / total;
      if (share <= 0.0) continue;
      size_t rest = cell;
      for (size_t n = end; n-- > group.first; rest /= group.num_counts) {
        counts[n] = group.count_at(rest % group.num_counts);
      }
      for (size_t n = group.first; n < end; ++n) {
        sums.mean[n] += share * counts[n];
        for (size_t m = group.first; m < end; ++m) sums.product[n * transitions + m] += share * counts[n] * counts[m];
      }
    }
  }
  return sums;
}

/// Accumulates means over areas and covariances within each.
class MomentSum {
 public:
  explicit MomentSum(size_t transitions) : mean_(transitions), covariance_(transitions * transitions) {}

  void add(const Sums& sums, double weight) {
    const size_t count = mean_.size();
    for (size_t n = 0; n < count; ++n) {
      mean_[n] += weight * sums.mean[n];
      for (size_t m = 0; m < count; ++m) {
        covariance_[n * count + m] += weight * (sums.product[n * count + m] - sums.mean[n] * sums.mean[m]);
      }
    }
  }

  [[nodiscard]] Moments moments() const {
    const size_t count = mean_.size();
    Moments result{mean_, {}, {}};
    const auto deviation = [&](size_t n) {
      return std::sqrt(std::max(covariance_[n * count + n], kLeastDeviation * kLeastDeviation));
    };
    for (size_t n = 0; n < count; ++n) result.deviation.push_back(deviation(n));
    for (const CountGroup& group : count_groups(count)) {
      for (size_t apart = 1; apart < group.transitions; ++apart) {
        for (size_t n = group.first; n + apart < group.first + group.transitions; ++n) {
          result.correlation.push_back(covariance_[n * count + n + apart] / deviation(n) / deviation(n + apart));
        }
      }
    }
    return result;
  }

 private:
  std::vector<double> mean_, covariance_;
};

/// Computes the agreement of several areas together. Standard deviations and correlations are those within areas, each
/// of which has one brightness.
Agreement agreement_of(const std::vector<const Area*>& areas, const std::vector<std::vector<double>>& predictions) {
  const size_t cells = areas.front()->histogram.size(), transitions = areas.front()->transitions;
  const auto groups = static_cast<double>(count_groups(transitions).size());
  Agreement result;
  for (const Area* area : areas) result.samples += area->samples;
  MomentSum measured(transitions), simulated(transitions);
  std::vector<double> difference(cells), model(cells);
  for (size_t a = 0; a < areas.size(); ++a) {
    const double weight = areas[a]->samples / result.samples;
    measured.add(sums_of(std::span<const float>(areas[a]->histogram), transitions), weight);
    simulated.add(sums_of(std::span<const double>(predictions[a]), transitions), weight);
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
  result.measured = measured.moments();
  result.simulated = simulated.moments();
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
