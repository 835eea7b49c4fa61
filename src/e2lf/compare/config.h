// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::compare {

/// The configuration of a comparison: each method is run on each scene with each sensor and each seed.
struct MethodConfig {
  std::string name;
  std::string algorithm = "network";                ///< one of kAlgorithms
  std::string model = {}, codes = {}, camera = {};  ///< names of files
  std::vector<std::string> command = {};            ///< of an external program, see docs/compare.md
  size_t passes = 1;
  float gain = 1.0F;
  bool fit_gain = false;
  std::string precision = "float32";
  bool optional = false;
};

struct GroupConfig {
  std::string name;
  std::vector<std::string> scenes, stand_in;
  size_t width = 0, height = 0;  ///< px; 0 = everything
  size_t step = 1;
  bool reverse_rows = false;
  bool optional = false;
};

struct SensorConfig {
  std::string name;
  std::string camera = "paper";
  std::optional<float> tau = {}, sigma_w = {}, sigma_z = {}, sigma_i = {};
  float gain = 1.0F, residue = 0.0F;
  size_t cycles = 1;
  bool fit_gain = false;
};

struct ComparisonConfig {
  std::string name;
  std::vector<MethodConfig> methods;
  std::vector<GroupConfig> scenes;
  std::vector<SensorConfig> sensors = {SensorConfig{.name = "paper"}};
  std::vector<uint64_t> seeds = {1};
  std::vector<std::string> metrics = {"psnr_db",        "ssim",           "bad_20_percent", "events_per_pixel",
                                      "bits_per_pixel", "measurement_ms", "reconstruct_s"};
  bool pictures = true;
};

inline constexpr const char* kAlgorithms[] = {"network", "inversion", "event-video", "external"};

/// Reads a configuration. Fails with kFormat and kInvalidValue (unknown keys, for which the nearest known
/// one is suggested, values out of range, duplicate names, or nothing to compare). The location is the place in the
/// file.
[[nodiscard]] Result<ComparisonConfig> config_from_json(const Json& json, const std::string& location);

/// Returns all keys with their values, which config_from_json() reads. docs/compare.md describes them.
[[nodiscard]] Json to_json(const ComparisonConfig& config);

}  // namespace e2lf::compare
