// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/model/model.h"

namespace e2lf::model {

/// Summarises a model for `e2lf model info --json`: name, patterns, views, event model, constants, input, figures of
/// the network (layers, parameters, multiply-adds per pixel, receptive field in pixels), light efficiency of its codes
/// (null if it has none) and provenance. The model must pass validate().
[[nodiscard]] Json summary_json(const Model& model);

/// Summarises a model as text, with a picture of the patterns.
[[nodiscard]] std::string summary_text(const Model& model);

/// Parts of a summary, which that of another kind of model shares: figures of a network as JSON, and lines "label
/// value" of text.
[[nodiscard]] Json network_summary(const Network& network);
void append_field(std::string& text, std::string label, const std::string& value);
void append_network(std::string& text, const Network& network);
void append_origin(std::string& text, const Json& provenance);

}  // namespace e2lf::model
