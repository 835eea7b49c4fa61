// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {
namespace {

constexpr size_t kRows = 8, kCells = kRows * kRows;
constexpr double kKnownShare = 0.5;      // of sequences whose patterns are known ones, if there are any
constexpr double kLeastLight = 1;        // open cells of a pattern
constexpr double kLeastParallax = 0.7;   // sum of the standard deviations of the centroids, cells
constexpr double kImperfectShare = 0.3;  // of sequences with each imperfection of a display

using Cells = std::array<double, kCells>;

double row_of(size_t cell) {
  return static_cast<double>(cell / kRows);
}

double column_of(size_t cell) {
  return static_cast<double>(cell % kRows);
}

/// Returns a compact aperture of 2 to 16 cells of any outline.
Cells draw_compact(Draws& draws) {
  const double centre_y = draws.uniform(0.3, 6.7), centre_x = draws.uniform(0.3, 6.7);
  const auto number = static_cast<size_t>(std::lround(draws.log_uniform(2, 16)));
  const double angle = draws.uniform(0, std::numbers::pi), stretch = std::exp(draws.uniform(0, 0.8));
  const double unevenness = draws.uniform(0, 0.8);
  Cells distance = {};
  for (size_t i = 0; i < kCells; ++i) {
    const double y = row_of(i) - centre_y, x = column_of(i) - centre_x;
    const double along = y * std::sin(angle) + x * std::cos(angle), across = y * std::cos(angle) - x * std::sin(angle);
    distance[i] = std::hypot(along / stretch, across * stretch) + unevenness * draws.uniform();
  }
  Cells sorted = distance;
  std::ranges::sort(sorted);
  Cells cells = {};
  std::ranges::transform(distance, cells.begin(), [&](double d) { return d <= sorted[number - 1] ? 1.0 : 0.0; });
  return cells;
}

/// Returns a half, a quarter or another part of the aperture beside one or two lines.
Cells draw_part(Draws& draws) {
  Cells cells;
  cells.fill(1);
  for (uint32_t left = 1 + draws.below(2); left > 0; --left) {
    const double any = draws.uniform(0, 2 * std::numbers::pi), offset = draws.uniform(-1, 2);
    const double right = draws.below(8) * std::numbers::pi / 4;
    const double angle = draws.chance(0.6) ? right : any, from_centre = draws.chance(0.5) ? 0 : offset;
    for (size_t i = 0; i < kCells; ++i) {
      const double inside = (row_of(i) - 3.5) * std::sin(angle) + (column_of(i) - 3.5) * std::cos(angle) - from_centre;
      cells[i] = std::min(cells[i], std::clamp(inside + 0.5, 0.0, 1.0));
    }
  }
  return cells;
}

/// Returns lit patterns of a set that has enough of them, in their order or in another.
std::optional<std::vector<Cells>> choose_known(size_t number, const std::vector<capture::Codes>& known, Draws& draws) {
  std::vector<std::vector<Cells>> candidates;
  for (const capture::Codes& codes : known) {
    std::vector<Cells> lit;
    for (size_t n = 0; n < codes.num_patterns; ++n) {
      const auto pattern = codes.pattern(n);
      if (std::ranges::all_of(pattern, [](float cell) { return cell == 0.0F; })) continue;
      std::ranges::copy(pattern, lit.emplace_back().begin());
    }
    if (lit.size() >= number) candidates.push_back(std::move(lit));
  }
  if (candidates.empty() || !draws.chance(kKnownShare)) return std::nullopt;
  std::vector<Cells> chosen = candidates[draws.below(candidates.size())];
  if (!draws.chance(0.6)) {
    for (size_t n = chosen.size(); n > 1; --n) std::swap(chosen[n - 1], chosen[draws.below(n)]);
  }
  chosen.resize(number);
  return chosen;
}

/// Reads a cell, or 0 beside the aperture.
double cell_at(const Cells& cells, ptrdiff_t row, ptrdiff_t column) {
  constexpr auto kEnd = static_cast<ptrdiff_t>(kRows);
  if (row < 0 || column < 0 || row >= kEnd || column >= kEnd) return 0;
  return cells[static_cast<size_t>(row * kEnd + column)];
}

/// Returns cells of which each is `make(row, column)`.
template <typename Make>
Cells make_cells(const Make& make) {
  Cells cells;
  for (size_t i = 0; i < kCells; ++i) {
    cells[i] = make(static_cast<ptrdiff_t>(i / kRows), static_cast<ptrdiff_t>(i % kRows));
  }
  return cells;
}

/// Shifts a pattern by a part of a cell, linearly.
Cells shifted(const Cells& cells, double down, double across) {
  const ptrdiff_t above = down > 0 ? -1 : 1, beside = across > 0 ? -1 : 1;
  const double share_y = std::abs(down), share_x = std::abs(across);
  return make_cells([&](ptrdiff_t y, ptrdiff_t x) {
    const auto line = [&](ptrdiff_t row) {
      return (1 - share_x) * cell_at(cells, row, x) + share_x * cell_at(cells, row, x + beside);
    };
    return (1 - share_y) * line(y) + share_y * line(y + above);
  });
}

/// Blurs a share of the light of a pattern over 3x3 cells.
Cells blurred(const Cells& cells, double share) {
  return make_cells([&](ptrdiff_t y, ptrdiff_t x) {
    double sum = 0;
    for (ptrdiff_t dy = -1; dy <= 1; ++dy) {
      for (ptrdiff_t dx = -1; dx <= 1; ++dx) sum += cell_at(cells, y + dy, x + dx);
    }
    return (1 - share) * cell_at(cells, y, x) + share * sum / 9;
  });
}

/// Turns a sequence by a multiple of 90 degrees, and mirrors half of those.
void turn(std::vector<Cells>& sequence, Draws& draws) {
  const uint32_t turns = draws.below(4);
  const bool is_mirrored = draws.chance(0.5);
  if (!draws.chance(0.5)) return;
  constexpr auto kLast = static_cast<ptrdiff_t>(kRows) - 1;
  for (Cells& cells : sequence) {
    const Cells before = cells;
    if (is_mirrored) cells = make_cells([&](ptrdiff_t y, ptrdiff_t x) { return cell_at(before, kLast - y, x); });
    for (uint32_t n = 0; n < turns; ++n) {
      const Cells upright = cells;
      cells = make_cells([&](ptrdiff_t y, ptrdiff_t x) { return cell_at(upright, x, kLast - y); });
    }
  }
}

/// Gives a sequence edges, leakage and transmissions as of real displays.
void make_imperfect(std::vector<Cells>& sequence, Draws& draws) {
  const double down = draws.uniform(-0.5, 0.5), across = draws.uniform(-0.5, 0.5), share = draws.uniform(0.1, 0.8);
  const double leakage = draws.uniform(0.02, 0.1) * draws.below(2), transmission = draws.uniform(0.7, 1.0);
  const bool is_shifted = draws.chance(kImperfectShare), is_blurred = draws.chance(kImperfectShare),
             is_leaky = draws.chance(kImperfectShare);
  for (Cells& cells : sequence) {
    if (is_shifted) cells = shifted(cells, down, across);
    if (is_blurred) cells = blurred(cells, share);
    if (!is_leaky) continue;
    for (double& cell : cells) cell = leakage + (transmission - leakage) * cell;
  }
}

/// Returns whether every pattern is lit, and there is parallax between them.
bool is_usable(const std::vector<Cells>& sequence) {
  const auto number = static_cast<double>(sequence.size());
  std::array<double, 2> sums = {}, squares = {};
  for (const Cells& cells : sequence) {
    double light = 0, row = 0, column = 0;
    for (size_t i = 0; i < kCells; ++i) {
      light += cells[i];
      row += cells[i] * row_of(i);
      column += cells[i] * column_of(i);
    }
    if (light <= kLeastLight) return false;
    const std::array<double, 2> centroid = {row / light, column / light};
    for (size_t axis = 0; axis < 2; ++axis) {
      sums[axis] += centroid[axis] / number;
      squares[axis] += centroid[axis] * centroid[axis] / number;
    }
  }
  double parallax = 0;
  for (size_t axis = 0; axis < 2; ++axis) parallax += std::sqrt(std::max(0.0, squares[axis] - sums[axis] * sums[axis]));
  return parallax > kLeastParallax;
}

}  // namespace

capture::Codes draw_patterns(size_t num_lit, const std::vector<capture::Codes>& known, Draws& draws) {
  std::vector<Cells> sequence;
  do {
    auto chosen = choose_known(num_lit, known, draws);
    sequence = chosen ? std::move(*chosen) : std::vector<Cells>();
    const bool is_part = draws.chance(0.15);
    while (sequence.size() < num_lit) sequence.push_back(is_part ? draw_part(draws) : draw_compact(draws));
    turn(sequence, draws);
    make_imperfect(sequence, draws);
  } while (!is_usable(sequence));
  capture::Codes codes(num_lit + 1, kRows, kRows);
  for (size_t n = 0; n < num_lit; ++n) {
    std::ranges::transform(sequence[n], codes.pattern(n + 1).begin(), [](double v) { return static_cast<float>(v); });
  }
  return codes;
}

Result<capture::Codes> read_pattern_set(const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const std::filesystem::path path, find_file_or_bundled(kBundledCodes, name));
  std::optional<capture::Codes> codes;
  if (path.extension() == ".safetensors") {
    E2LF_ASSIGN_OR_RETURN(const auto model, model::read_model(path));
    codes = model.codes;
  } else {
    E2LF_ASSIGN_OR_RETURN(const Json json, read_json(path));
    E2LF_ASSIGN_OR_RETURN(codes, capture::codes_from_json(json, path.string()));
  }
  if (!codes || codes->views_y != 8 || codes->views_x != 8) {
    return fail(ErrorCode::kShape, path, "the file does not contain patterns of 8x8 cells; choose another file");
  }
  return *codes;
}

}  // namespace e2lf::learn
