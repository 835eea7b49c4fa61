// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::model {

/// A model as an ONNX file (opset 17, weights in float32) that takes event images as they are:
///
///   events  float32 [batch, N-1, y, x]          counts of each transition, or their means over several cycles
///   traits  float32 [batch, C]                  where is_told_the_camera(): capture::camera_traits()
///   views   float32 [batch, views, y, x]        the network's plain output; view number = views_x * view_y + view_x
///
/// Images may have any size: the graph extends them to multiples of size_multiple() as recon::network_input() does, and
/// crops the views. Intensities are made with the constants of model.camera, else with model.constants.
/// Its metadata (onnx_metadata()) say the rest. Fails as validate() does, and with kUnsupported where the model takes
/// another measurement than event images, and where the file would be larger than a protobuf message may be (2 GiB).
[[nodiscard]] Result<std::string> onnx_file(const Model& model);

/// Texts by key: name, event_model, event_constants (JSON: eps, tau, sigma_w, sigma_z), num_patterns, view_order
/// ("VV_UU": row by row), views_y, views_x, patterns (JSON, as capture::codes_to_json(), where the model has any), and
/// for networks that are told the camera: camera (JSON), traits (JSON: the numbers to give for one cycle of it).
[[nodiscard]] std::vector<std::pair<std::string, std::string>> onnx_metadata(const Model& model);

}  // namespace e2lf::model
