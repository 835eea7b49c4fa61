// SPDX-License-Identifier: MIT
// e2lf check: one page on a rig, from the first cycles of a recording or of a live camera

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/pipeline/rig_report.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using pipeline::PatternFit;
using pipeline::RigReport;
namespace {

struct RigArguments {
  fs::path input;
  double seconds = 10;
  MethodFlags method;
  CycleFlags cycles;
  std::vector<std::string> of_reconstruct = {};  ///< the words of the command line that `reconstruct` takes, too
};

/// Returns the words without the options that `check` alone has, or that only concern its output.
std::vector<std::string> words_of_reconstruct(const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--seconds") {
      ++i;  // its value
    } else if (words[i] != "--json" && words[i] != "--quiet" && !words[i].starts_with("--seconds=")) {
      kept.push_back(words[i]);
    }
  }
  return kept;
}

Json fit_json(const PatternFit& fit) {
  return {{"patterns", fit.patterns},
          {"model", fit.method.network ? fit.method.network->model().name : "inversion"},
          {"camera", fit.method.camera ? Json(fit.method.camera->name) : Json()},
          {"ratio", fit.explained.ratio},
          {"contrast", fit.explained.contrast}};
}

/// Returns what the recording itself tells: its duration, the rate of its events, its triggers and its losses.
Json recording_json(const pipeline::CycleInput& input) {
  const cycles::CycleReader& reader = input.reader();
  const recordings::DecodeSummary summary = input.summary();
  const double seconds = static_cast<double>(input.rig().seen_us()) * 1e-6;
  const auto events = static_cast<double>(summary.events());
  return {{"seconds", seconds},
          {"events", summary.events()},
          {"events_per_s", seconds > 0 ? events / seconds : 0.0},
          {"on_share", events > 0 ? static_cast<double>(summary.events_on) / events : 0.0},
          {"source", word_of(reader.source(), kCycleSources)},
          {"found", input.rig().json(reader)},
          {"left_out", losses_json(summary)}};
}

Json rig_json(const RigReport& report) {
  Json fits = Json::array();
  for (const PatternFit& fit : report.fits) fits.push_back(fit_json(fit));
  return {{"cycles", report.cycles},
          {"width", report.width},
          {"height", report.height},
          {"events_per_pixel", report.events_per_pixel},
          {"hot_pixels", report.hot},
          {"silent_pixels", report.silent},
          {"fits", fits},
          {"no_network", report.no_network ? Json(report.no_network->text()) : Json()},
          {"changes", report.changes},
          {"findings", diagnose::to_json(report.findings)},
          {"verdict", report.verdict()}};
}

std::string line(const char* name, const std::string& text) {
  return formatted("%-12s%s\n", name, text.c_str());
}

std::string recording_text(const Json& recording) {
  const Json& found = recording["found"];
  std::string text =
      line("events", formatted("%.2f M in %.2f s: %.2f M/s, %.0f %% ON", recording["events"].get<double>() * 1e-6,
                               recording["seconds"].get<double>(), recording["events_per_s"].get<double>() * 1e-6,
                               100 * recording["on_share"].get<double>()));
  constexpr std::string_view kPrefix = "triggers: ";
  const auto triggers = found["triggers"].get<std::string>();
  text += line("triggers", triggers.starts_with(kPrefix) ? triggers.substr(kPrefix.size()) : triggers);
  if (!found["event_delay_us"].is_null()) {
    text += line("delay", cat("events change ", found["event_delay_us"].get<int64_t>(), " us after the triggers"));
  }
  return text;
}

std::string fits_text(const RigReport& report) {
  std::string text;
  for (const PatternFit& fit : report.fits) {
    const Json json = fit_json(fit);
    text += line(
        text.empty() ? "patterns" : "",
        cat(fit.patterns.empty() ? "as stated" : fit.patterns, ": ", json["model"].get<std::string>(),
            json["camera"].is_null() ? "" : cat(" with ", json["camera"].get<std::string>()),
            formatted(" explains the events with %.2f times the difference that noise causes", fit.explained.ratio)));
  }
  return report.no_network ? line("patterns", report.no_network->text()) : text;
}

/// Returns the other order, polarity or orientation that explains the events best.
std::string changes_text(const RigReport& report) {
  const auto changes = report.changes.items();
  std::optional<std::pair<std::string, double>> best;
  for (const auto& [name, ratio] : changes) {
    if (!best || ratio.get<double>() < best->second) best = {name, ratio.get<double>()};
  }
  if (!best) return "";
  return line("order",
              formatted("%s, the light field would differ from the events %.2f times as much (the best of %zu other "
                        "orders, polarities and orientations)",
                        best->first.c_str(), best->second, report.changes.size()));
}

/// Returns the command that follows: the reconstruction if nothing is wrong.
std::string next_step(const RigArguments& arguments, const RigReport& report) {
  if (report.fits.empty() && report.findings.empty()) {
    return "state other patterns or another network, as above, and run e2lf check again";
  }
  if (diagnose::has_doubt(report.findings) || report.fits.empty()) {
    return "correct the first finding, and run e2lf check again";
  }
  std::string command = "e2lf reconstruct";
  for (const std::string& word : arguments.of_reconstruct) command += cat(" ", shell_word(word));
  const std::string& patterns = report.fits.front().patterns;
  return cat(command, patterns.empty() ? "" : cat(" --codes ", patterns), " -o recon");
}

std::string page(const RigArguments& arguments, const RigReport& report, const Json& json) {
  std::string text = line("input", arguments.input.string());
  if (json.contains("recording")) text += recording_text(json["recording"]);
  if (report.cycles > 0) {
    text += line("light", formatted("%.2f events per pixel in each of %zu cycles (1 to 9 in good light)",
                                    report.events_per_pixel, report.cycles));
    text += line("pixels", cat(report.width, "x", report.height, ": ", report.hot, " hot, ", report.silent,
                               " without events among others that have some"));
  }
  text += fits_text(report) + changes_text(report) + line("verdict", report.verdict());
  for (const diagnose::Finding& finding : report.findings) {
    text += line(diagnose::severity_name(finding.severity), diagnose::text_of(finding));
  }
  return text + line("next", next_step(arguments, report));
}

Result<void> check_rig(const RigArguments& arguments, const Verb& verb) {
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(pipeline::MethodChoice choice, named_choice(arguments.method, record));
  std::optional<Deadline> deadline;
  if (is_live(arguments.input)) deadline.emplace(arguments.seconds);
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInput input, open_cycle_input(arguments.input, arguments.cycles, verb, choice));
  E2LF_ASSIGN_OR_RETURN(
      const RigReport report,
      pipeline::naming(arguments.input, pipeline::examine_rig(input, std::move(choice), [&] { deadline.reset(); })));
  Json json = rig_json(report);
  json["input"] = arguments.input.string();
  if (input.is_recording()) {
    json["recording"] = recording_json(input);
    warn_of_losses(arguments.input, input.summary());
    verb.set_failed_input(input.summary().live.failure);
  }
  json["next"] = next_step(arguments, report);
  print_result(verb.common(), json, page(arguments, report, json));
  if (!verb.common().quiet || verb.common().json) return {};
  if (report.no_network) log_warning(cat(arguments.input.string(), ": ", report.no_network->text()));
  diagnose::log_findings(arguments.input.string(), report.findings);
  return {};
}

}  // namespace

int run_check(const std::vector<std::string>& arguments) {
  Verb verb("check",
            "Check a rig on one page: its light, pixels and triggers, which patterns, network and camera explain the "
            "events, and whether another order, polarity or orientation of the patterns explains them better.",
            "e2lf check recording.raw");
  RigArguments rig;
  rig.of_reconstruct = words_of_reconstruct(arguments);
  rig.cycles.events.max_cycles = 16;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", rig.input,
                 "recording, event images, - for a pipe, tcp://127.0.0.1:PORT, camera://NAME or replay:FILE")
      ->required();
  app.add_option("--seconds", rig.seconds, "live input: longest time of the observation")
      ->check(positive_number())
      ->capture_default_str();
  add_method_options(app, rig.method, "the file of the events");
  add_cycle_options(app, rig.cycles);
  verb.stop_gently();
  return verb.run(arguments, [&] { return check_rig(rig, verb); });
}

}  // namespace e2lf::cli
