// SPDX-License-Identifier: MIT
#include "e2lf/compare/jobs.h"

#include <algorithm>
#include <set>

#include "e2lf/base/stop.h"
#include "e2lf/compare/measure.h"
#include "e2lf/compare/pictures.h"
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
  for (; done < jobs.size() && !stop_requested(); ++done) {
    const Job& job = plan.jobs[jobs[done]];
    report(0, 1);
    if (loaded != job.scene) {
      const Scene& scene = plan.scenes[job.scene];
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
    E2LF_RETURN_IF_ERROR(store.keep(plan, job, outcome.figures, png));
  }
  return done;
}

}  // namespace e2lf::compare
