// SPDX-License-Identifier: MIT
#include "e2lf/capture/camera_record.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/json_text.h"

namespace e2lf::capture {
namespace {

constexpr const char* kKey = "e2lf_camera";

Result<Camera> camera_from_text(const std::string& text, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(const Json json, parse_json(text, location));
  return camera_from_json(json, location);
}

}  // namespace

HeaderLines camera_to_header(const Camera& camera) {
  return {{kKey, json_line(to_json(camera))}};
}

Result<std::optional<Camera>> camera_from_header(const HeaderLines& header, const std::string& location) {
  const auto line = std::find_if(header.begin(), header.end(), [](const auto& pair) { return pair.first == kKey; });
  if (line == header.end()) return std::optional<Camera>();
  E2LF_ASSIGN_OR_RETURN(Camera camera, camera_from_text(line->second, cat(location, ": ", kKey)));
  return std::optional(std::move(camera));
}

NpyArray camera_to_npy(const Camera& camera) {
  const std::string text = json_line(to_json(camera));
  return make_npy<uint8_t>({text.size()}, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

Result<Camera> camera_from_npy(const NpyArray& array, const std::string& location) {
  if (array.shape.size() != 1 || array.item_size != 1) {
    return Error{ErrorCode::kShape, "the camera is no text; write it as an array of bytes, or leave it out", location};
  }
  return camera_from_text(std::string(array.bytes.begin(), array.bytes.end()), location);
}

}  // namespace e2lf::capture
