// SPDX-License-Identifier: MIT
#include "e2lf/video/operations.h"

#include <mutex>

namespace e2lf::video {

void add_operations() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const engine::Operation& operation :
         {attention(), bilinear_upsampling(), conv_gru(), conv_lstm(), dynamic_filter(), hyperbolic_tangent(),
          layer_norm(), position_code(), previous_output()}) {
      engine::add_operation(operation);
    }
  });
}

}  // namespace e2lf::video
