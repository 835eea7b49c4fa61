// SPDX-License-Identifier: MIT
// Estimates the threshold of each pixel; declared in calibrate.h.
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "e2lf/base/threads.h"
#include "e2lf/calibrate/calibrate.h"
#include "e2lf/calibrate/count_distribution.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

constexpr size_t kFactors = 13;
constexpr double kMismatchReach = 3.0;  // standard deviations of the mismatch to either side

/// Returns the deviation of a factor from 1 in standard deviations of the mismatch.
double place_of(size_t factor) {
  return kMismatchReach * (2.0 * static_cast<double>(factor) / (kFactors - 1) - 1.0);
}

/// For an area, the log probability of each combination of counts, for each factor.
using LogTable = std::array<std::vector<float>, kFactors>;

LogTable log_table(const capture::SensorProfile& camera, const OpenShares& shares, const Area& area,
                   double brightness) {
  LogTable table;
  const double mismatch = camera.pixel[kMismatch];
  for (size_t f = 0; f < kFactors; ++f) {
    capture::SensorProfile pixel = camera;
    const auto factor = static_cast<float>(std::max(1.0 + mismatch * place_of(f), capture::kLeastThreshold));
    pixel.pixel[kMismatch] = 0.0F;
    pixel.pixel[kThresholdOn] *= factor;
    pixel.pixel[kThresholdOff] *= factor;
    constexpr double kUnexplained = 1e-4;  // share of counts that the model does not explain
    for (const double p : predict(pixel, shares, area, brightness)) {
      table[f].push_back(static_cast<float>(std::log(p + kUnexplained)));
    }
  }
  return table;
}

/// Adds the evidence of one scene to the log probability of each factor of each pixel.
void add_scene(const StillScene& scene, const FlatAreas& flat, const OpenShares& shares,
               const capture::SensorProfile& camera, std::vector<std::array<float, kFactors>>& evidence,
               std::vector<bool>& is_known) {
  const std::vector<Area> areas = collect_areas(scene, 0, flat, [](size_t, size_t) { return true; });
  const std::vector<double> brightness = fit_brightness(camera, shares, areas);
  std::vector<LogTable> tables(areas.size());
  parallel_for(areas.size(), 1, [&](size_t begin, size_t end) {
    for (size_t a = begin; a < end; ++a) tables[a] = log_table(camera, shares, areas[a], brightness[a]);
  });
  std::map<size_t, const LogTable*> table_of_key;
  for (size_t a = 0; a < areas.size(); ++a) {
    table_of_key[areas[a].row * kFieldColumns * kFieldRows + areas[a].cell] = &tables[a];
  }
  const std::vector<CountGroup> groups = count_groups(scene.cycles.front().count);
  for (size_t p = 0; p < evidence.size(); ++p) {
    if (!flat.is_flat[p]) continue;
    const auto found = table_of_key.find(area_key(flat, p));
    if (found == table_of_key.end()) continue;
    is_known[p] = true;
    for (const capture::EventImages& cycle : scene.cycles) {
      for (const CountGroup& group : groups) {
        const size_t cell = group.cell_of([&](size_t n) { return cycle.image(n)[p]; });
        for (size_t f = 0; f < kFactors; ++f) evidence[p][f] += (*found->second)[f][cell];
      }
    }
  }
}

float mean_factor(const std::array<float, kFactors>& evidence, double mismatch) {
  double most = -std::numeric_limits<double>::infinity();
  std::array<double, kFactors> logarithm;
  for (size_t f = 0; f < kFactors; ++f) {
    logarithm[f] = evidence[f] - 0.5 * place_of(f) * place_of(f);
    most = std::max(most, logarithm[f]);
  }
  double sum = 0.0, weighted = 0.0;
  for (size_t f = 0; f < kFactors; ++f) {
    const double weight = std::exp(logarithm[f] - most);
    sum += weight;
    weighted += weight * (1.0 + mismatch * place_of(f));
  }
  return static_cast<float>(weighted / sum);
}

}  // namespace

Plane threshold_map(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                    const capture::SensorProfile& camera, const std::vector<PixelState>& states, bool is_even) {
  const capture::EventImages& first = scenes.front().cycles.front();
  const OpenShares shares = open_shares(codes);
  std::vector<std::array<float, kFactors>> evidence(first.image_size());
  for (auto& each : evidence) each.fill(0.0F);
  std::vector<bool> is_known(first.image_size());
  for (const StillScene& scene : scenes) {
    const FlatAreas flat = is_even ? even_areas(scene, states) : find_flat_areas(scene, states);
    add_scene(scene, flat, shares, camera, evidence, is_known);
  }
  Plane map(first.height, first.width);
  for (size_t p = 0; p < map.values.size(); ++p) {
    map.values[p] =
        is_known[p] ? mean_factor(evidence[p], camera.pixel[kMismatch]) : std::numeric_limits<float>::quiet_NaN();
  }
  return map;
}

}  // namespace e2lf::calibrate
