// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/engine/engine.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/input.h"

namespace e2lf::recon {

/// Returns the factor that makes a light field well exposed: it maps a robust bright level (the 99.5 % quantile of
/// all views; large light fields are sampled at regular intervals) to 0.9. Real scenes can be far darker relative to
/// the sensor's dark level than the training data of the model. The gain is 1 if the level is already bright (0.7..1)
/// or if there is no light. It is always in [0.25, 64]. Brightness is measured above `black`, which the caller
/// subtracts afterwards.
[[nodiscard]] float auto_gain(const LightFieldView& light_field, float black = 0.0F);

/// Returns the brightness that should become black: the 0.5 % quantile over the views, limited to between 0 and 0.15 of
/// the bright level. It is meant for cameras whose events determine brightness only up to a constant: if the
/// photoreceptor lags, a dark level of the scene cannot be distinguished from a slower receptor
/// (docs/experiments/camera-fit.md).
[[nodiscard]] float auto_black(const LightFieldView& light_field);

/// Subtracts `black` and multiplies by `gain`, in place.
void apply_tone(const LightFieldOutput& light_field, float black, float gain);

/// Returns the first `count` distinct shifts on the grid of a network with `size_multiple`, or all size_multiple^2 of
/// them if `count` is larger. The first one is zero. If the multiple is even, the first four cover all four positions
/// on a 2x2 grid.
[[nodiscard]] std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple);

/// A method that reconstructs a light field from a measurement: a network or the inversion.
using Method = std::function<Result<lightfield::LightField>(const capture::MeasurementView& measurement,
                                                            const ProgressFn& progress)>;

/// Memory that one reconstruction after the other uses again. It belongs to one Reconstructor.
struct ReconstructionMemory {
  InputPlanes input;
  std::vector<float> uncropped;  ///< used if the output is no row-major image of a multiple of the network's size
  engine::FrameState rows;
  std::vector<size_t> views;                ///< views that `some` contains
  std::optional<engine::Engine> some = {};  ///< computes these views alone
};

/// Reconstructs light fields, or the outputs [1, 2, y, x] of a depth network, from measurements with one model. It is
/// made once and used for every cycle, by any number of threads at once. Copies share the engine and its weights.
class Reconstructor {
 public:
  /// Prepares the network of `model`, for which Precision::kAuto is float32, or bfloat16 if this was checked for the
  /// model (model::PrecisionLoss). Fails as model::validate() and Engine::create() do.
  [[nodiscard]] static Result<Reconstructor> create(model::Model model, const engine::EngineOptions& options = {});

  /// Computes the network's unprocessed output [view_y, view_x, y, x], neither clamped nor multiplied by a gain. Images
  /// of a size that the network does not accept are extended as network_input() does, and the result is cropped. The
  /// errors of a network with reduced resolution depend on the position of the pixels on its grid. The result is
  /// therefore the mean over the first num_passes(passes) of grid_shifts(), at a proportional cost. With two or more
  /// passes, or if the result is cropped, memory for a second light field is needed. The images may be sums over
  /// several `cycles` of a static scene; networks that are not conditioned on the sensor profile receive the mean.
  /// Fails with kInvalidValue if the measurement is not of the kind that the model takes, with kShape if the number of
  /// images does not match its patterns or if they are empty, and as Engine::run does.
  [[nodiscard]] Result<lightfield::LightField> reconstruct(const capture::MeasurementView& measurement,
                                                           const ProgressFn& progress = {}, size_t passes = 1,
                                                           size_t cycles = 1) const;

  /// Computes one pass of reconstruct() into `field`, memory of the caller with field_shape(); another shape breaks the
  /// contract. If the network permits it, only the views with the numbers `views`, in ascending order, are computed and
  /// the others are not changed; if `views` is empty, all are computed. Fails as reconstruct() does.
  [[nodiscard]] Result<void> reconstruct_into(const capture::MeasurementView& measurement, size_t cycles,
                                              std::span<const size_t> views, ReconstructionMemory& memory,
                                              const LightFieldOutput& field, const ProgressFn& progress = {}) const;

  /// Returns the shape of the result. The two outputs of a depth network have the place of views.
  [[nodiscard]] lightfield::Shape field_shape(const capture::MeasurementView& measurement) const;

  /// Returns the same network for measurements of exactly `cycles` cycles, with the sensor profile built into its
  /// weights if the network is conditioned on it by convolutions, and in int16 instead of float32 if this was checked
  /// for the model. It is faster, and its results differ by rounding.
  [[nodiscard]] Result<Reconstructor> prepared_for(size_t cycles) const;
  /// Returns the same for fused cycles, whose number differs between pixels. The network must be conditioned on the
  /// sensor profile.
  [[nodiscard]] Result<Reconstructor> prepared_for_fused() const;

  /// Returns the number of passes that are made if `wanted` are requested: at least one and at most
  /// model::size_multiple() squared, or one if there is a lens array.
  [[nodiscard]] size_t num_passes(size_t wanted) const;

  /// Returns the same network, conditioned on another sensor profile.
  [[nodiscard]] Reconstructor with_camera(const capture::SensorProfile& camera) const;

  /// Returns the model without its weights.
  [[nodiscard]] const model::Model& model() const { return model_; }
  [[nodiscard]] const engine::Engine& engine() const { return *engine_; }

 private:
  struct ConditionedInput;
  [[nodiscard]] Result<void> check(const capture::MeasurementView& measurement) const;
  [[nodiscard]] std::optional<ConditionedInput> conditioned_input(size_t cycles) const;
  [[nodiscard]] Result<Reconstructor> rounded(const engine::EngineOptions& options) const;
  [[nodiscard]] engine::EngineOptions options_of_prepared() const;
  [[nodiscard]] Result<void> fill_input(const capture::MeasurementView& measurement, size_t cycles,
                                        const GridShift& shift, InputPlanes& planes) const;

  Reconstructor(model::Model model, engine::Engine engine)
      : model_(std::move(model)), engine_(std::make_shared<const engine::Engine>(std::move(engine))) {}
  model::Model model_;
  std::shared_ptr<const engine::Engine> engine_;
  std::shared_ptr<const model::Weights> weights_;
  engine::EngineOptions options_;
  std::optional<size_t> constant_cycles_;  ///< number of cycles that is built into the weights
  std::vector<float> beside_cycles_;       ///< conditioning vector if all but the number of cycles is built in
};

}  // namespace e2lf::recon
