// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/event_verdict.h"

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/output/print.h"

namespace e2lf::cli {

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
