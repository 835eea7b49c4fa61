// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/method_findings.h"

#include "e2lf/base/text.h"
#include "e2lf/pipeline/catalogue.h"

namespace e2lf::pipeline {
using diagnose::Finding;
using diagnose::Findings;
using diagnose::Severity;
namespace {

/// Light fields for other patterns can explain the events as well.
Finding patterns_assumed(const std::string& whose) {
  return Finding{"patterns-assumed", Severity::kWarning,
                 cat("the input does not state which patterns the camera showed; those of ", whose, " are assumed"),
                 "state them, or the schedule of the display"}
      .about("codes");
}

std::optional<Finding> patterns_finding(const OpenedMethod& method) {
  const model::Model& model = method.network->model();
  if (method.are_patterns_the_models()) {
    if (!model::serves_any_patterns(model)) return std::nullopt;
    return Finding{"patterns-adapted", Severity::kNote,
                   cat(model.name, " is for any patterns and was adapted to these; its errors are larger than those ",
                       "of a network that was trained for them, above all on physical pixels"),
                   "look at the confidence of the result"};
  }
  if (!are_patterns_stated(method.codes)) return patterns_assumed(model.name);
  if (!method.are_views_of_unstated_patterns) {
    return Finding{"patterns-foreign", Severity::kWarning,
                   cat("the events were made with other patterns than ", model.name,
                       " was trained for, so that the result will be wrong"),
                   "use a model for these patterns, or the inversion"};
  }
  return Finding{
      "patterns-unstated", Severity::kWarning,
      cat(model.name, " does not state which patterns it was trained for, so that it may not match those of ",
          "the events"),
      "use a model that states its patterns"};
}

Findings network_findings(const OpenedMethod& method, const MethodUse& use) {
  Findings findings;
  const recon::Reconstructor& network = *method.network;
  if (auto patterns = patterns_finding(method)) findings.push_back(std::move(*patterns));
  if (!method.takes_sums() && method.camera && method.camera->is_pixel()) {
    findings.push_back(Finding{"pixels-foreign", Severity::kWarning,
                               cat("the events are those of physical pixels (", method.camera->name, "), which ",
                                   network.model().name, " was not trained for: the result will be wrong"),
                               conditioned_network_remedy(method.known_patterns(), method.gives_disparities())}
                           .about("model"));
  }
  if (const size_t made = network.num_passes(use.passes); made < use.passes) {
    findings.push_back({"passes-reduced",
                        Severity::kWarning,
                        cat("the network distinguishes ", made, " position", made == 1 ? "" : "s",
                            " on its pixel grid, so that ", use.passes, " passes are reduced to this number"),
                        "use fewer passes",
                        {{"passes", made}},
                        "passes"});
  }
  return findings;
}

Findings inversion_findings(const OpenedMethod& method) {
  Findings findings;
  if (method.codes->stated_by == StatedBy::kNone) {
    findings.push_back(
        Finding{"patterns-unknown", Severity::kWarning,
                cat("no patterns were given; those of ", method.bundled ? method.bundled->stem().string() : "the paper",
                    " are used, and the camera may have shown others"),
                "state those of the camera"}
            .about("codes"));
  } else if (!are_patterns_stated(method.codes)) {
    findings.push_back(patterns_assumed("the model"));
  }
  if (method.camera && method.camera->is_pixel()) {
    findings.push_back(Finding{"pixels-foreign", Severity::kWarning,
                               cat("the events are those of physical pixels (", method.camera->name, "); the method ",
                                   word_of(method.algorithm, kAlgorithms), " only supports the paper's event model"),
                               conditioned_network_remedy(method.known_patterns(), method.gives_disparities())}
                           .about("model"));
  }
  return findings;
}

}  // namespace

Findings method_findings(const OpenedMethod& method, const MethodUse& use) {
  switch (method.algorithm) {
    case Algorithm::kNetwork:
    case Algorithm::kDepth:
      return network_findings(method, use);
    case Algorithm::kInversion:
      return inversion_findings(method);
  }
  return {};
}

std::optional<Finding> gain_finding(const OpenedMethod& method, float gain) {
  constexpr float kMostGain = 4, kLeastGain = 0.4F;
  if (gain >= kLeastGain && gain <= kMostGain) return std::nullopt;
  // The finding "pixels-foreign" explains it.
  if (method.camera && method.camera->is_pixel() && !method.takes_sums()) return std::nullopt;
  const bool is_of_model = method.camera_stated_by == StatedBy::kNone || method.camera_stated_by == StatedBy::kModel;
  std::string remedy = gain > 1 ? "use more light" : "use less light", option = "gain";
  if (is_of_model && method.takes_sums()) {
    remedy += ", or state the sensor";
    option = "camera";
  } else if (is_of_model && method.network) {
    remedy += cat(", or if the sensor has physical pixels, ",
                  conditioned_network_remedy(method.known_patterns(), method.gives_disparities()));
    option = "model";
  }
  return Finding{"gain-unusual",
                 Severity::kWarning,
                 cat("the light field is well exposed only with a gain of ", formatted("%.2g", gain), ": the scene is ",
                     gain > 1 ? "darker" : "brighter", " than those for which the method was made, or the sensor is ",
                     "another one than ", method.sensor().name.empty() ? "assumed" : method.sensor().name),
                 cat(remedy, ", or set the gain"),
                 {{"gain", gain}},
                 option};
}

std::optional<Finding> contradicted_codes(const StatedCodes& stated) {
  const auto& [caller, events, schedule] = stated;
  const auto differ = [](const std::optional<capture::Codes>& a, const std::optional<capture::Codes>& b) {
    return a && b && *a != *b && capture::whole_cycle(*a) != *b && *a != capture::whole_cycle(*b);
  };
  if (differ(caller, events)) {
    return Finding{"patterns-contradicted", Severity::kWarning,
                   "the patterns that were given differ from those in the file of the events; those that were given "
                   "are used",
                   "omit the patterns, or check which ones the camera showed"}
        .about("codes");
  }
  if (differ(caller ? caller : events, schedule)) {
    return Finding{"patterns-contradicted", Severity::kWarning,
                   cat("the patterns of the schedule differ from those ",
                       caller ? "that were given" : "in the file of the events", ", which are used"),
                   "check which patterns the camera showed"};
  }
  return std::nullopt;
}

}  // namespace e2lf::pipeline
