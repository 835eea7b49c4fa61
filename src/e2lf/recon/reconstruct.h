// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/engine/engine.h"
#include "e2lf/events/event_images.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"

namespace e2lf::recon {

/// Turns event images into light fields with one model; made once, used for every cycle.
class Reconstructor {
 public:
  /// Prepares the network of `model`. Fails as Engine::create does.
  [[nodiscard]] static Result<Reconstructor> create(model::Model model, const engine::EngineOptions& options = {});

  /// The network's plain output, not clamped and without gain: [8, 8, y, x]. Fails with kShape when the number of
  /// event images is not N - 1.
  [[nodiscard]] Result<lightfield::LightField> reconstruct(const events::EventImages& images,
                                                           const ProgressFn& progress = {}) const;

  [[nodiscard]] const model::Model& model() const { return model_; }
  [[nodiscard]] const engine::Engine& engine() const { return engine_; }

 private:
  Reconstructor(model::Model model, engine::Engine engine) : model_(std::move(model)), engine_(std::move(engine)) {}
  model::Model model_;
  engine::Engine engine_;
};

/// The factor that brings a light field to a well-exposed picture: a robust bright level (the 99.5 % quantile over the
/// views) maps to 0.9. Real scenes can be far darker relative to the sensor's dark level than the model's training
/// data; a light field that is bright already (0.7..1) keeps the gain 1. Always in [0.25, 64].
[[nodiscard]] float auto_gain(const lightfield::LightField& light_field);

}  // namespace e2lf::recon
