// SPDX-License-Identifier: MIT
#include "e2lf/recon/view_weights.h"

#include <cmath>
#include <utility>

#include "e2lf/base/contract.h"

namespace e2lf::recon {
namespace {

using Matrix = std::vector<std::vector<double>>;

/// Solves matrix * x = right for all columns of `right` in place, by Gauss-Jordan elimination with pivoting.
void solve(Matrix matrix, Matrix& right) {
  const size_t size = matrix.size();
  for (size_t column = 0; column < size; ++column) {
    size_t pivot = column;
    for (size_t row = column; row < size; ++row) {
      if (std::abs(matrix[row][column]) > std::abs(matrix[pivot][column])) pivot = row;
    }
    std::swap(matrix[column], matrix[pivot]);
    std::swap(right[column], right[pivot]);
    for (size_t row = 0; row < size; ++row) {
      if (row == column) continue;
      const double factor = matrix[row][column] / matrix[column][column];
      for (size_t i = column; i < size; ++i) matrix[row][i] -= factor * matrix[column][i];
      for (size_t i = 0; i < right[row].size(); ++i) right[row][i] -= factor * right[column][i];
    }
  }
  for (size_t row = 0; row < size; ++row) {
    for (double& value : right[row]) value /= matrix[row][row];
  }
}

/// Computes B K, the prior correlation of each view with each normalised coded image, [pattern][view].
Matrix correlations(const capture::Codes& codes, const std::vector<size_t>& lit, double length) {
  Matrix result(lit.size(), std::vector<double>(codes.pattern_size()));
  for (size_t i = 0; i < lit.size(); ++i) {
    const auto pattern = codes.pattern(lit[i]);
    double open = 0;
    for (const float value : pattern) open += value;
    for (size_t view = 0; view < codes.pattern_size(); ++view) {
      for (size_t other = 0; other < codes.pattern_size(); ++other) {
        const auto dy = static_cast<double>(view / codes.views_x) - static_cast<double>(other / codes.views_x);
        const auto dx = static_cast<double>(view % codes.views_x) - static_cast<double>(other % codes.views_x);
        result[i][view] += pattern[other] / open * std::exp(-(dy * dy + dx * dx) / (2 * length * length));
      }
    }
  }
  return result;
}

}  // namespace

std::vector<std::vector<double>> view_weights(const capture::Codes& codes, const ViewPrior& prior) {
  std::vector<size_t> lit;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    double open = 0;
    for (const float value : codes.pattern(n)) open += value;
    if (open > 0) lit.push_back(n);
  }
  E2LF_REQUIRE(!lit.empty(), "one pattern at least must let light through");

  const size_t size = lit.size(), views = codes.pattern_size();
  const Matrix with_views = correlations(codes, lit, prior.correlation_length);
  Matrix system(size + 1, std::vector<double>(size + 1, 1.0)), solution = with_views;
  system[size][size] = 0;
  for (size_t i = 0; i < size; ++i) {
    for (size_t j = 0; j < size; ++j) {
      double open = 0, sum = 0;
      for (size_t view = 0; view < views; ++view) {
        open += codes.pattern(lit[j])[view];
        sum += with_views[i][view] * codes.pattern(lit[j])[view];
      }
      system[i][j] = sum / open + (i == j ? prior.noise : 0);
    }
  }
  solution.emplace_back(views, 1.0);
  solve(std::move(system), solution);

  Matrix weights(views, std::vector<double>(codes.num_patterns));
  for (size_t i = 0; i < size; ++i) {
    for (size_t view = 0; view < views; ++view) weights[view][lit[i]] = solution[i][view];
  }
  return weights;
}

}  // namespace e2lf::recon
