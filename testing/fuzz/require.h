// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <cstdlib>

namespace e2lf::fuzz {

/// Ends the process, as a finding, when an invariant does not hold.
inline void require(bool holds, const char* invariant, const char* where = "") {
  if (holds) return;
  std::fprintf(stderr, "invariant broken: %s %s\n", invariant, where);
  std::abort();
}

}  // namespace e2lf::fuzz
