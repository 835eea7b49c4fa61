// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/recorded_setup.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {
namespace {

constexpr const char *kCameraKey = "e2lf_camera", *kViewsKey = "e2lf_views";

/// Returns the value of the first line with this key, or null.
const std::string* find_line(const HeaderLines& header, const char* key) {
  const auto line = std::find_if(header.begin(), header.end(), [&](const auto& pair) { return pair.first == key; });
  return line == header.end() ? nullptr : &line->second;
}

Result<SensorProfile> camera_from_text(const std::string& text, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(const Json json, parse_json(text, location));
  return camera_from_json(json, location);
}

}  // namespace

NpyArray text_to_npy(const std::string& text) {
  return make_npy<uint8_t>({text.size()}, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

Result<std::string> text_from_npy(const NpyArray& array, const char* what, const std::string& location) {
  if (array.shape.size() == 1 && array.item_size == 1) return std::string(array.bytes.begin(), array.bytes.end());
  return fail(ErrorCode::kShape, location, what, " is not text; write it as an array of bytes, or leave it out");
}

HeaderLines setup_to_header(const RecordedSetup& setup) {
  HeaderLines header;
  if (setup.codes) header = codes_to_header(*setup.codes);
  if (setup.camera) header.emplace_back(kCameraKey, json_line(to_json(*setup.camera)));
  if (setup.has_own_views()) header.emplace_back(kViewsKey, orientation_name(*setup.views));
  return header;
}

Result<RecordedSetup> setup_from_header(const HeaderLines& header, const std::string& location) {
  RecordedSetup setup;
  E2LF_ASSIGN_OR_RETURN(setup.codes, codes_from_header(header, location));
  if (const std::string* const line = find_line(header, kCameraKey)) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, camera_from_text(*line, cat(location, ": ", kCameraKey)));
    setup.views = setup.camera->views;
  }
  if (const std::string* const line = find_line(header, kViewsKey)) {
    E2LF_ASSIGN_OR_RETURN(setup.views, orientation_from_name(*line, cat(location, ": ", kViewsKey)));
  }
  return setup;
}

void setup_to_arrays(const RecordedSetup& setup, NpzArrays& arrays) {
  if (setup.codes) arrays["codes"] = codes_to_npy(*setup.codes);
  if (setup.camera) arrays["camera"] = text_to_npy(json_line(to_json(*setup.camera)));
  if (setup.has_own_views()) arrays["views"] = text_to_npy(orientation_name(*setup.views));
  if (!setup.findings.empty()) arrays["findings"] = text_to_npy(setup.findings);
}

Result<RecordedSetup> setup_from_arrays(const NpzArrays& arrays, const std::string& location) {
  RecordedSetup setup;
  if (const auto codes = arrays.find("codes"); codes != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.codes, codes_from_npy(codes->second, cat(location, ": codes")));
  }
  if (const auto camera = arrays.find("camera"); camera != arrays.end()) {
    const std::string place = cat(location, ": camera");
    E2LF_ASSIGN_OR_RETURN(const std::string text, text_from_npy(camera->second, "the camera", place));
    E2LF_ASSIGN_OR_RETURN(setup.camera, camera_from_text(text, place));
    setup.views = setup.camera->views;
  }
  if (const auto views = arrays.find("views"); views != arrays.end()) {
    const std::string place = cat(location, ": views");
    E2LF_ASSIGN_OR_RETURN(const std::string name, text_from_npy(views->second, "the orientation of the views", place));
    E2LF_ASSIGN_OR_RETURN(setup.views, orientation_from_name(name, place));
  }
  if (const auto findings = arrays.find("findings"); findings != arrays.end()) {
    E2LF_ASSIGN_OR_RETURN(setup.findings,
                          text_from_npy(findings->second, "the list of findings", cat(location, ": findings")));
  }
  return setup;
}

}  // namespace e2lf::capture
