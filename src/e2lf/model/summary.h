// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/model/model.h"

namespace e2lf::model {

/// Summarises a model for `e2lf model info --json`: name, patterns, views, event model, constants, input, figures of
/// the network (layers, parameters, multiply-adds per pixel, receptive field in pixels), light efficiency of its codes
/// (null if it has none) and provenance. The model must pass validate().
[[nodiscard]] Json summary_json(const Model& model);

/// Returns the figures of a network, which the summaries of all kinds of models contain.
[[nodiscard]] Json network_summary(const Network& network);

}  // namespace e2lf::model
