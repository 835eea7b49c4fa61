// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/event_verdict.h"

#include <array>
#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"

namespace e2lf::cli {

Json check_json(const recon::EventJudgement& judgement) {
  Json json = {{"verdict", recon::verdict_name(judgement.verdict)},
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

void print_event_error(const Json& cycle) {
  std::printf(
      "simulated again with these patterns and this camera, it differs from the events by %.3f per pixel and "
      "transition",
      cycle["event_error"].get<double>());
  const Json& least = cycle["least_event_error"];
  const double residue = least["residue"].get<double>();
  if (residue > 0) {
    std::printf(", by %.3f if references start %.2f thresholds above the first intensity", least["value"].get<double>(),
                residue);
  }
  if (!cycle.contains("check")) {
    std::printf("\n");
    return;
  }
  const Json& check = cycle["check"];
  std::printf("; %.1f times what noise makes: %s\n", check["ratio"].get<double>(),
              check["verdict"] == "good"    ? "good"
              : check["verdict"] == "usual" ? "as usual"
                                            : "see the warning");
}

void warn_of_verdict(const Json& cycle) {
  if (!cycle.contains("check")) return;
  const Json& check = cycle["check"];
  if (check["verdict"] == "wrong") {
    std::array<char, 16> ratio;
    std::snprintf(ratio.data(), ratio.size(), "%.1f", check["ratio"].get<double>());
    log_warning(cat("the light field differs from its events by ", ratio.data(),
                    " times what noise makes: the polarity of the events, the order of the patterns or the camera is "
                    "likely wrong; check them (`e2lf codes show`, docs/recordings.md)"));
  } else if (check["verdict"] == "changed-better") {
    const Json& changed = check["changed"];
    std::array<char, 64> errors;
    std::snprintf(errors.data(), errors.size(), "%.3f in place of %.3f", changed["error"].get<double>(),
                  changed["unchanged_error"].get<double>());
    const std::string how = changed["how"].get<std::string>();
    log_warning(cat("the events are explained much better ", how, ": a light field of them differs by ", errors.data(),
                    how.find("polarity") != std::string::npos
                        ? "; give --invert-polarity"
                        : "; check the order of the patterns (--codes, --first-pattern)"));
  } else if (check["verdict"] == "rival-better") {
    std::array<char, 64> errors;
    std::snprintf(errors.data(), errors.size(), "%.3f in place of %.3f", check["error"].get<double>(),
                  check["error_with_the_models_camera"].get<double>());
    log_warning(
        cat("the camera of --camera explains the events much worse than the one that the network was made for: ",
            "they differ by ", errors.data(), "; leave --camera out, or calibrate again"));
  }
}

}  // namespace e2lf::cli
