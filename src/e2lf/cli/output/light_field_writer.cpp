// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/light_field_writer.h"

#include "e2lf/base/clock.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/plausible_events.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/output/event_verdict.h"
#include "e2lf/cli/output/print.h"
#include "e2lf/lightfield/contact_sheet.h"
#include "e2lf/lightfield/epi.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/orient.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

Result<void> write_reconstruction(const fs::path& folder, lightfield::LightField& light_field,
                                  const std::string& format, const capture::Orientation& views,
                                  const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightFieldFormat stored, lightfield::parse_format(format));
  const bool is_array = stored == lightfield::LightFieldFormat::kNpy;
  if (is_array) {
    E2LF_RETURN_IF_ERROR(lightfield::write_light_field(folder / "lightfield.npy", light_field, {.format = stored}));
  }
  lightfield::orient(light_field, views);
  if (!is_array) E2LF_RETURN_IF_ERROR(lightfield::write_views(folder, light_field, stored, progress));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / "contact_sheet.png", lightfield::contact_sheet(light_field)));
  const lightfield::EpiPictureOptions cut = lightfield::middle_cut(light_field.shape());
  return lightfield::write_png(folder / "epi.png", lightfield::epi_picture(light_field, cut));
}

capture::Orientation stored_views(const std::string& format, const capture::Orientation& views) {
  return format == "npy" ? views : capture::Orientation{};
}

std::string cycle_name(size_t cycle) {
  return formatted("cycle_%05zu", cycle);
}

Result<lightfield::LightField> LightFieldWriter::process(const pipeline::CycleImages& cycle, const fs::path& folder) {
  warn_of_events(cycle);
  // For live input, the log has a line for each cycle instead.
  ProgressBar bar(cat("reconstruct ", cycle_name(cycles_.size())), options_.is_quiet || cycle.is_live());
  bar.update(0, 1);
  E2LF_ASSIGN_OR_RETURN(pipeline::Field field, by_flag(sequence_.next(cycle.images, bar.callback()), options_.input));
  hide_progress();
  E2LF_RETURN_IF_ERROR(write_reconstruction(folder, field.light_field, options_.format,
                                            options_.views.value_or(capture::Orientation{}), {}));
  Json about = cycle.cycle ? cycle_json(*cycle.cycle) : Json::object();
  about["cycle"] = cycles_.size();
  about["gain"] = field.gain;
  about["black"] = field.black;
  about["reconstruct_s"] = field.reconstruct_s;
  if (field.motion) {
    about["motion"] = *field.motion;
    about["transitions"] = field.is_of_lit ? "lit" : "all";
  }
  about["latency_s"] = cycle.behind_s + seconds_since(cycle.ready);
  if (field.error) {
    about["event_error"] = field.error->at_first;
    about["least_event_error"] = {{"value", field.error->least}, {"residue", field.error->residue}};
  }
  if (field.judgement) {
    about["check"] = check_json(*field.judgement, cycle.cycle && is_doubtful(*cycle.cycle, cycle.source));
  }
  if (cycle.is_live()) live_log_.add(about["number"], about["events"], about["latency_s"]);
  cycles_.push_back(std::move(about));
  return std::move(field.light_field);
}

Json LightFieldWriter::notes() const {
  if (!options_.views) return Json::object();
  return {{"views", lightfield::views_note(*options_.views, stored_views(options_.format, *options_.views))}};
}

void LightFieldWriter::warn_of_events(const pipeline::CycleImages& cycle) {
  constexpr size_t kMostWarnings = 3;
  if (warned_ == kMostWarnings || !capture::has_events(cycle.images.kind)) return;
  const std::vector<std::string> doubts =
      capture::event_doubts(cycle.images.events, options_.codes ? &*options_.codes : nullptr);
  for (const std::string& doubt : doubts) {
    log_warning(cat(options_.input.string(), ", cycle ", cycles_.size(), ": ", doubt));
  }
  warned_ += doubts.empty() ? 0 : 1;
  if (warned_ == kMostWarnings && !doubts.empty()) log_warning("further warnings of this kind are suppressed");
}

}  // namespace e2lf::cli
