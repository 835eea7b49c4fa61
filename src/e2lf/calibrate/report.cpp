// SPDX-License-Identifier: MIT
// The agreement of a calibration with the events, and its reports; declared in calibrate.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <span>

#include "e2lf/base/text.h"
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
Agreement agreement_of(const std::vector<Area>& areas, const std::vector<size_t>& members,
                       const std::vector<std::vector<double>>& predictions) {
  const size_t cells = areas.front().histogram.size(), transitions = areas.front().transitions;
  const auto groups = static_cast<double>(count_groups(transitions).size());
  Agreement result;
  for (const size_t a : members) result.samples += areas[a].samples;
  const auto size = static_cast<Eigen::Index>(transitions);
  MomentSum measured(size), simulated(size);
  std::vector<double> difference(cells), model(cells);
  for (const size_t a : members) {
    const double weight = areas[a].samples / result.samples;
    add_moments(std::span<const float>(areas[a].histogram), weight, measured);
    add_moments(std::span<const double>(predictions[a]), weight, simulated);
    for (size_t cell = 0; cell < cells; ++cell) {
      difference[cell] += weight * (areas[a].histogram[cell] - predictions[a][cell]);
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
    Agreement agreement = agreement_of(areas, members, predictions);
    if (agreement.samples >= kLeastRowSamples) agreements.push_back(std::move(agreement));
  }
  return agreements;
}

namespace {

size_t count(const Calibration& calibration, PixelState state) {
  return static_cast<size_t>(std::count(calibration.states.begin(), calibration.states.end(), state));
}

/// The number of transitions in the table, and of their correlations; the JSON report contains all.
constexpr size_t kShown = 3;

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (size_t i = 0; i < std::min(values.size(), kShown); ++i) text += formatted("%6.2f", values[i]);
  return text;
}

/// The unit and meaning of a constant, for readers of the table.
struct Meaning {
  const char* key;  ///< without the number of a pattern
  const char* unit;
  const char* text;
};
constexpr const char* kLog = "ln";  // natural logarithm of intensity
constexpr std::array<Meaning, 16> kMeanings = {{
    {"receptor_rate_hz", "1/s", "bandwidth of the photoreceptor in the dark"},
    {"amplifier_rate_hz", "1/s", "bandwidth of the amplifier"},
    {"leak", "1", "fraction of the light that a closed cell of the aperture transmits"},
    {"threshold_on", kLog, "contrast threshold of ON events"},
    {"threshold_off", kLog, "contrast threshold of OFF events"},
    {"mismatch", "1", "mismatch that both thresholds of a pixel share (relative standard deviation)"},
    {"mismatch_each", "1", "mismatch of each threshold alone (relative standard deviation)"},
    {"noise", kLog, "standard deviation of the level at the end of a pattern"},
    {"shot_noise", kLog, "additional standard deviation in the dark"},
    {"reset_span", "threshold_off", "range of a pixel's reference after black"},
    {"reset_offset", kLog, "offset of that range below the black level"},
    {"dark_off", "1/pattern", "fraction of pixels with a spurious OFF event in the dark"},
    {"dark_on", "1/pattern", "fraction of pixels with a spurious ON event in the dark"},
    {"transmission", "1", "light of this active pattern relative to its open cells; 1 for the first"},
    {"transmission.slope_x", "ln/half width", "its change to the right"},
    {"transmission.slope_y", "ln/half width", "its change downwards"},
}};

const Meaning& meaning_of(const std::string& key) {
  static constexpr Meaning kUnknown = {"", "", ""};
  const std::string name = key.substr(0, key.find('['));
  const auto* found =
      std::find_if(kMeanings.begin(), kMeanings.end(), [&](const Meaning& each) { return name == each.key; });
  return found == kMeanings.end() ? kUnknown : *found;
}

std::string constants_text(const Calibration& calibration) {
  std::string text = formatted("%-23s %10s %-13s %-22s %s\n", "constant", "value", "unit", "95 % range", "meaning");
  for (const Estimate& each : calibration.estimates) {
    const Meaning& meaning = meaning_of(each.key);
    const std::string range = each.is_determined ? formatted("%.4g to %.4g", each.low, each.high) : "kept";
    text += formatted("%-23s %10.4g %-13s %-22s %s\n", each.key.c_str(), each.value, meaning.unit, range.c_str(),
                      meaning.text);
  }
  return text + "kept: the input does not determine this constant, so it keeps the value of the starting camera\n";
}

std::string agreement_text(const std::vector<Agreement>& agreements) {
  if (agreements.empty()) return "";
  const auto column = [&](const char* title, size_t entries) {
    const int width = static_cast<int>(6 * std::min(entries, kShown));
    return formatted("  %*s |%*s", width, title, width, "model");
  };
  const Moments& moments = agreements.front().measured;
  std::string text = formatted("%7s %8s %6s %6s", "E1+E2", "samples", "TV", "chance");
  text += column("mean", moments.mean.size()) + column("deviation", moments.deviation.size()) +
          column("correlation", moments.correlation.size()) + "\n";
  for (const Agreement& each : agreements) {
    text += formatted("%7.2f %8.0f %6.3f %6.3f", each.brightness, each.samples, each.total_variation, each.chance);
    const auto pair = [&](const std::vector<double>& measured, const std::vector<double>& simulated) {
      text += "  " + numbers(measured) + " |" + numbers(simulated);
    };
    pair(each.measured.mean, each.simulated.mean);
    pair(each.measured.deviation, each.simulated.deviation);
    pair(each.measured.correlation, each.simulated.correlation);
    text += "\n";
  }
  return text;
}

Json moments_json(const Moments& moments) {
  return {{"mean", moments.mean}, {"deviation", moments.deviation}, {"correlation", moments.correlation}};
}

Json agreements_json(const std::vector<Agreement>& agreements) {
  Json list = Json::array();
  for (const Agreement& each : agreements) {
    list.push_back({{"brightness", each.brightness},
                    {"samples", each.samples},
                    {"total_variation", each.total_variation},
                    {"chance", each.chance},
                    {"measured", moments_json(each.measured)},
                    {"simulated", moments_json(each.simulated)}});
  }
  return list;
}

}  // namespace

std::string report_text(const Calibration& calibration) {
  std::string text = constants_text(calibration);
  text +=
      formatted("\n%zu flat pixels; %zu hot and %zu dead of %zu\n\n", calibration.flat_pixels,
                count(calibration, PixelState::kHot), count(calibration, PixelState::kDead), calibration.states.size());
  text += agreement_text(calibration.agreement);
  text +=
      "each row: places of one brightness (E1+E2, their mean count in the first two transitions), and of the first "
      "three "
      "transitions what was measured | what the constants imply; TV, the total variation, is near \"chance\" where "
      "they "
      "agree\n";
  return text;
}

Json report_json(const Calibration& calibration) {
  Json constants = Json::array();
  for (const Estimate& each : calibration.estimates) {
    constants.push_back({{"key", each.key},
                         {"value", each.value},
                         {"unit", meaning_of(each.key).unit},
                         {"meaning", meaning_of(each.key).text},
                         {"low", each.low},
                         {"high", each.high},
                         {"is_determined", each.is_determined}});
  }
  return {{"constants", constants},
          {"warnings", calibration.warnings},
          {"pixels",
           {{"flat", calibration.flat_pixels},
            {"hot", count(calibration, PixelState::kHot)},
            {"dead", count(calibration, PixelState::kDead)},
            {"all", calibration.states.size()}}},
          {"rows", agreements_json(calibration.agreement)}};
}

Json camera_json(const Calibration& calibration) {
  Json json = capture::to_json(calibration.camera);
  for (const Estimate& each : calibration.estimates) {
    if (!json["constants"].contains(each.key)) continue;
    json["constants"][each.key]["source"] = each.is_determined ? "e2lf calibrate" : "kept from the first guess";
  }
  if (json.contains("transmission")) json["transmission"]["source"] = "e2lf calibrate";
  return json;
}

}  // namespace e2lf::calibrate
