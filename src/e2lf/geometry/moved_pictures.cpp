// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/model/composition.h"

namespace e2lf::geometry {
namespace {

constexpr size_t kMovedGroups = 2;             // levels and intensities
constexpr size_t kTransmissions = kSlots - 1;  // relative to that of the first place
constexpr double kUsualThreshold = 0.35;       // by which the areas of patterns become levels
constexpr double kDarkLevel = 3;               // in thresholds, below which a level depends less on the area
static_assert(kFirstDepthPlane == 4 * kSlots + capture::kNumFixedConditions + kTransmissions + kMovedGroups * kSlots);

/// Linear combinations of the channels that are known, one after another.
class Combinations {
 public:
  explicit Combinations(size_t columns) : columns_(columns) {}

  void begin(double bias = 0) {
    step_.weight.resize(step_.weight.size() + columns_);
    step_.bias.push_back(static_cast<float>(bias));
  }
  void add(size_t column, double value) {
    step_.weight[step_.weight.size() - columns_ + column] += static_cast<float>(value);
  }
  void add_constant(double value) { step_.bias.back() += static_cast<float>(value); }
  model::LinearStep take() && { return std::move(step_); }

 private:
  size_t columns_;
  model::LinearStep step_;
};

/// Makes the channels that InputKind::kMoved consists of.
class Channels {
 public:
  /// `unit`: the value of a threshold in the levels of the input.
  Channels(const Aperture& aperture, size_t num_patterns, double unit)
      : aperture_(aperture),
        transitions_(num_patterns - 1),
        inputs_(3 * transitions_ + capture::conditioning_size(num_patterns)),
        unit_(unit) {
    for (const AperturePicture& picture : aperture.pictures) {
      result_.pictures.insert(result_.pictures.end(), {picture.offset_y, picture.offset_x});
    }
    for (const auto& place : kPlaces) result_.places.insert(result_.places.end(), place.begin(), place.end());
    for (size_t group = 0; group < kMovedGroups; ++group) {
      for (size_t p = 0; p < pictures(); ++p) result_.moved.push_back(input_of(group, p));
    }
    depth_ = inputs_ + kSlots * result_.moved.size();
    dark_ = known_ = depth_ + model::kDepthOutputs;
  }

  model::MovedInput fill() && {
    find_dark_levels();
    for (size_t place = 0; place < kSlots; ++place) find_counts(place);
    Combinations planes(known_);
    for (size_t place = 0; place < kSlots; ++place) {
      planes.begin();
      add_counts(place, 1, planes);
    }
    for (size_t place = 0; place < kSlots; ++place) {
      planes.begin();
      for (size_t before = 0; before <= place; ++before) add_counts(before, 1, planes);
    }
    for (size_t place = 0; place < kSlots; ++place) {
      planes.begin();
      add_level(place, 1, planes);
    }
    for (size_t place = 0; place < kSlots; ++place) add_intensity(place, planes);
    add_conditions(planes);
    for (size_t group = 0; group < kMovedGroups; ++group) {
      for (size_t slot = 0; slot < kSlots; ++slot) {
        planes.begin();
        for (size_t p = 0; p < pictures(); ++p) planes.add(input_of(group, p), aperture_.pictures[p].slots[slot]);
      }
    }
    for (size_t output = 0; output < model::kDepthOutputs; ++output) {
      planes.begin();
      planes.add(depth_ + output, kDepthScale);
    }
    for (const double constant : aperture_.constants) planes.begin(constant);
    result_.planes = std::move(planes).take();
    return std::move(result_);
  }

 private:
  [[nodiscard]] size_t pictures() const { return aperture_.pictures.size(); }

  /// Returns the channel of the levels (group 0) or intensities of a picture, which follow the cumulative counts.
  [[nodiscard]] size_t input_of(size_t group, size_t p) const {
    return (1 + group) * transitions_ + aperture_.pictures[p].transition;
  }

  [[nodiscard]] size_t moved(size_t place, size_t group, size_t p) const {
    return inputs_ + (place * kMovedGroups + group) * pictures() + p;
  }

  void rectify(Combinations combinations) {
    result_.rectified.push_back(std::move(combinations).take());
    known_ += result_.rectified.back().bias.size();
  }

  /// Adds what the pictures of a place show, as a level.
  void add_moved_level(size_t place, double factor, Combinations& to) const {
    for (size_t p = 0; p < pictures(); ++p) {
      to.add(moved(place, 0, p), factor * aperture_.pictures[p].places[place]);
    }
  }

  /// By how far the level of a place falls short of kDarkLevel, relative to it. There is one for each place.
  void find_dark_levels() {
    Combinations dark(known_);
    for (size_t place = 0; place < kSlots; ++place) {
      dark.begin(1);
      add_moved_level(place, -1 / (kDarkLevel * unit_), dark);
    }
    rectify(std::move(dark));
  }

  /// Adds the level that the pattern of e2lf-n4 would show in a place. The level of a dark pixel hardly depends on the
  /// area of the pattern.
  void add_level(size_t place, double factor, Combinations& to) const {
    add_moved_level(place, factor, to);
    double of_area = 0;
    for (const AperturePicture& picture : aperture_.pictures) {
      of_area += picture.places[place] * std::log(kPlaceAreas[place] / picture.area);
    }
    of_area *= factor * unit_ / kUsualThreshold;
    to.add_constant(of_area);
    to.add(dark_ + place, -of_area);
  }

  /// Finds the counts of the transition to a place, rising and falling ones: what the level exceeds those before by,
  /// less half a threshold.
  void find_counts(size_t place) {
    Combinations counts(known_);
    for (const double sign : {1.0, -1.0}) {
      counts.begin(-0.5 * unit_);
      add_level(place, sign, counts);
      for (size_t before = 0; before < place; ++before) add_counts(before, -sign, counts);
    }
    counts_[place] = known_;
    rectify(std::move(counts));
  }

  void add_counts(size_t place, double factor, Combinations& to) const {
    to.add(counts_[place], factor);
    to.add(counts_[place] + 1, -factor);
  }

  void add_intensity(size_t place, Combinations& to) const {
    to.begin();
    for (size_t p = 0; p < pictures(); ++p) {
      const AperturePicture& picture = aperture_.pictures[p];
      to.add(moved(place, 1, p), picture.places[place] * kPlaceAreas[place] / picture.area);
    }
  }

  /// Adds the sensor, and the transmissions of the places relative to that of the first one.
  void add_conditions(Combinations& to) const {
    const size_t first = 3 * transitions_;
    for (size_t i = 0; i < capture::kNumFixedConditions; ++i) {
      to.begin();
      to.add(first + i, 1);
    }
    for (size_t place = 1; place < kSlots; ++place) {
      to.begin();
      for (const AperturePicture& picture : aperture_.pictures) {
        if (picture.transition == 0) continue;
        to.add(first + capture::kNumFixedConditions + picture.transition - 1,
               picture.places[place] - picture.places[0]);
      }
    }
  }

  const Aperture& aperture_;
  size_t transitions_, inputs_, depth_ = 0, dark_ = 0, known_ = 0;
  std::array<size_t, kSlots> counts_ = {};
  double unit_;
  model::MovedInput result_;
};

}  // namespace

Result<model::MovedInput> moved_input(const capture::Codes& codes, const std::vector<model::InputGroup>& input) {
  if (capture::codes_of_whole_cycle(codes)) {
    return fail(ErrorCode::kUnsupported, "",
                "networks of moved pictures are trained for the transitions of the lit patterns; give those alone");
  }
  E2LF_ASSIGN_OR_RETURN(const Aperture aperture, describe_aperture(codes));
  const auto level = std::ranges::find(input, model::InputKind::kLevel, &model::InputGroup::kind);
  const double unit = level == input.end() ? 1.0 : double{level->scale};
  return Channels(aperture, codes.num_patterns, unit).fill();
}

Result<model::Model> composed_for_patterns(model::Model network, model::Model disparity, const capture::Codes& codes) {
  const bool has_few_views = codes.views_y > network.views_y || codes.views_x > network.views_x;
  if (has_few_views && !model::is_depth_network(network)) {
    return fail(ErrorCode::kUnsupported, network.name, "it gives ", network.views_y, "x", network.views_x,
                " views, but the patterns have ", codes.views_y, "x", codes.views_x,
                " cells; choose the inversion as the method");
  }
  E2LF_ASSIGN_OR_RETURN(const model::MovedInput input, moved_input(codes, disparity.input));
  const model::Guide guide = network.open_guide ? network.open_guide->guide : model::Guide();
  const model::PrecisionLoss loss = network.precision_loss;  // that of the composed network
  network.open_guide = nullptr;
  E2LF_ASSIGN_OR_RETURN(model::Model result,
                        model::on_moved_pictures(std::move(network), std::move(disparity), input, guide));
  result.precision_loss = loss;
  result.is_adapted = true;
  E2LF_RETURN_IF_ERROR(model::validate(result, result.name));
  return result;
}

}  // namespace e2lf::geometry
