// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/compare/store.h"
#include "e2lf/compare/tables.h"

namespace e2lf::compare {

/// Makes the page of a comparison as a single file: tables, bars for each scene, the PSNR of the views, patterns with
/// their events, and pictures. `command` is shown as the command that made it.
[[nodiscard]] std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                                      const std::string& command);

}  // namespace e2lf::compare
