// SPDX-License-Identifier: MIT
#include "e2lf/model/depth_network.h"

namespace e2lf::model {

bool is_depth_network(const Model& model) {
  const auto shapes = infer_shapes(model.network);
  return shapes && shapes->back().channels == kDepthOutputs && model.views_y * model.views_x != kDepthOutputs;
}

}  // namespace e2lf::model
