// SPDX-License-Identifier: MIT
// The target of camera files: the input is one.
#include <cmath>

#include "e2lf/capture/profile/sensor_profile.h"
#include "require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf;
  using fuzz::require;
  const auto json = parse_json(std::string(reinterpret_cast<const char*>(data), size), "input");
  if (!json) return 0;
  const auto camera = capture::camera_from_json(*json, "input");
  if (!camera) return 0;
  for (const float trait : conditioning_vector(*camera, 4))
    require(std::isfinite(trait), "the conditioning vector is finite");
  const auto back = capture::camera_from_json(to_json(*camera), "encoded");
  require(back.ok() && back->pixel == camera->pixel && back->event_model == camera->event_model,
          "a camera comes back as written");
  return 0;
}
