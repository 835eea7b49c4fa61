// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/flags/scene_input.h"
#include "e2lf/streams/virtual_rig.h"

namespace e2lf::cli {

/// The flags of a simulation event by event.
struct StreamFlags {
  bool stream = false;
  std::filesystem::path schedule;
  std::string v2e_preset = "default";
  int64_t rise_us = 0, field_us = 0;
  double turntable_rpm = 0;
  size_t width = 320, height = 240;  ///< of the turntable's views
  double refractory_us = 0, leak_rate_hz = 0, shot_rate_hz = 0, hot_share = 0, readout_limit = 0;

  [[nodiscard]] bool has_turntable() const { return turntable_rpm != 0; }
};

/// The help group of these options.
inline constexpr const char* kStreamOptions = "Event by event";

void add_stream_options(CLI::App& app, StreamFlags& flags);

/// Whether these flags have a use in a simulation event by event alone.
[[nodiscard]] bool need_stream(const StreamFlags& flags);

/// The model of that name with these constants, or those of a camera with physical pixels. Fails with kInvalidValue
/// (unknown names, flags that the model has no use for).
[[nodiscard]] Result<streams::StreamOptions> stream_options(const StreamFlags& flags, const std::string& event_model,
                                                            const capture::SensorConstants& constants,
                                                            const std::optional<capture::SensorProfile>& camera,
                                                            uint64_t seed);

/// What stands or moves before the camera, and its size.
struct StreamScene {
  streams::MovingScene scene;
  size_t height = 0, width = 0;
};

/// The turntable, a folder of light fields that follow on each other (--field-us), or one light field. Fails as
/// load_scene(), with kInvalidValue and kNotFound.
[[nodiscard]] Result<StreamScene> open_stream_scene(const std::filesystem::path& input, const StreamFlags& flags,
                                                    const SceneOptions& options, uint64_t seed, bool is_quiet);

}  // namespace e2lf::cli
