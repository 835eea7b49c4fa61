// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/camera.h"
#include "e2lf/compare/config.h"

namespace e2lf::compare {

/// A method with its patterns.
struct Method {
  MethodConfig config;
  std::filesystem::path model;  ///< a file or the release's folder; empty: none
  capture::Codes codes;         ///< of a scan of views: one open cell in each
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;
  std::optional<capture::Camera> told;  ///< where not the sensor's
  Json identity;                        ///< all that its results depend on
};

struct Scene {
  std::string name;
  std::filesystem::path path;             ///< empty: rendered
  std::optional<uint64_t> rendered_seed;  ///< of the demo scene
  GroupConfig group;
  Json identity;
};

struct Sensor {
  SensorConfig config;
  capture::Camera camera;  ///< with what the configuration changes
  Json identity;
};

/// Whether a method scans the views for a network that makes frames.
[[nodiscard]] inline bool is_scan(const Method& method) {
  return method.config.algorithm == "event-video";
}

/// One result: numbers of method, scene and sensor in the plan, and a seed.
struct Job {
  size_t method = 0, scene = 0, sensor = 0;
  uint64_t seed = 0;
  Json inputs;      ///< all that the result depends on, by content
  std::string key;  ///< SHA-256 of them in hex
};

struct Plan {
  std::string name;
  std::vector<Method> methods;
  std::vector<std::string> left_out;  ///< names of optional methods whose files are not there
  std::vector<Scene> scenes;          ///< group by group
  std::vector<std::string> groups;    ///< names of those that are there
  std::vector<Sensor> sensors;
  std::vector<std::string> metrics;
  bool pictures = true;
  std::vector<Job> jobs;                     ///< scene by scene, sensor by sensor
  std::vector<std::filesystem::path> files;  ///< that are read
};

/// What a plan asks of the system.
struct Surroundings {
  /// Where a file of that name is. Fails with kNotFound.
  std::function<Result<std::filesystem::path>(const std::string& name)> locate;
  /// Where a camera of that name is.
  std::function<Result<std::filesystem::path>(const std::string& name)> locate_camera;
  /// A hash of the content of a file or folder.
  std::function<Result<std::string>(const std::filesystem::path& path)> hash;
  std::string version;  ///< of the program: results of another one are not reused
};

/// Finds and hashes everything and lists the jobs. Optional methods and groups whose files are not there are left out
/// with a warning. Fails with kNotFound where others are, or where nothing is left, and as reading models, cameras and
/// patterns does.
[[nodiscard]] Result<Plan> make_plan(const Config& config, const Surroundings& surroundings);

/// The SHA-256 of a text in hex.
[[nodiscard]] std::string sha256_of_text(const std::string& text);

}  // namespace e2lf::compare
