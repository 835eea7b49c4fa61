// SPDX-License-Identifier: MIT
#include "e2lf/compare/plan.h"

#include <algorithm>
#include <fnmatch.h>
#include <map>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/sha256.h"
#include "e2lf/model/model.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/video/video_model.h"

namespace e2lf::compare {
namespace fs = std::filesystem;
namespace {

/// Must be increased when the arithmetic behind a result changes within a version.
constexpr int kComputation = 3;

/// Reads patterns from a model file, from a file of codes, or from the folder of the release.
Result<capture::Codes> read_any_codes(const fs::path& path) {
  if (!is_folder(path)) return pipeline::read_patterns(path);
  E2LF_ASSIGN_OR_RETURN(model::Model model, pipeline::read_network(path));
  if (model.codes) return std::move(*model.codes);
  return fail(ErrorCode::kNotFound, path, "the model contains no patterns; give those of its camera as \"codes\"");
}

/// Returns 64 patterns of an 8x8 aperture, each with one cell open.
capture::Codes one_hot_codes() {
  capture::Codes codes(64, 8, 8);
  for (size_t n = 0; n < codes.num_patterns; ++n) codes.pattern(n)[n] = 1.0F;
  return codes;
}

/// Returns the properties of a sensor on which a scan of views depends. Its pixels are those of v2e with the tau of the
/// sensor, regardless of the event model. Physical pixels and several cycles are rejected.
Json scan_identity(const Sensor& sensor) {
  return {{"is_pixel", sensor.camera.is_pixel()},
          {"tau", json_number(sensor.camera.constants.tau)},
          {"gain", json_number(sensor.config.gain)},
          {"cycles", sensor.config.cycles}};
}

class Planner {
 public:
  Planner(const ComparisonConfig& config, const Environment& environment)
      : config_(config), environment_(environment) {}

  Result<Plan> make() {
    plan_.name = config_.name.empty() ? "comparison" : config_.name;
    plan_.metrics = config_.metrics;
    plan_.pictures = config_.pictures;
    plan_.device = environment_.device;
    for (const MethodConfig& method : config_.methods) {
      if (const auto added = add_method(method); !added && !is_left_out(method, added.error())) return added.error();
    }
    for (const GroupConfig& group : config_.scenes) E2LF_RETURN_IF_ERROR(add_group(group));
    for (const SensorConfig& sensor : config_.sensors) E2LF_RETURN_IF_ERROR(add_sensor(sensor));
    if (plan_.methods.empty() || plan_.scenes.empty()) {
      return fail(
          ErrorCode::kNotFound, "",
          "nothing is left to compare, because no method or no scene exists; give existing files, or the folder "
          "of the data that contains them");
    }
    add_jobs();
    return std::move(plan_);
  }

 private:
  bool is_left_out(const MethodConfig& method, const Error& error) {
    if (!method.optional || error.code != ErrorCode::kNotFound) return false;
    plan_.left_out.push_back(method.name);
    log_warning(cat("the method ", method.name, " is left out: ", error.text()));
    return true;
  }

  Result<fs::path> locate(const std::string& name) {
    E2LF_ASSIGN_OR_RETURN(const fs::path path, environment_.locate(name));
    plan_.files.push_back(path);
    return path;
  }

  /// Hashes each file only once.
  Result<std::string> hash_of(const fs::path& path) {
    std::string& hash = hashes_[path];
    if (hash.empty()) {
      E2LF_ASSIGN_OR_RETURN(hash, environment_.hash(path));
    }
    return hash;
  }

  /// Returns the hash of a model; of a composed one, with those of its parts.
  Result<Json> hash_of_model(const fs::path& path, const std::vector<fs::path>& parts) {
    E2LF_ASSIGN_OR_RETURN(const std::string own, hash_of(path));
    if (parts.empty()) return Json(own);
    Json hashes = Json::array({own});
    for (const fs::path& part : parts) {
      plan_.files.push_back(part);
      E2LF_ASSIGN_OR_RETURN(const std::string hash, hash_of(part));
      hashes.push_back(hash);
    }
    return hashes;
  }

  Result<capture::SensorProfile> read_camera(const std::string& name) {
    E2LF_ASSIGN_OR_RETURN(const fs::path path, environment_.locate_camera(name));
    plan_.files.push_back(path);
    return capture::read_camera(path);
  }

  /// Replaces the words of a command that name files by the paths of these, and returns the words with the hashes of
  /// the files, on which the results depend.
  Result<Json> locate_command(std::vector<std::string>& command) {
    Json identity = Json::array();
    for (std::string& word : command) {
      const fs::path path = environment_.locate(word).value_or(word);
      if (!is_file(path)) {
        identity.push_back(word);
        continue;
      }
      plan_.files.push_back(path);
      word = path.string();
      E2LF_ASSIGN_OR_RETURN(const std::string hash, hash_of(path));
      identity.push_back(hash);
    }
    return identity;
  }

  Result<void> add_method(const MethodConfig& config) {
    ComparedMethod method;
    method.config = config;
    std::optional<capture::Codes> codes;
    Json model_hash;
    bool is_conditioned = false;
    if (is_scan(method)) {
      E2LF_ASSIGN_OR_RETURN(method.model, locate(config.model));
      E2LF_RETURN_IF_ERROR(video::read_video_model(method.model));
      E2LF_ASSIGN_OR_RETURN(model_hash, hash_of(method.model));
      codes = one_hot_codes();
    } else if (!config.model.empty()) {
      E2LF_ASSIGN_OR_RETURN(method.model, locate(config.model));
      E2LF_ASSIGN_OR_RETURN(model::Model model, pipeline::read_network(method.model));
      E2LF_ASSIGN_OR_RETURN(model_hash, hash_of_model(method.model, model.parts));
      codes = std::move(model.codes);
      is_conditioned = model::is_conditioned_on_camera(model);
      method.measurement = model.measurement();
    }
    if (!config.codes.empty()) {
      E2LF_ASSIGN_OR_RETURN(const fs::path path, locate(config.codes));
      E2LF_ASSIGN_OR_RETURN(codes, read_any_codes(path));
    }
    if (!codes && !method.model.empty()) {
      return fail(ErrorCode::kInvalidValue, method.model, "the model of ", config.name,
                  " contains no patterns; give those of its camera as \"codes\"");
    }
    method.codes = codes ? std::move(*codes) : capture::default_codes();
    if (!config.camera.empty()) {
      if (!is_conditioned) {
        return fail(ErrorCode::kInvalidValue, "", "the network of ", config.name,
                    " is not conditioned on a camera; remove \"camera\"");
      }
      E2LF_ASSIGN_OR_RETURN(method.network_camera, read_camera(config.camera));
    }
    method.identity = {{"algorithm", config.algorithm},
                       {"model", model_hash},
                       {"codes", sha256_of_text(json_line(capture::codes_to_json(method.codes)))},
                       {"told", method.network_camera ? capture::to_json(*method.network_camera) : Json()},
                       {"passes", config.passes},
                       {"gain", config.fit_gain ? Json("fitted") : json_number(config.gain)},
                       {"precision", config.precision}};
    if (is_external(method)) {
      E2LF_ASSIGN_OR_RETURN(method.identity["command"], locate_command(method.config.command));
    }
    if (environment_.device != "cpu" && config.algorithm == "network") method.identity["device"] = environment_.device;
    plan_.methods.push_back(std::move(method));
    return {};
  }

  /// Returns the scenes that a name denotes: a single one, or those that match a pattern. Fails with kNotFound if there
  /// are none.
  Result<std::vector<ComparedScene>> find_scenes(const std::string& name, const GroupConfig& group) {
    std::vector<ComparedScene> scenes;
    if (name == "demo" || name.starts_with("demo:")) {
      const auto seed = parse_number<uint64_t>(name == "demo" ? "1" : name.substr(5));
      if (!seed) return fail(ErrorCode::kInvalidValue, group.name, "\"", name, "\" has no number; write e.g. demo:2");
      scenes.push_back({name, {}, seed, group, {}});
      return scenes;
    }
    const fs::path path = name;
    const std::string last = path.filename().string();
    if (last.find('*') == std::string::npos) {
      E2LF_ASSIGN_OR_RETURN(const fs::path found, locate(name));
      const std::string stem = is_folder(found) ? found.filename().string() : found.stem().string();
      scenes.push_back({stem, found, {}, group, {}});
      return scenes;
    }
    E2LF_ASSIGN_OR_RETURN(const fs::path folder, environment_.locate(path.parent_path().string()));
    std::vector<fs::path> found;
    for (const fs::path& each : paths_in(folder)) {
      const std::string file = each.filename().string();
      if (!file.starts_with('.') && ::fnmatch(last.c_str(), file.c_str(), 0) == 0) found.push_back(each);
    }
    if (found.empty()) return fail(ErrorCode::kNotFound, name, "no scene matches this name; correct it");
    for (const fs::path& each : found) {
      plan_.files.push_back(each);
      scenes.push_back({is_folder(each) ? each.filename().string() : each.stem().string(), each, {}, group, {}});
    }
    return scenes;
  }

  /// Returns the scenes of the list that exist.
  Result<std::vector<ComparedScene>> find_all(const std::vector<std::string>& names, const GroupConfig& group,
                                              std::optional<Error>& missing) {
    std::vector<ComparedScene> scenes;
    for (const std::string& name : names) {
      auto found = find_scenes(name, group);
      if (!found && found.error().code != ErrorCode::kNotFound) return found.error();
      if (!found && !missing) missing = found.error();
      if (!found) continue;
      std::move(found->begin(), found->end(), std::back_inserter(scenes));
    }
    return scenes;
  }

  Result<void> add_group(const GroupConfig& group) {
    std::optional<Error> missing;
    E2LF_ASSIGN_OR_RETURN(std::vector<ComparedScene> scenes, find_all(group.scenes, group, missing));
    if (missing && !scenes.empty()) return *missing;
    if (missing) {
      std::optional<Error> none_stands_in;
      E2LF_ASSIGN_OR_RETURN(scenes, find_all(group.stand_in, group, none_stands_in));
      if (scenes.empty() && !group.optional) return *missing;
      log_warning(scenes.empty() ? cat("the group ", group.name, " is left out: ", missing->text())
                                 : cat("no scene of the group ", group.name, " was found; ", scenes.size(),
                                       scenes.size() == 1 ? " substitute is" : " substitutes are", " used instead"));
    }
    if (!scenes.empty()) plan_.groups.push_back(group.name);
    for (ComparedScene& scene : scenes) {
      Json content = scene.rendered_seed ? Json(cat("demo:", *scene.rendered_seed)) : Json();
      if (!scene.rendered_seed) {
        E2LF_ASSIGN_OR_RETURN(content, hash_of(scene.path));
      }
      scene.identity = {{"content", content},
                        {"width", group.width},
                        {"height", group.height},
                        {"step", group.step},
                        {"reverse_rows", group.reverse_rows}};
      plan_.scenes.push_back(std::move(scene));
    }
    return {};
  }

  Result<void> add_sensor(const SensorConfig& config) {
    Sensor sensor;
    sensor.config = config;
    E2LF_ASSIGN_OR_RETURN(sensor.camera, read_camera(config.camera));
    const bool has_constants = config.tau || config.sigma_w || config.sigma_z || config.residue != 0.0F;
    if (sensor.camera.is_pixel() && has_constants) {
      return fail(
          ErrorCode::kInvalidValue, config.camera,
          "tau, sigma_w, sigma_z and residue are parameters of the paper's event model; remove them from the sensor ",
          config.name, ", or write a camera file");
    }
    capture::SensorConstants& constants = sensor.camera.constants;
    constants.tau = config.tau.value_or(constants.tau);
    constants.sigma_w = config.sigma_w.value_or(constants.sigma_w);
    constants.sigma_z = config.sigma_z.value_or(constants.sigma_z);
    constants.sigma_i = config.sigma_i.value_or(constants.sigma_i);
    // The name of a camera does not affect results.
    capture::SensorProfile nameless = sensor.camera;
    nameless.name = "camera";
    sensor.identity = {{"camera", capture::to_json(nameless)},
                       {"gain", json_number(config.gain)},
                       {"residue", json_number(config.residue)},
                       {"sigma_i", json_number(constants.sigma_i)},
                       {"cycles", config.cycles},
                       {"fit_gain", config.fit_gain}};
    plan_.sensors.push_back(std::move(sensor));
    return {};
  }

  void add_jobs() {
    for (size_t scene = 0; scene < plan_.scenes.size(); ++scene) {
      for (size_t sensor = 0; sensor < plan_.sensors.size(); ++sensor) {
        for (size_t method = 0; method < plan_.methods.size(); ++method) {
          for (const uint64_t seed : config_.seeds) {
            Job job{method, scene, sensor, seed, {}, {}};
            job.inputs = {{"computation", kComputation},
                          {"version", environment_.version},
                          {"method", plan_.methods[method].identity},
                          {"scene", plan_.scenes[scene].identity},
                          {"sensor", is_scan(plan_.methods[method]) ? scan_identity(plan_.sensors[sensor])
                                                                    : plan_.sensors[sensor].identity},
                          {"seed", seed}};
            job.key = sha256_of_text(json_line(job.inputs));
            plan_.jobs.push_back(std::move(job));
          }
        }
      }
    }
  }

  const ComparisonConfig& config_;
  const Environment& environment_;
  std::map<fs::path, std::string> hashes_;
  Plan plan_;
};

}  // namespace

Result<Plan> make_plan(const ComparisonConfig& config, const Environment& environment) {
  return Planner(config, environment).make();
}

}  // namespace e2lf::compare
