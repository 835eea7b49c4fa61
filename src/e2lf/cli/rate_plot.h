// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/events/event_rate.h"

namespace e2lf::cli {

/// The event rate over time as an SVG picture: ON above the axis, OFF below, with axes in ms and M events/s.
[[nodiscard]] std::string rate_plot_svg(const events::EventRate& rate);

}  // namespace e2lf::cli
