// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/catalogue.h"

#include <tuple>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/model/composition.h"

namespace e2lf::pipeline {
namespace {

bool is_suitable(const model::StatedModel& stated, const ModelNeeds& needs) {
  const model::Model& model = stated.model;
  return (stated.is_for_any_patterns || model.codes == needs.codes) &&
         model.measurement() == capture::MeasurementKind::kEventImages &&
         model::is_depth_network(model) == needs.gives_disparity && (needs.may_be_guided || !stated.guide) &&
         (!needs.is_conditioned || model::is_conditioned_on_camera(model));
}

using Rank = std::tuple<bool, bool, bool, double>;

/// Returns the place of a suitable model among others; the greatest one is chosen.
Rank rank_of(const model::StatedModel& stated, const ModelNeeds& needs) {
  const double macs = model::macs_per_pixel(stated.model.network);
  const bool is_own = stated.model.codes == needs.codes;
  if (needs.is_fast) return {is_own, false, !stated.guide, -macs};
  return {is_own, !model::is_conditioned_on_camera(stated.model), stated.guide.has_value(), macs};
}

}  // namespace

Result<std::optional<BundledModel>> choose_bundled_model(const ModelNeeds& needs) {
  std::optional<std::filesystem::path> chosen;
  Rank best;
  for (const std::string& name : bundled_names(kBundledModels)) {
    const auto path = bundled_file_named(kBundledModels, name);
    if (!path) continue;
    const auto stated = model::read_stated_model(*path);
    if (!stated && stated.error().code != ErrorCode::kUnsupported) log_warning(stated.error().text());
    if (!stated || !is_suitable(*stated, needs)) continue;
    const auto rank = rank_of(*stated, needs);
    if (chosen && rank <= best) continue;
    chosen = *path;
    best = rank;
  }
  if (!chosen) return std::optional<BundledModel>();
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(*chosen));
  return std::optional(BundledModel{std::move(*chosen), std::move(model)});
}

}  // namespace e2lf::pipeline
