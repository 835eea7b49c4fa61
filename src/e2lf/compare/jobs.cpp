// SPDX-License-Identifier: MIT
#include "e2lf/compare/jobs.h"

#include <algorithm>
#include <set>

#include "e2lf/compare/measure.h"
#include "e2lf/compare/tables.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/sha256.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::compare {

std::vector<size_t> open_jobs(const Plan& plan, const ResultStore& store, const Shard& shard, bool again) {
  std::vector<size_t> open;
  std::set<std::string> keys;
  for (size_t i = 0; i < plan.jobs.size(); ++i) {
    if (i % shard.count != shard.number - 1 || (!again && store.find(plan.jobs[i]))) continue;
    if (keys.insert(plan.jobs[i].key).second) open.push_back(i);
  }
  return open;
}

Result<size_t> run_jobs(const Plan& plan, const std::vector<size_t>& jobs, const ResultStore& store,
                        const ProgressFn& progress) {
  constexpr size_t kParts = 1000;
  constexpr lightfield::PngDepth kDepth = lightfield::PngDepth::k8;
  JobRunner runner(plan);
  lightfield::LightField truth;
  lightfield::Image disparity;
  std::optional<size_t> loaded;  // the scene in `truth`
  size_t done = 0;
  const auto report = [&](size_t part, size_t total) {
    if (progress && total > 0) progress(done * kParts + std::min(part, total) * kParts / total, jobs.size() * kParts);
  };
  const auto compute = [&](const Job& job) -> Result<void> {
    report(0, 1);
    if (loaded != job.scene) {
      const ComparedScene& scene = plan.scenes[job.scene];
      E2LF_ASSIGN_OR_RETURN(truth, load_scene(scene));
      E2LF_ASSIGN_OR_RETURN(disparity, scene_disparity(scene, truth));
      loaded = job.scene;
      if (plan.pictures) {
        E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> png,
                              lightfield::encode_png(look(truth, nullptr, disparity), kDepth));
        E2LF_RETURN_IF_ERROR(store.keep_picture(truth_key(scene), png));
      }
    }
    E2LF_ASSIGN_OR_RETURN(const Outcome outcome, runner.run(job, truth, disparity, report));
    std::vector<uint8_t> png;
    if (plan.pictures && job.seed == plan.jobs.front().seed) {
      E2LF_ASSIGN_OR_RETURN(
          png, lightfield::encode_png(look(outcome.light_field, &truth, outcome.disparity, disparity), kDepth));
    }
    return store.keep(plan, job, outcome.figures, png);
  };
  for (; done < jobs.size() && !stop_requested(); ++done) {
    const auto computed = compute(plan.jobs[jobs[done]]);
    if (!computed && computed.error().code == ErrorCode::kCancelled && stop_requested()) break;  // within a job
    if (!computed) return computed.error();
  }
  return done;
}

namespace fs = std::filesystem;

fs::path ResultStore::file(const std::string& key, const char* extension) const {
  return folder_ / "results" / (key + extension);
}

std::optional<Json> ResultStore::find(const Job& job) const {
  const auto json = read_json(file(job.key, ".json"));
  if (!json || !json->is_object() || json->value("inputs", Json()) != job.inputs) return std::nullopt;
  Json figures = json->value("figures", Json());
  if (!figures.is_object() || json->value("sha256", Json()) != sha256_of_text(json_line(figures))) return std::nullopt;
  return figures;
}

std::vector<uint8_t> ResultStore::picture(const std::string& key) const {
  return read_file(file(key, ".png")).value_or({});
}

Result<void> ResultStore::keep_picture(const std::string& key, const std::vector<uint8_t>& png) const {
  return png.empty() ? Result<void>() : write_file(file(key, ".png"), png);
}

Result<void> ResultStore::keep(const Plan& plan, const Job& job, const Json& figures,
                               const std::vector<uint8_t>& png) const {
  E2LF_RETURN_IF_ERROR(keep_picture(job.key, png));
  const Json json = {{"written_by", "e2lf"},
                     {"method", plan.methods[job.method].config.name},
                     {"scene", plan.scenes[job.scene].name},
                     {"sensor", plan.sensors[job.sensor].config.name},
                     {"inputs", job.inputs},
                     {"figures", figures},
                     {"sha256", sha256_of_text(json_line(figures))}};
  return write_file(file(job.key, ".json"), json_text(json));
}

Result<size_t> ResultStore::take_over(const Plan& plan, const ResultStore& other) const {
  size_t taken = 0;
  for (const ComparedScene& scene : plan.scenes) {
    E2LF_RETURN_IF_ERROR(keep_picture(truth_key(scene), other.picture(truth_key(scene))));
  }
  for (const Job& job : plan.jobs) {
    if (find(job)) continue;
    const auto figures = other.find(job);
    if (!figures) continue;
    E2LF_RETURN_IF_ERROR(keep(plan, job, *figures, other.picture(job.key)));
    ++taken;
  }
  return taken;
}

std::string truth_key(const ComparedScene& scene) {
  return sha256_of_text(json_line(scene.identity));
}

}  // namespace e2lf::compare
