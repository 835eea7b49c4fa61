// SPDX-License-Identifier: MIT
// The axes, values and memory of stored light fields; declared in formats/readers.h.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {
namespace {

/// The largest numbers of 8, 10, 12, 14 and 16 bits.
constexpr float kWhites[] = {255, 1023, 4095, 16383, 65535};

/// Returns the likely white of samples whose largest value is `high`.
float likely_white(float high) {
  const auto* found =
      std::find_if(std::begin(kWhites), std::end(kWhites), [high](float white) { return high <= white; });
  return found == std::end(kWhites) ? high : *found;
}

/// Deviations from [0, 1] up to this size are rounding errors.
constexpr float kRangeTolerance = 1e-3F;

/// Returns false for NaN, infinity and values that the policy refuses, and clamps the others if the policy requires it.
bool settle(float& value, RangePolicy policy) {
  if (policy == RangePolicy::kKeep) return std::fabs(value) <= kMostKept;
  const float clamped = std::clamp(value, 0.0F, 1.0F);
  const bool good =
      policy == RangePolicy::kClamp ? std::fabs(value) <= kMostKept : std::fabs(value - clamped) <= kRangeTolerance;
  value = clamped;
  return good;
}

/// Collects samples, some of which are outside of the requested range.
struct BadSamples {
  std::string first;                                                ///< the first sample out of range and its place
  float low = std::numeric_limits<float>::infinity(), high = -low;  ///< range of the finite samples, as stored
  size_t not_finite = 0;

  void add(float stored) {
    if (!std::isfinite(stored)) {
      ++not_finite;
      return;
    }
    low = std::min(low, stored);
    high = std::max(high, stored);
  }
  /// Describes the problem and its remedy, as an error of kind kInvalidValue.
  [[nodiscard]] Error error(const std::string& location) const {
    if (not_finite > 0) {
      return fail(ErrorCode::kInvalidValue, location, "contains ", not_finite, " value",
                  not_finite == 1 ? " that is" : "s that are", " not finite (NaN or infinity); the first is ", first,
                  "; replace them by values in [0, 1]");
    }
    const std::string what =
        cat("a light field has values in [0, 1], but these are in ", low, "..", high, ", the first outside is ", first);
    if (low < -kRangeTolerance) {
      return fail(ErrorCode::kInvalidValue, location, what, "; scale them to 0..1",
                  low >= -1.0F && high <= 1.0F ? ", from -1..1 as (x + 1) / 2" : "");
    }
    return {ErrorCode::kInvalidValue, cat(what, "; give the value that is white, e.g. ", likely_white(high)), location,
            "white"};
  }
};

}  // namespace

Result<void> check_values(const LightField& light_field, float assumed_white, const std::string& location) {
  const auto [low, high] = std::ranges::minmax(light_field.data());
  const float most = std::round(high * assumed_white);
  const bool are_bits = assumed_white == 255.0F && most == 1.0F;
  const bool are_bytes = assumed_white == 65535.0F && most > 0.0F && most <= 255.0F;
  if (are_bits || are_bytes) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the values are in ", std::round(low * assumed_white), "..", most,
                     ", although the largest of their type is ", assumed_white, "; give the value that is white, e.g. ",
                     are_bits ? 1 : 255),
                 location, "white"};
  }
  return {};
}

namespace {

/// Checks that views have at least as many pixels as there are views along each axis. If they do not, the axes are
/// probably in another order: fails with kShape if an axis has more than 32 views, and warns otherwise.
Result<void> check_axes(const Shape& stored, const std::string& location) {
  constexpr size_t kFewViews = 32;
  if (stored.views_y <= stored.height || stored.views_x <= stored.width) return {};
  const std::string found = cat("with the axes [view_y, view_x, y, x], the array has ", stored.views_y, "x",
                                stored.views_x, " views of ", stored.width, "x", stored.height, " px");
  if (std::max(stored.views_y, stored.views_x) > kFewViews) {
    return fail(ErrorCode::kShape, location, found, "; the axes are probably in another order; transpose them");
  }
  log_warning(cat(location, ": ", found, "; if the axes are in another order, transpose them"));
  return {};
}

/// Returns the stored number that means 1: the one in the options if it is set, otherwise that of the array.
float white_of(const StoredArray& array, const ReadOptions& options) {
  return options.white > 0.0F ? options.white : array.white;
}

Result<ChosenViews> choose_axis(size_t stored, const AxisViews& wanted, const char* axis, const std::string& location) {
  E2LF_REQUIRE(wanted.step >= 1, "the step between views is at least 1");
  ChosenViews chosen{.first = wanted.first.value_or(0), .step = wanted.step, .count = wanted.count, .stored = stored};
  if (wanted.count == 0 && chosen.first < stored) chosen.count = (stored - 1 - chosen.first) / wanted.step + 1;
  if (chosen.count == 0 || chosen.first >= stored || chosen.count - 1 > (stored - 1 - chosen.first) / wanted.step) {
    return fail(ErrorCode::kShape, location, "has ", stored, " view ", axis, "s, which is fewer than the requested ",
                std::max<size_t>(wanted.count, 1), wanted.first ? cat(" from number ", *wanted.first) : "",
                " with step ", wanted.step, "; give a light field with more views");
  }
  if (wanted.count > 0 && !wanted.first) chosen.first = (stored - ((wanted.count - 1) * wanted.step + 1)) / 2;
  return chosen;
}

/// Logs which views of a larger grid were selected.
void log_choice(const ChosenGrid& grid, const std::string& location) {
  if (grid.y.count == grid.y.stored && grid.x.count == grid.x.stored) return;
  const auto range = [](const ChosenViews& views) {
    const std::string step = views.step == 1 ? "" : cat(" in steps of ", views.step);
    return cat(views.first, "..", views.first + views.step * (views.count - 1), step, " of ", views.stored);
  };
  log_info(cat(location, ": took view rows ", range(grid.y), " and columns ", range(grid.x)));
}

/// Copies [y, x] blocks of the selected views. Each block is read for all views before the next one, because in
/// MATLAB's order the views of a pixel are contiguous.
template <typename T>
class Gather {
 public:
  Gather(const StoredArray& array, const ChosenGrid& grid, const ReadOptions& options, const LightFieldOutput& out)
      : array_(array),
        grid_(grid),
        range_(options.range),
        white_(white_of(array, options)),
        may_be_outside_(!std::is_unsigned_v<T> || white_ < static_cast<float>(std::numeric_limits<T>::max())),
        out_(out),
        shape_(shape_of(out)) {}

  /// Returns true if all samples were valid.
  bool run() {
    std::atomic<bool> good{true};
    parallel_for(shape_.height, 8, [&](size_t begin, size_t end) {
      bool chunk_good = true;
      for (size_t y = begin; y < end; ++y) chunk_good = copy_row(y) && chunk_good;
      if (!chunk_good) good = false;
    });
    return good;
  }

  /// Describes the invalid samples and the place of the first one. It is called only if run() returned false.
  [[nodiscard]] BadSamples bad_samples() const {
    BadSamples bad;
    const size_t channels = source_channels();
    for (size_t i = 0; i < shape_.num_views() * shape_.height * shape_.width * channels; ++i) {
      const size_t channel = i % channels, x = i / channels % shape_.width;
      const size_t y = i / channels / shape_.width % shape_.height;
      const size_t view = i / channels / shape_.width / shape_.height;
      const size_t view_y = grid_.y[view / shape_.views_x], view_x = grid_.x[view % shape_.views_x];
      float value = sample(view_offset(view_y, view_x) + y * array_.strides.y + x * array_.strides.x, channel);
      const float stored = value * white_;
      bad.add(stored);
      if (!settle(value, range_) && bad.first.empty()) {
        const bool is_view = array_.shape.num_views() == 1;
        bad.first = cat(stored, " at ", is_view ? "" : cat("view row ", view_y, ", view column ", view_x, ", "), "y ",
                        y, ", x ", x);
      }
    }
    return bad;
  }

 private:
  static constexpr size_t kBlock = 32;

  [[nodiscard]] size_t source_channels() const { return array_.shape.channels >= 3 ? 3 : 1; }
  [[nodiscard]] size_t view_offset(size_t view_y, size_t view_x) const {
    return view_y * array_.strides.view_y + view_x * array_.strides.view_x;
  }
  [[nodiscard]] float sample(size_t offset, size_t channel) const {
    const size_t at = offset + channel * array_.strides.channel;
    return static_cast<float>(load_element<T>(array_.bytes.data() + at * sizeof(T))) / white_;
  }

  bool copy_row(size_t y) {
    bool good = true;
    for (size_t begin = 0; begin < shape_.width; begin += kBlock) {
      const size_t end = std::min(shape_.width, begin + kBlock);
      for (size_t view_y = 0; view_y < shape_.views_y; ++view_y) {
        for (size_t view_x = 0; view_x < shape_.views_x; ++view_x) {
          float* row = out_[view_y][view_x][y].data;
          const size_t offset = view_offset(grid_.y[view_y], grid_.x[view_x]) + y * array_.strides.y;
          good = copy_block(offset, begin, end, row) && good;
        }
      }
    }
    return good;
  }

  bool copy_block(size_t offset, size_t begin, size_t end, float* row) {
    bool good = true;
    const bool colour_out = shape_.channels == 3;
    const size_t channels = source_channels();
    for (size_t x = begin; x < end; ++x) {
      float values[3] = {};
      for (size_t channel = 0; channel < channels; ++channel) {
        values[channel] = sample(offset + x * array_.strides.x, channel);
        if (may_be_outside_) good = settle(values[channel], range_) && good;
      }
      if (colour_out) {
        std::copy_n(values, 3, row + 3 * x);
      } else {
        row[x] = channels == 3 ? grey_of(values[0], values[1], values[2]) : values[0];
      }
    }
    return good;
  }

  const StoredArray& array_;
  const ChosenGrid& grid_;
  RangePolicy range_;
  float white_;
  bool may_be_outside_;  ///< outside of [0, 1], once divided by white
  const LightFieldOutput& out_;
  Shape shape_;
};

}  // namespace

AxisStrides uvhwc_strides(const Shape& shape) {
  const size_t x = shape.channels, y = x * shape.width, view_x = y * shape.height;
  return {.view_y = view_x * shape.views_x, .view_x = view_x, .y = y, .x = x, .channel = 1};
}

AxisStrides matlab_uvhwc_strides(const Shape& shape) {
  const size_t y = shape.views_y * shape.views_x, x = y * shape.height;
  return {.view_y = 1, .view_x = shape.views_y, .y = y, .x = x, .channel = x * shape.width};
}

AxisStrides huwvc_strides(const Shape& shape) {
  const size_t view_x = shape.channels, x = view_x * shape.views_x, view_y = x * shape.width;
  return {.view_y = view_y, .view_x = view_x, .y = view_y * shape.views_y, .x = x, .channel = 1};
}

AxisStrides vwuh_strides(const Shape& shape) {
  const size_t view_y = shape.height, x = view_y * shape.views_y, view_x = x * shape.width;
  return {.view_y = view_y, .view_x = view_x, .y = 1, .x = x, .channel = 0};
}

size_t views_per_axis(size_t num_views) {
  const auto root = static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(num_views))));
  return root * root == num_views ? root : 0;
}

float white_of_type(std::string_view code) {
  if (code == "u1") return 255.0F;
  if (code == "u2") return 65535.0F;
  return code == "b1" || code.starts_with('f') ? 1.0F : 0.0F;
}

size_t StoredArray::num_bytes() const {
  return shape.size() * element_size(type);
}

StoredArray stored_view(const RawImage& image) {
  StoredArray view;
  view.shape = {1, 1, image.height, image.width, image.channels};
  view.strides = uvhwc_strides(view.shape);
  view.type = image.sample_bytes == 1 ? "u1" : "u2";
  view.bytes = image.samples;
  view.white = white_of_type(view.type);
  return view;
}

Result<ChosenGrid> choose_views(size_t stored_y, size_t stored_x, const ReadOptions& options,
                                const std::string& location) {
  ChosenGrid grid;
  E2LF_ASSIGN_OR_RETURN(grid.y, choose_axis(stored_y, options.views_y, "row", location));
  E2LF_ASSIGN_OR_RETURN(grid.x, choose_axis(stored_x, options.views_x, "column", location));
  grid.y.reversed = options.reverse_rows;
  log_choice(grid, location);
  return grid;
}

Result<void> check_memory(const Shape& shape, size_t bytes_each, const ReadOptions& options,
                          const std::string& location) {
  double bytes = static_cast<double>(bytes_each);
  for (const size_t extent : {shape.views_y, shape.views_x, shape.height, shape.width, shape.channels}) {
    if (extent == 0) return fail(ErrorCode::kShape, location, "the light field has no samples; check the file");
    bytes *= static_cast<double>(extent);
  }
  if (bytes <= static_cast<double>(options.max_bytes)) return {};
  return fail(ErrorCode::kUnsupported, location, "requires ", bytes / 1e9, " GB, which exceeds the limit of ",
              static_cast<double>(options.max_bytes) / 1e9, " GB; raise the limit or read fewer views");
}

Result<void> convert_views(const StoredArray& array, const ChosenGrid& grid, const ReadOptions& options,
                           const LightFieldOutput& out, const std::string& location) {
  Result<void> status;
  with_element_type(array.type, [&](auto type) {
    Gather<decltype(type)> job(array, grid, options, out);
    if (!job.run()) status = job.bad_samples().error(location);
  });
  return status;
}

Result<LightField> from_stored(const StoredArray& array, const ReadOptions& options, const std::string& location) {
  E2LF_REQUIRE(array.bytes.size() == array.num_bytes(), "the samples must fill the shape");
  if (white_of(array, options) == 0.0F) {
    return Error{ErrorCode::kUnsupported,
                 "the type of the numbers does not determine which value is white; give it, e.g. 255", location,
                 "white"};
  }
  E2LF_RETURN_IF_ERROR(check_axes(array.shape, location));
  E2LF_ASSIGN_OR_RETURN(const ChosenGrid grid,
                        choose_views(array.shape.views_y, array.shape.views_x, options, location));
  const Shape shape{grid.y.count, grid.x.count, array.shape.height, array.shape.width,
                    options.colour && array.shape.channels >= 3 ? size_t{3} : size_t{1}};
  E2LF_RETURN_IF_ERROR(check_memory(shape, sizeof(float), options, location));
  LightField out(shape);
  E2LF_RETURN_IF_ERROR(convert_views(array, grid, options, out, location));
  E2LF_RETURN_IF_ERROR(check_values(out, options.white > 0.0F ? 0.0F : array.white, location));
  return out;
}

}  // namespace e2lf::lightfield
