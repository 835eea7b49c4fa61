// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/recorded_setup.h"

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/capture/profile/profile_record.h"

namespace e2lf::capture {

void setup_to_arrays(const RecordedSetup& setup, NpzArrays& arrays) {
  if (setup.codes) arrays["codes"] = codes_to_npy(*setup.codes);
  if (setup.camera) arrays["camera"] = camera_to_npy(*setup.camera);
  if (setup.has_own_views()) arrays["views"] = views_to_npy(*setup.views);
  if (!setup.findings.empty()) arrays["findings"] = text_to_npy(setup.findings);
}

Result<RecordedSetup> setup_from_arrays(const NpzArrays& arrays, const std::string& location) {
  RecordedSetup setup;
  if (const auto codes = arrays.find("codes"); codes != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.codes, codes_from_npy(codes->second, cat(location, ": codes")));
  }
  if (const auto camera = arrays.find("camera"); camera != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, camera_from_npy(camera->second, cat(location, ": camera")));
    setup.views = setup.camera->views;
  }
  if (const auto views = arrays.find("views"); views != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.views, views_from_npy(views->second, cat(location, ": views")));
  }
  if (const auto findings = arrays.find("findings"); findings != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.findings,
                          text_from_npy(findings->second, "the list of findings", cat(location, ": findings")));
  }
  return setup;
}

}  // namespace e2lf::capture
