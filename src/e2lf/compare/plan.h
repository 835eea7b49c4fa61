// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/compare/config.h"

namespace e2lf::compare {

/// A method with its patterns.
struct ComparedMethod {
  MethodConfig config;
  std::filesystem::path model;  ///< a file or the folder of the release; empty if there is none
  capture::Codes codes;         ///< codes of a scan of views, with one open cell each
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;
  std::optional<capture::SensorProfile>
      network_camera;  ///< the sensor profile given to the network, if not that of the sensor
  Json identity;       ///< everything on which its results depend
};

struct ComparedScene {
  std::string name;
  std::filesystem::path path;             ///< empty if rendered
  std::optional<uint64_t> rendered_seed;  ///< seed of the demo scene
  GroupConfig group;
  Json identity;
};

struct Sensor {
  SensorConfig config;
  capture::SensorProfile camera;  ///< profile with the changes of the configuration applied
  Json identity;
};

/// Returns true if a method scans the views for a network that makes frames.
[[nodiscard]] inline bool is_scan(const ComparedMethod& method) {
  return method.config.algorithm == "event-video";
}

/// Returns true if a method is a program of the user.
[[nodiscard]] inline bool is_external(const ComparedMethod& method) {
  return method.config.algorithm == "external";
}

/// One result to compute: the numbers of method, scene and sensor in the plan, and a seed.
struct Job {
  size_t method = 0, scene = 0, sensor = 0;
  uint64_t seed = 0;
  Json inputs;      ///< everything on which the result depends, by content
  std::string key;  ///< their SHA-256 in hex
};

struct Plan {
  std::string name;
  std::vector<ComparedMethod> methods;
  std::vector<std::string> left_out;  ///< names of optional methods whose files are missing
  std::vector<ComparedScene> scenes;  ///< group by group
  std::vector<std::string> groups;    ///< names of the groups that exist
  std::vector<Sensor> sensors;
  std::vector<std::string> metrics;
  std::string device = "cpu";
  bool pictures = true;
  std::vector<Job> jobs;                     ///< scene by scene, sensor by sensor
  std::vector<std::filesystem::path> files;  ///< the files that are read
};

/// The services that making a plan needs from the system.
struct Environment {
  /// Returns the path of a file of this name. Fails with kNotFound.
  std::function<Result<std::filesystem::path>(const std::string& name)> locate;
  /// Returns the path of a camera of this name.
  std::function<Result<std::filesystem::path>(const std::string& name)> locate_camera;
  /// Returns a hash of the content of a file or folder.
  std::function<Result<std::string>(const std::filesystem::path& path)> hash;
  std::string version;         ///< version of the program; results of other versions are not reused
  std::string device = "cpu";  ///< what computes networks, see engine::EngineOptions
};

/// Locates and hashes all files and lists the jobs. Optional methods and groups whose files are missing are omitted
/// with a warning. Fails with kNotFound if other files are missing or if nothing remains, and as reading models,
/// cameras and patterns does.
[[nodiscard]] Result<Plan> make_plan(const ComparisonConfig& config, const Environment& environment);

}  // namespace e2lf::compare
