// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/model/network.h"

namespace e2lf::engine {

/// Returns the network without the layers on which the output does not depend. The network must be valid.
[[nodiscard]] model::Network without_unread_layers(const model::Network& network);

}  // namespace e2lf::engine
