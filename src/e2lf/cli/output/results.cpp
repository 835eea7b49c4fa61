// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/results.h"

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
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

std::string cycle_name(size_t cycle) {
  return formatted("cycle_%05zu", cycle);
}

Result<fs::path> ResultParts::begin(const std::string& name) {
  if (is_one_) return folder_.path();
  return folder_.begin_part(name);
}

Result<void> ResultParts::commit(const std::string& name, Json about, const program::RunRecord& run) {
  if (is_one_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit_part(name, std::move(about)));
  if (is_in_place_ || is_strict_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit(run.json_so_far()));
  is_in_place_ = true;
  return {};
}

Result<void> ResultParts::finish(const program::RunRecord& run) {
  E2LF_ASSIGN_OR_RETURN(Json about, run.json());
  return is_in_place_ ? folder_.update_record(std::move(about)) : folder_.commit(std::move(about));
}

namespace {

/// What the record states of a light field, beside what it states of every result.
Json field_json(const pipeline::EventResult& result, const pipeline::Field& field) {
  Json json = {{"gain", field.gain}, {"black", field.black}, {"reconstruct_s", field.reconstruct_s}};
  if (field.motion) {
    json["motion"] = *field.motion;
    json["transitions"] = field.is_of_lit ? "lit" : "all";
  }
  if (result.error) {
    json["event_error"] = result.error->at_first;
    json["least_event_error"] = {{"value", result.error->least}, {"residue", result.error->residue}};
  }
  if (result.check) json["check"] = result.check->json(result.is_confirmed);
  return json;
}

/// Logs how many light fields were reconstructed from the lit transitions because the scene moved.
void log_motion(const fs::path& input, const pipeline::EventRunReport& report, const pipeline::OpenedMethod& method) {
  if (report.of_lit == 0) return;
  log_info(cat(input.string(), ": the scene moved during ", report.of_lit, " of ", report.results, " cycles, which ",
               method.lit->model().name,
               " reconstructed from their lit transitions; --transitions all uses the whole cycle in every case"));
}

}  // namespace

EventRunLog::EventRunLog(const pipeline::EventRun& run, fs::path input, RunRecord& record)
    : run_(run), input_(std::move(input)) {
  record_method(run.method(), record);
  diagnose::log_findings(input_.string(), run.method().findings);
  record.end_step("open");
}

Json EventRunLog::add(const pipeline::EventResult& result) {
  constexpr size_t kMostWarnings = 3;
  hide_progress();
  if (!result.findings.empty() && warned_ < kMostWarnings) {
    diagnose::log_findings(cat(input_.string(), ", cycle ", result.number), result.findings);
    if (++warned_ == kMostWarnings) log_warning("further warnings of this kind are only in the record");
  }
  if (result.check) diagnose::log_findings(input_.string(), result.check->findings);
  Json json = result.cycle.cycle ? cycle_json(*result.cycle.cycle) : Json::object();
  json["cycle"] = result.number;
  if (!result.findings.empty()) json["findings"] = diagnose::to_json(result.findings);
  if (const auto cycles = result.fused_cycles()) json["fused_cycles"] = *cycles;
  if (const auto* field = std::get_if<pipeline::Field>(&result.made)) json.update(field_json(result, *field));
  json["latency_s"] = result.cycle.behind_s + seconds_since(result.cycle.ready);
  if (result.cycle.is_live()) live_.add(json["number"], json["events"], json["latency_s"]);
  return json;
}

Result<Json> EventRunLog::finish(const Verb& verb, RunRecord& record) {
  hide_progress();
  const pipeline::EventRunReport report = run_.report();
  warn_of_losses(input_, report.left_out);
  verb.set_failed_input(report.left_out.live.failure);
  log_motion(input_, report, run_.method());
  if (run_.input().is_recording()) {
    const cycles::CycleReader& reader = run_.input().reader();
    const diagnose::RigCheck& rig = run_.input().rig();
    live_.finish(reader.report());
    if (report.results == 0) return no_cycle_error(input_, rig, reader);
    diagnose::log_findings(input_.string(), rig.findings(reader));
    record.resolve("source", word_of(reader.source(), kCycleSources));
    record.note("found", rig.json(reader));
    record.note(reading_notes(input_, reader.recording().info()));
  }
  const Json told = {{"left_out", losses_json(report.left_out)}, {"findings", diagnose::to_json(report.findings)}};
  record.note(told);
  record.note("live", live_json(report.left_out));
  record.add_input(input_);
  return told;
}

std::string event_error_text(const pipeline::EventResult& result) {
  if (!result.error) return "";
  std::string text = formatted(
      "events simulated from it with these patterns and this camera differ from the given ones by %.3f per pixel and "
      "transition",
      result.error->at_first);
  if (result.error->residue > 0) {
    text += formatted(", or by %.3f if references start %.2f thresholds above the first level", result.error->least,
                      result.error->residue);
  }
  if (!result.check) return text + "\n";
  const std::string verdict = result.check->verdict(result.is_confirmed);
  return text + formatted("; %.2g times the difference that noise causes: %s\n", result.check->ratio,
                          verdict == "good"          ? "good"
                          : verdict == "usual"       ? "as usual"
                          : verdict == "unconfirmed" ? "unconfirmed, as the warnings or the confidence of the cycle say"
                                                     : "doubtful, see the warnings");
}

}  // namespace e2lf::cli
