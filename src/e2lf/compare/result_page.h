// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/compare/store.h"
#include "e2lf/compare/tables.h"

namespace e2lf::compare {

/// The page of a comparison, one file: tables, bars for each scene, PSNR of the views, patterns with their events, and
/// pictures. `command` is said to make it.
[[nodiscard]] std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                                      const std::string& command);

}  // namespace e2lf::compare
