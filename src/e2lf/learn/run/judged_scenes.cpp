// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/judged_scenes.h"

#include <algorithm>
#include <filesystem>
#include <torch/torch.h>

#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/data/pattern_draws.h"
#include "e2lf/learn/network/any_patterns.h"

namespace e2lf::learn {

Result<capture::Codes> read_shown(const std::string& name, const PatternConfig& patterns) {
  E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_pattern_set(name));
  if (patterns.whole_cycle && !capture::codes_of_whole_cycle(codes)) codes = capture::whole_cycle(codes);
  E2LF_RETURN_IF_ERROR(describe_apertures({codes}, torch::kCPU));
  return codes;
}

Result<std::vector<JudgedSet>> read_judged(const PatternConfig& patterns, const capture::Codes& own) {
  if (patterns.evaluated.empty()) return std::vector{JudgedSet{"", own}};
  std::vector<JudgedSet> sets;
  for (const std::string& name : patterns.evaluated) {
    E2LF_ASSIGN_OR_RETURN(capture::Codes codes, read_shown(name, patterns));
    sets.push_back({std::filesystem::path(name).stem().string(), std::move(codes)});
  }
  return sets;
}

Result<std::vector<SceneScore>> judge_sets(const std::vector<JudgedSet>& sets,
                                           const std::function<Result<SceneScore>(const capture::Codes&)>& judge) {
  std::vector<SceneScore> scores;
  for (const JudgedSet& set : sets) {
    E2LF_ASSIGN_OR_RETURN(SceneScore score, judge(set.codes));
    if (!set.name.empty()) score.name += ":" + set.name;
    scores.push_back(std::move(score));
  }
  return scores;
}

Result<JudgedEvents> simulate_judged(const Scene& scene, const capture::Codes& codes, const Judgement& judgement,
                                     int64_t multiple, torch::Device device) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(judgement.seed);
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  if (2 * std::min(height, width) <= multiple) {
    return fail(ErrorCode::kShape, scene.name, "the scene is too small for this network; evaluate scenes of more than ",
                multiple / 2, " px");
  }
  const auto missing = [&](int64_t length) { return (multiple - length % multiple) % multiple; };
  const auto views = at::reflection_pad2d(scene.views.to(torch::kFloat).div(255.0).unsqueeze(0).contiguous(),
                                          {0, missing(width), 0, missing(height)});
  const PatternNumbers numbers = numbers_of(codes);
  JudgedEvents judged;
  judged.constants = sample_of(judgement.camera, numbers.all, numbers.codes, 1, device);
  judged.cycles = torch::full({1, views.size(2), views.size(3)}, static_cast<double>(judgement.cycles),
                              torch::device(device).dtype(torch::kFloat));
  judged.events =
      simulate_cycles(views, {codes}, judged.constants, torch::zeros({1}, torch::device(device)), judged.cycles);
  judged.events_per_pixel =
      judged.events.abs().sum().item<double>() / static_cast<double>(views.size(2) * views.size(3));
  return judged;
}

torch::Tensor judged_part(const torch::Tensor& map, const Scene& scene) {
  constexpr int64_t kUnjudgedBorder = 15;  // px
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  const int64_t border = std::min({kUnjudgedBorder, height / 4, width / 4});
  return map.slice(0, border, height - border).slice(1, border, width - border);
}

}  // namespace e2lf::learn
