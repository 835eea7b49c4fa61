// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/model/composition.h"

namespace e2lf::geometry {
namespace {

constexpr size_t kMovedGroups = 2;   // levels and intensities
constexpr float kDepthScale = 0.3F;  // of disparity and scale among the planes
static_assert(model::kCentralPlanes == 2 * kMovedGroups * kSlots + /*light*/ 2 + model::kDepthOutputs +
                                           kApertureConstants + capture::kNumFixedConditions +
                                           /*transmissions*/ kSlots);

/// Fills the weights of InputKind::kCentral plane by plane.
class Planes {
 public:
  /// `intensity_scale`: of the intensities in the input.
  Planes(const Aperture& aperture, size_t num_patterns, double intensity_scale)
      : aperture_(aperture),
        transitions_(num_patterns - 1),
        inputs_(3 * transitions_ + capture::conditioning_size(num_patterns)),
        intensity_scale_(intensity_scale) {
    const size_t pictures = aperture.pictures.size();
    columns_ = inputs_ + kMovedGroups * pictures + model::kDepthOutputs;
    result_.weight.resize(model::kCentralPlanes * columns_);
    result_.bias.resize(model::kCentralPlanes);
    result_.base.resize(kMovedGroups * pictures);
    for (const AperturePicture& picture : aperture.pictures) {
      result_.offsets.insert(result_.offsets.end(), {picture.offset_y, picture.offset_x});
    }
  }

  model::CentralInput fill() && {
    choose_moved();
    for (size_t group = 0; group < kMovedGroups; ++group) add_slots([&](size_t p) { return moved(group, p); });
    for (size_t group = 0; group < kMovedGroups; ++group) add_slots([&](size_t p) { return input_of(group, p); });
    add_light();
    for (size_t output = 0; output < model::kDepthOutputs; ++output) {
      set(plane_++, columns_ - model::kDepthOutputs + output, kDepthScale);
    }
    const size_t conditions = 3 * transitions_;
    set(plane_++, conditions + capture::kCyclesCondition, 1);
    for (const double constant : aperture_.constants) result_.bias[plane_++] = static_cast<float>(constant);
    for (size_t i = 0; i < capture::kNumFixedConditions; ++i) {
      if (i != capture::kCyclesCondition) set(plane_++, conditions + i, 1);
    }
    add_transmissions(conditions + capture::kNumFixedConditions);
    return std::move(result_);
  }

 private:
  [[nodiscard]] size_t pictures() const { return aperture_.pictures.size(); }
  [[nodiscard]] size_t moved(size_t group, size_t p) const { return inputs_ + group * pictures() + p; }

  /// Returns the channel of the levels (group 0) or intensities of a picture, which follow the cumulative counts.
  [[nodiscard]] size_t input_of(size_t group, size_t p) const {
    return (1 + group) * transitions_ + aperture_.pictures[p].transition;
  }

  void set(size_t plane, size_t column, double value) {
    result_.weight[plane * columns_ + column] = static_cast<float>(value);
  }

  void choose_moved() {
    for (size_t group = 0; group < kMovedGroups; ++group) {
      for (size_t p = 0; p < pictures(); ++p) result_.moved.push_back(input_of(group, p));
    }
  }

  template <typename Column>
  void add_slots(const Column& column) {
    for (size_t slot = 0; slot < kSlots; ++slot, ++plane_) {
      for (size_t p = 0; p < pictures(); ++p) set(plane_, column(p), aperture_.pictures[p].slots[slot]);
    }
  }

  /// The light of the open aperture, as the means of what the pictures show, by their areas and by their sharpness.
  void add_light() {
    double area = 0;
    for (const AperturePicture& picture : aperture_.pictures) area += picture.area;
    const auto number = static_cast<double>(pictures());
    for (size_t p = 0; p < pictures(); ++p) {
      const AperturePicture& picture = aperture_.pictures[p];
      const double by_area = 1 / (intensity_scale_ * area);
      result_.base[pictures() + p] = static_cast<float>(by_area);
      set(plane_, moved(1, p), by_area);
      set(plane_ + 1, moved(1, p), picture.weight / number / (intensity_scale_ * picture.area));
    }
    plane_ += 2;
  }

  void add_transmissions(size_t first) {
    for (size_t slot = 0; slot < kSlots; ++slot, ++plane_) {
      for (const AperturePicture& picture : aperture_.pictures) {
        if (picture.transition > 0) set(plane_, first + picture.transition - 1, picture.slots[slot]);
      }
    }
  }

  const Aperture& aperture_;
  size_t transitions_, inputs_, columns_ = 0, plane_ = 0;
  double intensity_scale_;
  model::CentralInput result_;
};

}  // namespace

Result<model::CentralInput> central_input(const capture::Codes& codes, const std::vector<model::InputGroup>& input) {
  if (capture::codes_of_whole_cycle(codes)) {
    return fail(
        ErrorCode::kUnsupported, "",
        "networks of the central picture are trained for the transitions of the lit patterns; give those alone");
  }
  E2LF_ASSIGN_OR_RETURN(const Aperture aperture, describe_aperture(codes));
  const auto intensity = std::ranges::find(input, model::InputKind::kIntensity, &model::InputGroup::kind);
  const double scale = intensity == input.end() ? 1.0 : double{intensity->scale};
  return Planes(aperture, codes.num_patterns, scale).fill();
}

Result<model::Model> rendered_for_patterns(model::Model picture, model::Model disparity, const capture::Codes& codes) {
  E2LF_ASSIGN_OR_RETURN(const model::CentralInput input, central_input(codes, disparity.input));
  picture.views_y = codes.views_y;
  picture.views_x = codes.views_x;
  picture.open_guide = nullptr;
  E2LF_ASSIGN_OR_RETURN(model::Model result, model::rendered(std::move(picture), std::move(disparity), input));
  result.is_adapted = true;
  E2LF_RETURN_IF_ERROR(model::validate(result, result.name));
  return result;
}

}  // namespace e2lf::geometry
