// SPDX-License-Identifier: MIT
// e2lf view, reconstruct --view and the pages of the demo and of e2lf live in a build without the viewer
#include "e2lf/cli/output/viewer.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cli/verbs/live_page.h"

namespace e2lf::cli {
namespace {

Error no_viewer() {
  return {ErrorCode::kMissingDependency,
          "this build has no viewer; install npm and libcpp-httplib-dev, configure and build again",
          {}};
}

}  // namespace

bool has_viewer() {
  return false;
}

Result<void> write_comparison_page(const std::filesystem::path& /*path*/, const Shown& /*truth*/,
                                   const Shown& /*reconstruction*/,
                                   const std::optional<depth::DisparityError>& /*error*/) {
  return no_viewer();
}

Result<std::unique_ptr<LiveView>> start_live_view(const std::string& /*name*/, const std::filesystem::path& /*folder*/,
                                                  uint16_t /*port*/) {
  return no_viewer();
}

Result<std::unique_ptr<LivePage>> start_live_page(live::Session& /*session*/, FineMethod /*fine*/,
                                                  std::shared_ptr<recordings::RunningCamera> /*camera*/,
                                                  uint16_t /*port*/) {
  return no_viewer();
}

int run_view(const std::vector<std::string>& arguments) {
  Verb verb("view", "Show light fields, events, recordings and models in a browser. This build has no viewer.",
            "./run e2lf view out/demo/recon");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> { return no_viewer(); });
}

}  // namespace e2lf::cli
