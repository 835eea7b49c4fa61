// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/model/network.h"

namespace e2lf::engine {

/// The layers that the output is made from. The network must be valid.
[[nodiscard]] model::Network without_unread_layers(const model::Network& network);

}  // namespace e2lf::engine
