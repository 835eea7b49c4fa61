// SPDX-License-Identifier: MIT
#include "e2lf/streams/camera_stream.h"

namespace e2lf::streams {

StreamOptions camera_stream(const capture::SensorProfile& camera, uint64_t seed) {
  StreamOptions options;
  options.model = camera.is_pixel()                   ? StreamModel::kPixel
                  : camera.event_model == "quantised" ? StreamModel::kQuantised
                                                      : StreamModel::kReferenceAware;
  options.constants = camera.constants;
  options.pixel = camera.pixel;
  options.seed = options.map_seed = seed;
  return options;
}

}  // namespace e2lf::streams
