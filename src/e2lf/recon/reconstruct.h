// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/engine/engine.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/gain.h"

namespace e2lf::recon {

/// Turns measurements into light fields with one model; made once, used for every cycle.
class Reconstructor {
 public:
  /// Prepares the network of `model`. Fails as model::validate() and Engine::create() do.
  [[nodiscard]] static Result<Reconstructor> create(model::Model model, const engine::EngineOptions& options = {});

  /// The network's plain output, not clamped and without gain: [view_y, view_x, y, x]. Images whose size the network
  /// does not take are extended as network_input() says and the result is cropped. A network that works at reduced
  /// resolution errs differently where pixels fall differently on its grid: the result is the mean over the first
  /// num_passes(passes) of grid_shifts(), at so many times the cost. From two passes on, or where the result is
  /// cropped, a second light field needs room. The images may be sums over several `cycles` of a
  /// scene that stands still, where model::is_told_the_camera(). Fails with kInvalidValue when the measurement is of
  /// another kind than the model takes, with kShape when the number of images is not that of its patterns or they are
  /// empty, and as Engine::run does.
  [[nodiscard]] Result<lightfield::LightField> reconstruct(const capture::Measurement& measurement,
                                                           const ProgressFn& progress = {}, size_t passes = 1,
                                                           size_t cycles = 1) const;

  /// How many passes are made when `wanted` are: at least one, at most model::size_multiple() squared; one behind a
  /// lens array.
  [[nodiscard]] size_t num_passes(size_t wanted) const;

  [[nodiscard]] const model::Model& model() const { return model_; }
  [[nodiscard]] const engine::Engine& engine() const { return engine_; }

 private:
  struct Planes;
  /// The network's output, not cropped.
  [[nodiscard]] Result<Planes> run(const capture::Measurement& measurement, size_t cycles,
                                   const ProgressFn& progress) const;
  [[nodiscard]] Result<void> check(const capture::Measurement& measurement) const;

  Reconstructor(model::Model model, engine::Engine engine) : model_(std::move(model)), engine_(std::move(engine)) {}
  model::Model model_;
  engine::Engine engine_;
};

}  // namespace e2lf::recon
