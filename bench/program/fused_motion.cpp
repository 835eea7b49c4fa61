// SPDX-License-Identifier: MIT
#include "bench/program/fused_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "bench/program/moving_scenes.h"
#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/recon/fusion.h"
#include "e2lf/recon/scene_motion.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
namespace {

using lightfield::LightField;

constexpr size_t kBorderPx = 12;  ///< that is not judged
constexpr std::array kInputs = {"one_psnr_db", "fused_psnr_db", "mean_psnr_db"};
constexpr std::array kParts = {"all", "still", "moving"};

struct FusedShots {
  std::string motion;
  std::vector<Shot> shots;
};

Result<std::vector<FusedShots>> shots_of(const std::vector<LightField>& scenes, int64_t cycle_us, size_t size) {
  constexpr size_t kCycles = kFusedMotionCycles + 1;  // the first one prepares the references
  std::vector<FusedShots> result;
  for (const double px : {0.0, 6.0}) {
    FusedShots& all = result.emplace_back(FusedShots{cat("scenes that move ", px, " px per cycle"), {}});
    for (const LightField& scene : scenes) {
      E2LF_ASSIGN_OR_RETURN(all.shots.emplace_back(),
                            shot_of(shift(scene, px, cycle_us, kCycles, size), cycle_us, kCycles - 1));
    }
  }
  for (const size_t px : {2U, 4U, 8U}) {
    FusedShots& all = result.emplace_back(FusedShots{cat("squares that move ", px, " px per cycle"), {}});
    for (size_t i = 0; i < scenes.size(); ++i) {
      E2LF_ASSIGN_OR_RETURN(all.shots.emplace_back(),
                            square_before(scenes[i], scenes[(i + 1) % scenes.size()], px, cycle_us, kCycles, size));
    }
  }
  FusedShots& table = result.emplace_back(FusedShots{"turntable at 1.75 rpm", {}});
  for (const uint64_t seed : {1U, 2U}) {
    E2LF_ASSIGN_OR_RETURN(table.shots.emplace_back(), shot_of(turn(1.75, size, seed), cycle_us, kCycles - 1));
  }
  return result;
}

/// Reconstructs the light fields of kInputs.
Result<std::array<LightField, kInputs.size()>> reconstruct_each(const std::vector<capture::EventImages>& cycles,
                                                                const recon::Reconstructor& network) {
  const size_t first = cycles.size() - kFusedMotionCycles;
  recon::CycleFusion fusion(*network.model().camera, kFusedMotionCycles);
  capture::EventImages sum, last;
  for (size_t i = first; i < cycles.size(); ++i) {
    last = recon::lit_transitions(cycles[i]);
    fusion.add(last);
    if (i == first) {
      sum = last;
      continue;
    }
    std::ranges::transform(sum.values, last.values, sum.values.begin(), std::plus<>());
  }
  std::array<LightField, kInputs.size()> fields;
  E2LF_ASSIGN_OR_RETURN(fields[0], network.reconstruct(last));
  E2LF_ASSIGN_OR_RETURN(fields[1], network.reconstruct({last, fusion.fused()}));
  E2LF_ASSIGN_OR_RETURN(fields[2], network.reconstruct(sum, {}, /*passes=*/1, kFusedMotionCycles));
  return fields;
}

/// Returns the PSNR of the pixels of a part, those of which `moves` is `part`, or all for 0, after a fit of their
/// brightness.
double psnr_of_part(const LightField& truth, const LightField& field, const std::vector<uint8_t>& moves, size_t part) {
  const auto [width, height] = std::pair(truth.shape().width, truth.shape().height);
  const auto for_each = [&](const auto& see) {
    for (size_t view = 0; view < truth.shape().num_views(); ++view) {
      for (size_t y = kBorderPx; y + kBorderPx < height; ++y) {
        for (size_t x = kBorderPx; x + kBorderPx < width; ++x) {
          const size_t pixel = y * width + x, i = view * truth.shape().view_size() + pixel;
          if (part == 0 || (moves[pixel] != 0) == (part == 2)) see(truth.data()[i], field.data()[i]);
        }
      }
    }
  };
  double products = 0, squares = 0, errors = 0, count = 0;
  for_each([&](double true_value, double value) { products += true_value * value, squares += value * value, ++count; });
  const double gain = squares > 0 ? products / squares : 1;
  for_each([&](double true_value, double value) {
    const double error = std::clamp(gain * value, 0.0, 1.0) - true_value;
    errors += error * error;
  });
  return -10 * std::log10(errors / count);
}

/// Returns the PSNR of kParts against the view of the scene that is nearest to what moves. Without a part that moves
/// alone, the first one is the only one.
std::vector<double> psnr_of_parts(const LightField& field, const Shot& shot) {
  const size_t parts = shot.moves.empty() ? 1 : kParts.size();
  std::vector<double> best(parts, 0.0);
  for (const LightField& truth : shot.truths) {
    std::vector<double> psnr_db;
    for (size_t part = 0; part < parts; ++part) psnr_db.push_back(psnr_of_part(truth, field, shot.moves, part));
    if (psnr_db.back() > best.back()) best = psnr_db;
  }
  return best;
}

}  // namespace

Result<Json> measure_fused_motion(const std::vector<LightField>& scenes, const capture::Codes& codes,
                                  const recon::Reconstructor& network, size_t size, uint64_t seed, bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(const auto motions, shots_of(scenes, cycles::paper_schedule_of(codes).cycle_us(), size));
  ProgressBar bar("fusion", is_quiet);
  Json rows = Json::array();
  for (size_t m = 0; m < motions.size(); ++m) {
    const std::vector<Shot>& shots = motions[m].shots;
    const size_t parts = shots.front().moves.empty() ? 1 : kParts.size(), first = rows.size();
    for (size_t part = 0; part < parts; ++part) {
      rows.push_back({{"motion", motions[m].motion}, {"part", kParts[part]}});
      for (const char* input : kInputs) rows.back()[input] = 0.0;
    }
    for (size_t i = 0; i < shots.size(); ++i) {
      E2LF_ASSIGN_OR_RETURN(const auto cycles,
                            record_cycles(shots[i], codes, *network.model().camera, seed + i, kFusedMotionCycles + 1));
      E2LF_ASSIGN_OR_RETURN(const auto fields, reconstruct_each(cycles, network));
      for (size_t input = 0; input < kInputs.size(); ++input) {
        const std::vector<double> psnr_db = psnr_of_parts(fields[input], shots[i]);
        for (size_t part = 0; part < parts; ++part) {
          Json& sum = rows[first + part][kInputs[input]];
          sum = sum.get<double>() + psnr_db[part] / static_cast<double>(shots.size());
        }
      }
    }
    bar.update(m + 1, motions.size());
  }
  hide_progress();
  return rows;
}

report::Table fused_motion_table(const Json& rows) {
  report::Table table{cat("The last of ", kFusedMotionCycles,
                          " cycles, from their lit transitions, after a fit of the brightness of each part; "
                          "means over the scenes."),
                      {{"motion"},
                       {"part"},
                       {"one cycle", true, true, "one_psnr_db"},
                       {"fused", true, true, "fused_psnr_db"},
                       {"mean of all", true, true, "mean_psnr_db"}},
                      {}};
  for (const Json& row : rows) {
    table.rows.push_back(
        {report::text_cell(row["motion"].get<std::string>()), report::text_cell(row["part"].get<std::string>())});
    for (const char* input : kInputs) table.rows.back().push_back(report::number_cell(row[input].get<double>(), 2));
  }
  return table;
}

}  // namespace e2lf::bench
