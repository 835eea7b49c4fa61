// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/camera_flags.h"

#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_types.h"

namespace e2lf::cli {

void add_camera_options(CLI::App& app, CameraFlags& flags) {
  constexpr char kGroup[] = "Live cameras";
  const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* text) {
    app.add_option(name, values, text)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false)
        ->group(kGroup);
  };
  repeatable("--trigger-channel", flags.trigger_channels,
             "trigger input to enable: main, aux, the number of its triggers, or none (repeatable); default: all");
  app.add_option("--biases", flags.biases, "file of sensor biases (.bias); default: those of the camera")
      ->group(kGroup);
  app.add_option("--max-event-rate", flags.max_events_per_s,
                 "events/s above which the sensor drops events, 0 = no limit; default: as set in the camera")
      ->group(kGroup);
  repeatable("--roi", flags.regions,
             "rectangle of the sensor whose pixels send events: X,Y,WIDTH,HEIGHT in px (repeatable)");
  app.add_option("--encoding", flags.encoding, "encoding of the camera's events; default: as set in the camera")
      ->check(CLI::IsMember({"evt2", "evt2.1", "evt3"}))
      ->group(kGroup);
}

Result<recordings::CameraSetup> camera_setup(const CameraFlags& flags) {
  recordings::CameraSetup setup{.trigger_channels = flags.trigger_channels,
                                .biases = flags.biases,
                                .max_events_per_s = flags.max_events_per_s,
                                .regions = {},
                                .encoding = flags.encoding};
  for (const std::string& text : flags.regions) {
    recordings::SensorRegion region;
    int length = 0;
    const int found =
        std::sscanf(text.c_str(), "%5d,%5d,%5d,%5d%n", &region.x, &region.y, &region.width, &region.height, &length);
    if (found != 4 || static_cast<size_t>(length) != text.size()) {
      return Error{ErrorCode::kInvalidValue, cat("\"", text, "\" is not a region; give X,Y,WIDTH,HEIGHT"), "--roi"};
    }
    setup.regions.push_back(region);
  }
  return setup;
}

}  // namespace e2lf::cli
