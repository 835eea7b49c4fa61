// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/program/inputs.h"
#include "e2lf/streams/virtual_rig.h"

namespace e2lf::cli {

/// The flags of an event-by-event simulation.
struct StreamFlags {
  bool stream = false;
  std::filesystem::path schedule;
  std::string v2e_preset = "default";
  int64_t rise_us = 0, field_us = 0;
  double turntable_rpm = 0;
  size_t width = 320, height = 240;  ///< size of the turntable's views, px
  double refractory_us = 0, leak_rate_hz = 0, shot_rate_hz = 0, hot_share = 0, readout_limit = 0;

  [[nodiscard]] bool has_turntable() const { return turntable_rpm != 0; }
};

void add_stream_options(CLI::App& app, StreamFlags& flags);

/// Returns whether any of these flags requires an event-by-event simulation.
[[nodiscard]] bool need_stream(const StreamFlags& flags);

/// Returns the options of the event model with this name and these constants, or of a camera with physical pixels.
/// Fails with kInvalidValue (unknown names, or flags that the model does not use).
[[nodiscard]] Result<streams::StreamOptions> stream_options(const StreamFlags& flags, const std::string& event_model,
                                                            const capture::SensorConstants& constants,
                                                            const std::optional<capture::SensorProfile>& camera,
                                                            uint64_t seed);

/// The scene in front of the camera, and the size of its views.
struct StreamScene {
  streams::MovingScene scene;
  size_t height = 0, width = 0;
};

/// Opens the scene: the turntable, a folder of consecutive light fields (--field-us), or one light field. Fails with
/// kInvalidValue, kNotFound, and as load_scene() does.
[[nodiscard]] Result<StreamScene> open_stream_scene(const std::filesystem::path& input, const StreamFlags& flags,
                                                    const SceneOptions& options, uint64_t seed, bool is_quiet);

}  // namespace e2lf::cli
