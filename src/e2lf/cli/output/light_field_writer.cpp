// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/light_field_writer.h"

#include "e2lf/base/clock.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/plausible_events.h"
#include "e2lf/cli/flags/cycle_options.h"
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

Json check_json(const recon::EventJudgement& judgement, bool is_doubtful) {
  const bool is_favourable = judgement.verdict == recon::Verdict::kGood || judgement.verdict == recon::Verdict::kUsual;
  Json json = {{"verdict", is_doubtful && is_favourable ? "unconfirmed" : recon::verdict_name(judgement.verdict)},
               {"error", judgement.error},
               {"noise_error", judgement.noise_error},
               {"ratio", judgement.ratio}};
  if (!judgement.change.empty()) {
    json["changed"] = {
        {"how", judgement.change}, {"error", judgement.changed_error}, {"unchanged_error", judgement.unchanged_error}};
  }
  if (judgement.rival_error) json["error_with_the_models_camera"] = *judgement.rival_error;
  return json;
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
  return text + formatted("; %.1f times the difference that noise causes: %s\n", check["ratio"].get<double>(),
                          check["verdict"] == "good"    ? "good"
                          : check["verdict"] == "usual" ? "as usual"
                          : check["verdict"] == "unconfirmed"
                              ? "unconfirmed, because the confidence of the cycle is low"
                              : "see the warning");
}

void warn_of_verdict(const Json& cycle) {
  if (!cycle.contains("check")) return;
  const Json& check = cycle["check"];
  if (check["verdict"] == "wrong") {
    log_warning(cat("the light field differs from its events by ", formatted("%.1f", check["ratio"].get<double>()),
                    " times the difference that noise causes: the polarity of the events, the order of the patterns or "
                    "the camera is probably wrong; check them (`e2lf codes show`, docs/recordings.md)"));
  } else if (check["verdict"] == "changed-better") {
    const Json& changed = check["changed"];
    const std::string how = changed["how"].get<std::string>();
    log_warning(cat(
        "the events are explained much better ", how, ": their light field differs by ",
        formatted("%.3f instead of %.3f", changed["error"].get<double>(), changed["unchanged_error"].get<double>()),
        how.find("polarity") != std::string::npos ? "; give --invert-polarity"
                                                  : "; check the order of the patterns (--codes, --first-pattern)"));
  } else if (check["verdict"] == "rival-better") {
    log_warning(cat("the camera of --camera explains the events much worse than the one for which the network was ",
                    "trained: they differ by ",
                    formatted("%.3f instead of %.3f", check["error"].get<double>(),
                              check["error_with_the_models_camera"].get<double>()),
                    "; leave --camera out, or calibrate again"));
  }
}

}  // namespace e2lf::cli
