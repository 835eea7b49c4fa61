// SPDX-License-Identifier: MIT
// e2lf view in a build without the viewer
#include "e2lf/cli/verb.h"

namespace e2lf::cli {

int run_view(const std::vector<std::string>& arguments) {
  Verb verb("view", "Look at light fields, events, recordings and models in a browser. This build has no viewer.",
            "./run e2lf view out/demo/recon");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> {
    return Error{ErrorCode::kMissingDependency,
                 "this build has no viewer; install npm and libcpp-httplib-dev, configure and build again",
                 {}};
  });
}

}  // namespace e2lf::cli
