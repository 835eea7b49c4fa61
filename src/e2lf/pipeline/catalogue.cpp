// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/catalogue.h"

#include <tuple>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/model/composition.h"

namespace e2lf::pipeline {
namespace {

/// Tells whether a network for any patterns can be adapted to these.
bool can_be_adapted(const model::StatedModel& stated, const capture::Codes& codes) {
  if (!stated.is_for_any_patterns || !capture::is_black_first(codes)) return false;
  const model::Model& model = stated.model;
  return !model::reads_moved_pictures(model) || model::is_depth_network(model) ||
         (model.views_y >= codes.views_y && model.views_x >= codes.views_x && !capture::codes_of_whole_cycle(codes));
}

bool is_suitable(const model::StatedModel& stated, const ModelNeeds& needs) {
  const model::Model& model = stated.model;
  return (model.codes == needs.codes || can_be_adapted(stated, needs.codes)) &&
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

/// Calls `see` with the file and the header of each bundled model. Files that cannot be read are left out.
template <typename See>
void for_each_bundled(const See& see) {
  for (const std::string& name : bundled_names(kBundledModels)) {
    const auto path = bundled_file_named(kBundledModels, name);
    if (!path) continue;
    const auto stated = model::read_stated_model(*path);
    if (!stated && stated.error().code != ErrorCode::kUnsupported) log_warning(stated.error().text());
    if (stated) see(*path, *stated);
  }
}

}  // namespace

Result<std::optional<BundledModel>> choose_bundled_model(const ModelNeeds& needs) {
  std::optional<std::filesystem::path> chosen;
  Rank best;
  for_each_bundled([&](const std::filesystem::path& path, const model::StatedModel& stated) {
    if (!is_suitable(stated, needs)) return;
    const auto rank = rank_of(stated, needs);
    if (chosen && rank <= best) return;
    chosen = path;
    best = rank;
  });
  if (!chosen) return std::optional<BundledModel>();
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(*chosen));
  return std::optional(BundledModel{std::move(*chosen), std::move(model)});
}

std::string conditioned_network_remedy(const std::optional<capture::Codes>& codes, bool gives_disparity) {
  std::string names;
  for_each_bundled([&](const std::filesystem::path& path, const model::StatedModel& stated) {
    ModelNeeds needs{.codes = {}, .gives_disparity = gives_disparity, .is_conditioned = true};
    if (codes || stated.model.codes) needs.codes = codes ? *codes : *stated.model.codes;
    if (is_suitable(stated, needs)) names += cat(names.empty() ? "" : " or ", path.stem().string());
  });
  if (names.empty()) {
    return "train a network that is conditioned on the sensor profile, because no bundled network is suitable";
  }
  return cat("use a network that is conditioned on the sensor profile: ", names);
}

}  // namespace e2lf::pipeline
