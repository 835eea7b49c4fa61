// SPDX-License-Identifier: MIT
#include "e2lf/geometry/operations.h"

namespace e2lf::geometry {

void add_operations() {
  static const bool is_done = [] {
    for (const engine::Operation& operation : {plane_sweep(), render_layers()}) engine::add_operation(operation);
    return true;
  }();
  (void)is_done;
}

}  // namespace e2lf::geometry
