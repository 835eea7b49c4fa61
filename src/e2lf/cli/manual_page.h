// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/cli/declared_verbs.h"

namespace e2lf::cli {

/// Returns the name of a verb's manual page without its section: "e2lf-codes-show".
[[nodiscard]] std::string manual_name(const DeclaredVerb& verb);

/// Returns the manual page (roff, section 1) of a verb. `verbs` are all verbs, to which the page may refer.
[[nodiscard]] std::string manual_page(const DeclaredVerb& verb, const std::vector<DeclaredVerb>& verbs);

}  // namespace e2lf::cli
