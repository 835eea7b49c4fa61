// SPDX-License-Identifier: MIT
#include "e2lf/recon/reconstruct.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/model/network.h"

namespace e2lf::recon {
namespace {

/// Every program that reconstructs knows the operations of the bundled networks, before it reads the first model.
[[maybe_unused]] const bool kKnowsGeometry = (geometry::add_operations(), true);

constexpr size_t kSamples = 1 << 18;
constexpr double kBrightQuantile = 0.995, kDarkQuantile = 0.005;
constexpr float kMostBlack = 0.15F;  ///< relative to the bright level; keeps the contrast of scenes without black

/// Returns a quantile of the finite values, or 0 if there are none.
float level_of(const LightFieldView& values, double quantile) {
  // An odd stride visits the columns of an image evenly even if its width is a power of two.
  const size_t stride = values.size() / kSamples | 1;
  std::vector<float> samples;
  samples.reserve(values.size() / stride + 1);
  for (size_t i = 0; i < values.size(); i += stride) {
    if (const float value = values.value(i); std::isfinite(value)) samples.push_back(value);
  }
  if (samples.empty()) return 0;
  const auto rank = static_cast<ptrdiff_t>(quantile * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
  return samples[static_cast<size_t>(rank)];
}

}  // namespace

float auto_gain(const LightFieldView& light_field, float black) {
  const float level = level_of(light_field, kBrightQuantile) - black;
  if (level <= 0 || (level >= 0.7F && level <= 1.0F)) return 1;
  return std::clamp(0.9F / level, 0.25F, 64.0F);
}

float auto_black(const LightFieldView& light_field) {
  const float bright = std::max(0.0F, level_of(light_field, kBrightQuantile));
  return std::clamp(level_of(light_field, kDarkQuantile), 0.0F, kMostBlack * bright);
}

void apply_tone(const LightFieldOutput& light_field, float black, float gain) {
  if (black == 0.0F && gain == 1.0F) return;
  for_each_value(light_field, [&](float& value) { value = gain * (value - black); });
}

std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple) {
  const size_t side = std::bit_ceil(size_multiple);
  std::vector<GridShift> shifts;
  for (size_t i = 0; i < side * side && shifts.size() < count; ++i) {
    // The bits of i alternate between both coordinates: four shifts cover the finest grid, and sixteen the next coarser
    // one. The odd factors separate shifts that are neighbours in this order.
    size_t y = 0, both = 0;
    for (size_t bit = 0; (size_t{1} << bit) < side; ++bit) {
      y |= (i >> (2 * bit) & 1U) << bit;
      both |= (i >> (2 * bit + 1) & 1U) << bit;
    }
    const GridShift shift{3 * y % side, 5 * (both ^ y) % side};
    if (std::max(shift.y, shift.x) < size_multiple) shifts.push_back(shift);
  }
  return shifts;
}

namespace {

/// Adds to `field` the part of `larger` that begins at `shift`.
void add_crop(const lightfield::LightField& larger, const GridShift& shift, lightfield::LightField& field) {
  const lightfield::Shape &shape = field.shape(), &from_shape = larger.shape();
  for (size_t row = 0; row < shape.num_views() * shape.height; ++row) {
    const size_t view = row / shape.height, y = row % shape.height + shift.y;
    const float* from = larger.data().data() + (view * from_shape.height + y) * from_shape.width + shift.x;
    float* to = field.data().data() + row * shape.width;
    for (size_t x = 0; x < shape.width; ++x) to[x] += from[x];
  }
}

}  // namespace

lightfield::Shape Reconstructor::field_shape(const capture::MeasurementView& measurement) const {
  const bool is_depth = model::is_depth_network(model_);
  return {is_depth ? 1 : model_.views_y, is_depth ? model::kDepthOutputs : model_.views_x, measurement.height(),
          measurement.width()};
}

Result<Reconstructor> Reconstructor::create(model::Model model, const engine::EngineOptions& given) {
  engine::EngineOptions options = given;
  if (model.precision_loss.bfloat16_db) options.checked.push_back(engine::Precision::kBfloat16);
  E2LF_ASSIGN_OR_RETURN(model, geometry::for_own_patterns(std::move(model)));
  E2LF_RETURN_IF_ERROR(model::validate(model, model.name));
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model.network, model.weights, options));
  if (!model.camera) model.camera.emplace().constants = model.constants;
  auto weights = std::make_shared<const model::Weights>(std::exchange(model.weights, {}));
  Reconstructor reconstructor(std::move(model), std::move(engine));
  reconstructor.weights_ = std::move(weights);
  reconstructor.options_ = options;
  return reconstructor;
}

/// The conditioning vector as the network receives it.
struct Reconstructor::ConditionedInput {
  size_t group, first_channel;
  std::vector<float> values;
};

std::optional<Reconstructor::ConditionedInput> Reconstructor::conditioned_input(size_t cycles) const {
  ConditionedInput input{};
  for (; input.group < model_.input.size() && model_.input[input.group].kind != model::InputKind::kCamera;
       ++input.group) {
    input.first_channel += model::num_input_channels(model_.input[input.group].kind, model_.num_patterns);
  }
  if (input.group == model_.input.size()) return std::nullopt;
  input.values = capture::conditioning_vector(*model_.camera, model_.num_patterns, cycles);
  for (float& value : input.values) value *= model_.input[input.group].scale;
  return input;
}

engine::EngineOptions Reconstructor::options_of_prepared() const {
  engine::EngineOptions options = options_;
  if (model_.precision_loss.int16_db) options.checked.push_back(engine::Precision::kInt16);
  return options;
}

/// Returns the same network with these options, and with this engine if its precision is the same.
Result<Reconstructor> Reconstructor::rounded(const engine::EngineOptions& options) const {
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(model_.network, *weights_, options));
  Reconstructor other = *this;
  if (engine.precision() != engine_->precision())
    other.engine_ = std::make_shared<const engine::Engine>(std::move(engine));
  return other;
}

Result<Reconstructor> Reconstructor::prepared_for(size_t cycles) const {
  E2LF_REQUIRE(!constant_cycles_ && beside_cycles_.empty(),
               "prepared_for() of a network that was already prepared for a number of cycles");
  const engine::EngineOptions options = options_of_prepared();
  const auto camera = conditioned_input(cycles);
  if (!camera) return rounded(options);
  auto built = model::with_constant_inputs(model_.network, *weights_, camera->first_channel, camera->values);
  if (!built) return rounded(options);
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(built->network, built->weights, options));
  Reconstructor other(model_, std::move(engine));
  other.model_.network = std::move(built->network);
  other.model_.input[camera->group].scale = 1.0F;
  other.constant_cycles_ = cycles;
  return other;
}

Result<Reconstructor> Reconstructor::prepared_for_fused() const {
  E2LF_REQUIRE(!constant_cycles_ && beside_cycles_.empty(),
               "prepared_for() of a network that was already prepared for a number of cycles");
  const auto camera = conditioned_input(/*cycles=*/1);
  E2LF_REQUIRE(camera, "the network has no input for the number of cycles");
  const engine::EngineOptions options = options_of_prepared();
  // The elements before and after the number of cycles become one channel of ones each.
  const std::span<const float> before = std::span(camera->values).first(capture::kCyclesCondition);
  const std::span<const float> after = std::span(camera->values).subspan(capture::kCyclesCondition + 1);
  auto built = model::with_constant_inputs(model_.network, *weights_, camera->first_channel, before);
  if (built && !after.empty()) {
    built = model::with_constant_inputs(built->network, built->weights, camera->first_channel + 2, after);
  }
  if (!built) return rounded(options);
  E2LF_ASSIGN_OR_RETURN(engine::Engine engine, engine::Engine::create(built->network, built->weights, options));
  Reconstructor other(model_, std::move(engine));
  other.model_.network = std::move(built->network);
  const float one = 1.0F / model_.input[camera->group].scale;
  other.beside_cycles_ = {one, 0.0F};
  if (!after.empty()) other.beside_cycles_.push_back(one);
  return other;
}

Result<void> Reconstructor::fill_input(const capture::MeasurementView& measurement, size_t cycles,
                                       const GridShift& shift, InputPlanes& planes) const {
  E2LF_REQUIRE(!constant_cycles_ || *constant_cycles_ == cycles, "the number of cycles is built into the network");
  InputConditions conditions{model_.camera->constants, {}, cycles, shift};
  if (constant_cycles_) {
    conditions.conditioning = {1.0F};
  } else if (!beside_cycles_.empty()) {
    E2LF_REQUIRE(measurement.is_fused(), "the network was prepared for fused cycles");
    conditions.conditioning = beside_cycles_;
    conditions.cycles_condition = 1;
  } else if (model::is_conditioned_on_camera(model_)) {
    conditions.conditioning = capture::conditioning_vector(*model_.camera, model_.num_patterns, cycles);
  }
  return network_input(measurement, model_.input, conditions, model::size_multiple(model_.network), planes);
}

Reconstructor Reconstructor::with_camera(const capture::SensorProfile& camera) const {
  Reconstructor other = *this;
  other.model_.camera = camera;
  return other;
}

size_t Reconstructor::num_passes(size_t wanted) const {
  if (model_.measurement() == capture::MeasurementKind::kLensArray) return 1;
  const size_t side = model::size_multiple(model_.network);
  return std::clamp<size_t>(wanted, 1, side * side);
}

Result<void> Reconstructor::check(const capture::MeasurementView& measurement) const {
  const capture::MeasurementKind wanted = model_.measurement();
  if (measurement.kind != wanted) {
    return fail(ErrorCode::kInvalidValue, "", "this is the measurement ", capture::measurement_name(measurement.kind),
                ", the model ", model_.name, " takes ", capture::measurement_name(wanted),
                "; use a model that was trained for it");
  }
  const auto [transitions, height, width] = measurement.events.extents;
  if (capture::has_events(wanted) && (transitions + 1 != model_.num_patterns || height * width == 0)) {
    return fail(ErrorCode::kShape, "", "there are ", transitions, " event images of ", width, "x", height,
                " but the model was trained for ", model_.num_patterns - 1,
                "; use the model that belongs to the patterns of the recording");
  }
  const auto [count, image_height, image_width] = measurement.images.extents;
  const size_t num_images = capture::num_images(wanted, model_.num_patterns);
  if (count != num_images || (num_images > 0 && image_height * image_width == 0)) {
    return fail(ErrorCode::kShape, "", "there are ", count, " intensity images of ", image_width, "x", image_height,
                " but the model was trained for ", num_images, "; use the model that belongs to the patterns");
  }
  const bool has_lenses = image_height % capture::kLensPixels == 0 && image_width % capture::kLensPixels == 0;
  if (wanted != capture::MeasurementKind::kLensArray || has_lenses) return {};
  return fail(ErrorCode::kShape, "", "an image of ", image_width, "x", image_height,
              " does not consist of complete lenses; crop it to multiples of ", capture::kLensPixels, " pixels");
}

Result<void> Reconstructor::reconstruct_into(const capture::MeasurementView& measurement, size_t cycles,
                                             std::span<const size_t> views, ReconstructionMemory& memory,
                                             const LightFieldOutput& field, const ProgressFn& progress) const {
  E2LF_RETURN_IF_ERROR(check(measurement));
  const lightfield::Shape shape = field_shape(measurement);
  E2LF_REQUIRE(lightfield::shape_of(field) == shape, "the output has another shape");
  E2LF_RETURN_IF_ERROR(fill_input(measurement, cycles, {}, memory.input));
  if (!std::ranges::equal(memory.views, views)) {
    memory.views.assign(views.begin(), views.end());
    memory.some = views.empty() ? std::nullopt : engine_->with_outputs(memory.views);
  }
  const engine::Engine& engine = memory.some ? *memory.some : *engine_;
  const size_t height = memory.input.height, width = memory.input.width;
  if (height == shape.height && width == shape.width && field.is_row_major()) {
    return engine.run_frame(memory.input.values, height, width, memory.rows, {field.data, field.size()}, progress);
  }
  memory.uncropped.resize(shape.num_views() * height * width);
  E2LF_RETURN_IF_ERROR(engine.run_frame(memory.input.values, height, width, memory.rows, memory.uncropped, progress));
  LightFieldView computed(memory.uncropped.data(), {shape.views_y, shape.views_x, height, width, 1});
  computed.extents = field.extents;
  for (size_t view = 0; view < shape.num_views(); ++view) {
    if (memory.some && !std::ranges::binary_search(views, view)) continue;
    const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
    copy_values(computed[view_y][view_x], field[view_y][view_x]);
  }
  return {};
}

Result<lightfield::LightField> Reconstructor::reconstruct(const capture::MeasurementView& measurement,
                                                          const ProgressFn& progress, size_t passes,
                                                          size_t cycles) const {
  E2LF_RETURN_IF_ERROR(check(measurement));
  const lightfield::Shape shape = field_shape(measurement);
  const auto shifts = grid_shifts(num_passes(passes), model::size_multiple(model_.network));
  lightfield::LightField mean;
  for (size_t pass = 0; pass < shifts.size(); ++pass) {
    InputPlanes input;
    E2LF_RETURN_IF_ERROR(fill_input(measurement, cycles, shifts[pass], input));
    auto field = lightfield::LightField::unset({shape.views_y, shape.views_x, input.height, input.width});
    E2LF_RETURN_IF_ERROR(engine_->run(input.values, input.height, input.width, field.data(),
                                      progress_of_pass(progress, pass, shifts.size())));
    if (shifts.size() == 1 && field.shape() == shape) return field;
    if (pass == 0) mean = lightfield::LightField(shape);  // a single uncropped pass needs no second field
    add_crop(field, shifts[pass], mean);
  }
  for (float& value : mean.data()) value /= static_cast<float>(shifts.size());
  return mean;
}

}  // namespace e2lf::recon
