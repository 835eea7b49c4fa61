// SPDX-License-Identifier: MIT
#include "e2lf/geometry/operations.h"

#include <mutex>

namespace e2lf::geometry {

void add_operations() {
  static std::once_flag once;
  std::call_once(once, [] {
    for (const engine::Operation& operation : {plane_sweep(), render_layers(), warp()})
      engine::add_operation(operation);
  });
}

}  // namespace e2lf::geometry
