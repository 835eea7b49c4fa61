// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/light_field_writer.h"

#include <numeric>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;

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

std::string cycle_name(size_t cycle) {
  return formatted("cycle_%05zu", cycle);
}

Result<void> LightFieldWriter::process(const pipeline::CycleImages& cycle, const fs::path& folder) {
  const diagnose::Findings findings = check_events(cycle);
  const bool is_confirmed =
      options_.is_confirmed && !(cycle.cycle && diagnose::is_doubtful(cycle.cycle->confidence, cycle.source));
  // For live input, the log has a line for each cycle instead.
  ProgressBar bar(cat("reconstruct ", cycle_name(cycles_.size())), options_.is_quiet || cycle.is_live());
  bar.update(0, 1);
  Json comparison = Json::object();
  const auto observe = [&](const LightField& unprocessed, const capture::Measurement& used,
                           bool is_of_lit) -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(comparison, check_field(unprocessed, used, is_of_lit, is_confirmed));
    return {};
  };
  E2LF_ASSIGN_OR_RETURN(pipeline::Field field,
                        by_flag(sequence_.next(cycle.images, bar.callback(), observe), options_.input));
  hide_progress();
  E2LF_RETURN_IF_ERROR(write_reconstruction(folder, field.light_field, options_.format,
                                            options_.views.value_or(capture::Orientation{}), {}));
  Json about = cycle.cycle ? cycle_json(*cycle.cycle) : Json::object();
  about["cycle"] = cycles_.size();
  if (!findings.empty()) about["findings"] = diagnose::to_json(findings);
  about["gain"] = field.gain;
  about["black"] = field.black;
  about["reconstruct_s"] = field.reconstruct_s;
  if (field.motion) {
    about["motion"] = *field.motion;
    about["transitions"] = field.is_of_lit ? "lit" : "all";
  }
  if (const auto& cycles = cycle.images.fused.cycles.values; !cycles.empty()) {
    about["fused_cycles"] = std::reduce(cycles.begin(), cycles.end(), 0.0) / static_cast<double>(cycles.size());
  }
  about["latency_s"] = cycle.behind_s + seconds_since(cycle.ready);
  about.update(comparison);
  if (cycle.is_live()) live_log_.add(about["number"], about["events"], about["latency_s"]);
  cycles_.push_back(std::move(about));
  return {};
}

Json LightFieldWriter::notes() const {
  if (!options_.views) return Json::object();
  const capture::Orientation stored = options_.format == "npy" ? *options_.views : capture::Orientation{};
  return {{"views", lightfield::views_note(*options_.views, stored)}};
}

Result<Json> LightFieldWriter::check_field(const LightField& field, const capture::Measurement& used, bool is_of_lit,
                                           bool is_confirmed) const {
  Json json = Json::object();
  if (!options_.check || !capture::has_events(used.kind)) return json;
  E2LF_ASSIGN_OR_RETURN(const recon::EventError error, options_.check->compare(field, used.events, is_of_lit));
  json["event_error"] = error.at_first;
  json["least_event_error"] = {{"value", error.least}, {"residue", error.residue}};
  if (!cycles_.empty()) return json;
  E2LF_ASSIGN_OR_RETURN(const auto explanation, options_.check->judge(field, used, is_of_lit, is_confirmed));
  if (explanation) json["check"] = explanation->json(is_confirmed);
  return json;
}

diagnose::Findings LightFieldWriter::check_events(const pipeline::CycleImages& cycle) {
  constexpr size_t kMostWarnings = 3;
  if (!capture::has_events(cycle.images.kind)) return {};
  diagnose::Findings findings = diagnose::check_event_images(
      cycle.images.events, options_.codes ? &*options_.codes : nullptr, options_.cycles_per_field);
  if (findings.empty() || warned_ == kMostWarnings) return findings;
  diagnose::log_findings(cat(options_.input.string(), ", cycle ", cycles_.size()), findings);
  if (++warned_ == kMostWarnings) log_warning("further warnings of this kind are only in the record");
  return findings;
}

std::string event_error_text(const Json& cycle) {
  std::string text = formatted(
      "events simulated from it with these patterns and this camera differ from the given ones by %.3f per pixel and "
      "transition",
      cycle["event_error"].get<double>());
  const Json& least = cycle["least_event_error"];
  const double residue = least["residue"].get<double>();
  if (residue > 0) {
    text += formatted(", or by %.3f if references start %.2f thresholds above the first level",
                      least["value"].get<double>(), residue);
  }
  if (!cycle.contains("check")) return text + "\n";
  const Json& check = cycle["check"];
  return text + formatted("; %.2g times the difference that noise causes: %s\n", check["ratio"].get<double>(),
                          check["verdict"] == "good"    ? "good"
                          : check["verdict"] == "usual" ? "as usual"
                          : check["verdict"] == "unconfirmed"
                              ? "unconfirmed, because the confidence of the cycle is low"
                              : "doubtful, see the warnings");
}

void log_check(const fs::path& input, const Json& cycle) {
  if (!cycle.contains("check")) return;
  diagnose::log_findings(input.string(), diagnose::findings_from_json(cycle["check"]["findings"]));
}

}  // namespace e2lf::cli
