// SPDX-License-Identifier: MIT
// e2lf codes play in a build without SDL
#include "e2lf/cli/verbs.h"

namespace e2lf::cli {

int run_codes_play(const std::vector<std::string>& arguments) {
  Verb verb("codes play", "Show the patterns on a display of this computer. This build lacks SDL.",
            "e2lf codes render -m e2lf-n4 -o out/display");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> {
    return Error{ErrorCode::kMissingDependency,
                 "this build cannot show patterns; install libsdl2-dev, then configure and build again",
                 {}};
  });
}

}  // namespace e2lf::cli
