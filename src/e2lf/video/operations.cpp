// SPDX-License-Identifier: MIT
#include "e2lf/video/operations.h"

namespace e2lf::video {

void add_operations() {
  static const bool is_done = [] {
    for (const engine::Operation& operation :
         {attention(), bilinear_upsampling(), conv_gru(), conv_lstm(), dynamic_filter(), hyperbolic_tangent(),
          layer_norm(), position_code(), previous_output()}) {
      engine::add_operation(operation);
    }
    return true;
  }();
  (void)is_done;
}

}  // namespace e2lf::video
