// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;

constexpr size_t kDeciles = 10;
constexpr double kPercent = 100;

/// A pixel that is compared.
struct Pair {
  float truth, estimate, confidence;

  [[nodiscard]] bool is_finite() const { return std::isfinite(estimate); }
  [[nodiscard]] double error() const {
    return is_finite() ? std::abs(double{estimate} - double{truth}) : std::numeric_limits<double>::infinity();
  }
};

std::vector<Pair> pairs_within(const Image& estimate, const Image& confidence, const Image& truth, size_t border) {
  std::vector<Pair> pairs;
  for (size_t y = border; y + border < truth.height; ++y) {
    for (size_t x = border; x + border < truth.width; ++x) {
      const size_t i = y * truth.width + x;
      if (!std::isfinite(truth.pixels[i])) continue;
      pairs.push_back({truth.pixels[i], estimate.pixels[i], confidence.pixels.empty() ? 0 : confidence.pixels[i]});
    }
  }
  return pairs;
}

double bad_percent(const std::vector<Pair>& pairs, double most_px) {
  const auto bad = std::ranges::count_if(pairs, [&](const Pair& pair) { return pair.error() > most_px; });
  return kPercent * static_cast<double>(bad) / static_cast<double>(pairs.size());
}

double mean_absolute(const std::vector<Pair>& pairs) {
  double sum = 0, count = 0;
  for (const Pair& pair : pairs) {
    if (!pair.is_finite()) continue;
    sum += pair.error();
    ++count;
  }
  return sum / count;
}

double regression_slope(const std::vector<Pair>& pairs) {
  double count = 0, mean_truth = 0, mean_estimate = 0, products = 0, squares = 0;
  for (const Pair& pair : pairs) {
    if (!pair.is_finite()) continue;
    ++count;
    const double off_truth = pair.truth - mean_truth;
    mean_truth += off_truth / count;
    mean_estimate += (pair.estimate - mean_estimate) / count;
    products += off_truth * (pair.estimate - mean_estimate);
    squares += off_truth * (pair.truth - mean_truth);
  }
  return squares > 0 ? products / squares : 0;
}

/// Returns the errors of growing parts of the pixels, from the most certain ones on.
std::vector<ErrorPart> parts_of(std::vector<Pair> pairs) {
  std::ranges::stable_sort(pairs, [](const Pair& a, const Pair& b) { return a.confidence > b.confidence; });
  std::vector<ErrorPart> parts;
  double bad = 0, sum = 0, finite = 0;
  size_t i = 0;
  for (size_t part = 1; part <= kDeciles; ++part) {
    for (; i < part * pairs.size() / kDeciles; ++i) {
      bad += pairs[i].error() > 0.2 ? 1 : 0;
      if (!pairs[i].is_finite()) continue;
      sum += pairs[i].error();
      ++finite;
    }
    if (finite == 0) continue;
    parts.push_back(
        {kPercent * static_cast<double>(part) / kDeciles, kPercent * bad / static_cast<double>(i), sum / finite});
  }
  return parts;
}

}  // namespace

Result<DisparityError> compare(const Image& estimate, const Image& confidence, const Image& truth, size_t border) {
  const auto has_size_of_truth = [&](const Image& image) {
    return image.width == truth.width && image.height == truth.height && image.channels == 1;
  };
  if (!has_size_of_truth(estimate) || !(confidence.pixels.empty() || has_size_of_truth(confidence))) {
    return fail(ErrorCode::kShape, "", "the disparity map has ", estimate.width, "x", estimate.height,
                " px, the true one ", truth.width, "x", truth.height, " px; compare maps of the same view");
  }
  if (truth.width <= 2 * border || truth.height <= 2 * border) {
    return fail(ErrorCode::kShape, "", "a border of ", border, " px leaves nothing of ", truth.width, "x", truth.height,
                " px; use a narrower border");
  }
  const std::vector<Pair> pairs = pairs_within(estimate, confidence, truth, border);
  if (std::ranges::none_of(pairs, [](const Pair& pair) { return pair.is_finite(); })) {
    return fail(ErrorCode::kInvalidValue, "",
                "no pixel has both a finite disparity and a finite true one; check the maps");
  }
  DisparityError result{bad_percent(pairs, 0.07),
                        bad_percent(pairs, 0.2),
                        mean_absolute(pairs),
                        regression_slope(pairs),
                        pairs.size(),
                        {}};
  if (!confidence.pixels.empty()) result.most_certain = parts_of(pairs);
  return result;
}

namespace fs = std::filesystem;

Result<Image> read_disparity(const fs::path& path) {
  if (path.extension() == ".pfm") {
    return read_file(path).and_then([&](const auto& bytes) { return decode_pfm(bytes, path.string()); });
  }
  if (path.extension() != ".npy") {
    return fail(ErrorCode::kUnsupported, path, "this is not a disparity map; give .npy or .pfm");
  }
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
  if (array.shape.size() != 2 || array.num_elements() == 0) {
    return fail(ErrorCode::kShape, path, "has shape ", shape_text(array.shape), "; a disparity map is [y, x]");
  }
  Image image(array.shape[1], array.shape[0], 1);
  E2LF_ASSIGN_OR_RETURN(image.pixels, array.to_float(path.string()));
  return image;
}

std::optional<fs::path> find_true_disparity(const fs::path& scene) {
  for (const char* name : {"gt_disparity.npy", "gt_disp_lowres.pfm"}) {
    if (is_file(scene / name)) return scene / name;
  }
  return std::nullopt;
}

Result<TrueDisparity> true_disparity(const lightfield::LightField& true_views, const std::optional<fs::path>& file) {
  if (!file) {
    E2LF_ASSIGN_OR_RETURN(DisparityMap map, estimate_disparity(true_views));
    return TrueDisparity{std::move(map.disparity), kDepthOfTrueViews};
  }
  E2LF_ASSIGN_OR_RETURN(Image disparity, read_disparity(*file));
  const lightfield::Shape& shape = true_views.shape();
  if (disparity.width == shape.width && disparity.height == shape.height) {
    return TrueDisparity{std::move(disparity), file->string()};
  }
  return fail(ErrorCode::kShape, file->string(), "has ", disparity.width, "x", disparity.height, " px, the views have ",
              shape.width, "x", shape.height, "; give the map of this light field");
}

Result<FoundDisparity> judge_disparity(const lightfield::LightField& light_field, const Image& truth,
                                       const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(DisparityMap map, estimate_disparity(light_field, {}, progress));
  E2LF_ASSIGN_OR_RETURN(DisparityError error, compare(map.disparity, map.confidence, truth));
  return FoundDisparity{std::move(map.disparity), std::move(error)};
}

Result<void> check_true_disparity(const lightfield::LightField& true_views, const TrueDisparity& truth,
                                  const ProgressFn& progress) {
  constexpr double kMostBadPercent = 50;
  E2LF_ASSIGN_OR_RETURN(const FoundDisparity found, judge_disparity(true_views, truth.disparity, progress));
  const double bad_percent = found.error.bad_20_percent;
  if (bad_percent <= kMostBadPercent) return {};
  Image negated = truth.disparity;
  for (float& value : negated.pixels) value = -value;
  E2LF_ASSIGN_OR_RETURN(const DisparityError opposite, compare(found.disparity, {}, negated));
  const std::string share = formatted(
      "%.0f %% of the disparities are off by more than 0.2 px from those that are found "
      "in the true views",
      bad_percent);
  if (opposite.bad_20_percent < bad_percent / 2) {
    return fail(ErrorCode::kInvalidValue, truth.source, share,
                formatted(", but only %.0f %% of their negatives; ", opposite.bad_20_percent),
                "negate them: a point at x in one view is at x + disparity in the next view to the right");
  }
  log_warning(cat(truth.source, ": ", share,
                  "; they may be distances, or those of another view or scale: give px per view step"));
  return {};
}

bool has_comparable_disparity(const lightfield::Shape& shape) {
  return shape.num_views() > 1 && shape.height > 2 * kErrorBorderPx && shape.width > 2 * kErrorBorderPx;
}

}  // namespace e2lf::depth
