// SPDX-License-Identifier: MIT
// The verbs and pages of a build without the viewer (E2LF_NO_VIEWER) or without SDL (E2LF_NO_DISPLAY)
#include "e2lf/base/text.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/live/page/live_page.h"

namespace e2lf::cli {

Error no_viewer_error() {
  return fail(ErrorCode::kMissingDependency, "",
              "this build has no viewer; install npm and libcpp-httplib-dev, configure and build again");
}

#ifdef E2LF_NO_VIEWER
Result<void> write_comparison_page(const std::filesystem::path& /*path*/, const ComparedLightField& /*truth*/,
                                   const ComparedLightField& /*reconstruction*/,
                                   const std::optional<depth::DisparityError>& /*error*/) {
  return no_viewer_error();
}

int run_view(const std::vector<std::string>& arguments) {
  Verb verb("view", "Show light fields, events, recordings and models in a browser. This build has no viewer.",
            "./run e2lf view out/demo/recon");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> { return no_viewer_error(); });
}
#endif

#ifdef E2LF_NO_DISPLAY
int run_codes_play(const std::vector<std::string>& arguments) {
  Verb verb("codes play", "Show the patterns on a display of this computer. This build lacks SDL.",
            "e2lf codes render -m e2lf-n4 -o out/display");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> {
    return fail(ErrorCode::kMissingDependency, "",
                "this build cannot show patterns; install libsdl2-dev, then configure and build again");
  });
}
#endif

}  // namespace e2lf::cli

#ifdef E2LF_NO_VIEWER
namespace e2lf::live {

Result<LivePage> start_live_page(Session& /*session*/, FineMethod /*fine*/,
                                 std::shared_ptr<recordings::RunningCamera> /*camera*/, uint16_t /*port*/) {
  return cli::no_viewer_error();
}

}  // namespace e2lf::live
#endif
