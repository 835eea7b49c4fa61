// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/model/model.h"

namespace e2lf::pipeline {

/// What a bundled model is needed for.
struct ModelNeeds {
  capture::Codes codes;          ///< patterns between which the event images lie
  bool gives_disparity = false;  ///< a disparity instead of views
  bool is_conditioned = false;   ///< the network must be conditioned on the sensor profile, as for physical pixels
  bool is_fast = false;          ///< the network must keep pace with a live source
  bool may_be_guided = true;     ///< its views may follow a disparity
};

/// A bundled model and its file.
struct BundledModel {
  std::filesystem::path path;
  model::Model model;
};

/// Chooses among the bundled models by what their files state, and reads the model. Those with these patterns (or for
/// any), this output and this event model are candidates; a network that is conditioned on the camera takes any event
/// model. Those that were trained for these patterns come first. Of several, the choice is the one with the fewest
/// multiply-adds if it must be fast. Otherwise, networks for the paper's event model alone come first, then those whose
/// views follow a disparity, and then those with the most multiply-adds.
/// Returns nothing if no model is suitable. Files that cannot be read are left out with a warning.
[[nodiscard]] Result<std::optional<BundledModel>> choose_bundled_model(const ModelNeeds& needs);

/// Returns the remedy for events that need a network conditioned on the sensor profile, which names the bundled ones
/// for these patterns with this output, or says that none is suitable. Empty patterns are those of any model.
[[nodiscard]] std::string conditioned_network_remedy(const std::optional<capture::Codes>& codes, bool gives_disparity);

}  // namespace e2lf::pipeline
