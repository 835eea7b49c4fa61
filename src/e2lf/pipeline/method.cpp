// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/method.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/model/model.h"
#include "e2lf/pipeline/catalogue.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::pipeline {
namespace fs = std::filesystem;
using diagnose::Finding;
using diagnose::Findings;
using diagnose::Severity;
namespace {

/// The operation of networks whose views follow a geometry.
constexpr const char* kRenderLayers = "render-layers";

bool follows_geometry(const model::Model& model) {
  return std::ranges::any_of(model.network.layers, [](const model::Layer& layer) { return layer.op == kRenderLayers; });
}

/// Chooses the bundled network for the patterns. Events of an unknown sensor are those of a camera, for which the
/// network of physical pixels with its default profile is closer than that of the paper's event model.
Result<std::optional<BundledModel>> network_for(ModelNeeds needs, const std::optional<capture::SensorProfile>& camera) {
  const bool is_paper = camera && !camera->is_pixel();
  needs.is_conditioned = needs.is_conditioned || !is_paper;
  E2LF_ASSIGN_OR_RETURN(std::optional<BundledModel> network, choose_bundled_model(needs));
  if (network || !needs.is_conditioned || (camera && !is_paper)) return network;
  needs.is_conditioned = false;
  return choose_bundled_model(needs);
}

/// Says which property of the patterns no bundled network admits.
Error no_network_error(const capture::Codes& codes, Algorithm algorithm) {
  if (!capture::is_black_first(codes)) {
    return {ErrorCode::kNotFound,
            "no bundled network is for patterns that do not begin with black; show black first, or give a network "
            "that was trained for these patterns",
            "", "codes"};
  }
  if (algorithm == Algorithm::kNetwork && capture::codes_of_whole_cycle(codes)) {
    return {ErrorCode::kNotFound,
            "no bundled network of views is for the whole cycle of these patterns; use the lit transitions alone, or "
            "the inversion",
            "", "transitions"};
  }
  const char* const remedy = algorithm == Algorithm::kNetwork ? ", or use the inversion" : "";
  constexpr size_t kViews = 8;
  if (codes.views_y > kViews || codes.views_x > kViews) {
    return {ErrorCode::kNotFound,
            cat("no bundled network is for patterns of ", codes.views_y, "x", codes.views_x,
                " cells; show patterns of at most 8x8", remedy),
            "", "codes"};
  }
  return {ErrorCode::kNotFound, cat("no bundled network was trained for these patterns; give one that was", remedy),
          ""};
}

/// Selects the bundled network that was trained for the patterns, if none is given.
Result<void> choose_network(MethodChoice& choice, const OpenedMethod& opened, std::optional<fs::path>& path) {
  if (choice.model) return {};
  const auto known = known_codes(choice.codes, choice.events.codes, nullptr);
  if (!known) {
    return fail(ErrorCode::kInvalidValue, "",
                "the patterns that the camera showed are unknown; give them, or the model that was trained for "
                "them")
        .about("codes");
  }
  E2LF_ASSIGN_OR_RETURN(std::optional<BundledModel> network,
                        network_for({.codes = known->codes,
                                     .gives_disparity = choice.algorithm == Algorithm::kDepth,
                                     .is_conditioned = choice.prefers_conditioned,
                                     .is_fast = choice.prefers_fast},
                                    opened.camera));
  if (!network && bundled_names(kBundledModels).empty()) {
    return fail(ErrorCode::kNotFound, "",
                "the models of e2lf were not found; name their folder in the environment variable E2LF_MODELS, or give "
                "a model");
  }
  if (!network) return no_network_error(known->codes, choice.algorithm);
  path = std::move(network->path);
  choice.model = std::move(network->model);
  return {};
}

/// Adapts a network for any patterns to those of the events, if they are known and others than its own.
Result<void> adapt_to_patterns(const MethodChoice& choice, model::Model& model) {
  if (!model::is_for_any_patterns(model)) return {};
  const auto known = known_codes(choice.codes, choice.events.codes, nullptr);
  if (!known && !model.codes) {
    return fail(ErrorCode::kInvalidValue, "", model.name,
                " is adapted to the patterns that the camera showed, which are unknown; give them")
        .about("codes");
  }
  const capture::Codes codes = known ? known->codes : *model.codes;
  if (codes == model.codes && !model.open_guide) return {};
  E2LF_ASSIGN_OR_RETURN(model, geometry::for_patterns(model, codes));
  return {};
}

/// Opens the bundled network of the lit transitions, if the network takes those of the whole cycle and there is one.
Result<void> open_lit(const engine::EngineOptions& options, OpenedMethod& opened) {
  const auto& codes = opened.network->model().codes;
  const auto shown = codes ? capture::codes_of_whole_cycle(*codes) : std::nullopt;
  if (!shown) return {};
  E2LF_ASSIGN_OR_RETURN(
      std::optional<BundledModel> network,
      network_for({.codes = *shown, .may_be_guided = follows_geometry(opened.network->model())}, opened.camera));
  if (!network) return {};
  if (network->model.codes != shown) {
    E2LF_ASSIGN_OR_RETURN(network->model, geometry::for_patterns(network->model, *shown));
  }
  if (model::is_conditioned_on_camera(network->model) && opened.camera) network->model.camera = opened.camera;
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor lit, recon::Reconstructor::create(std::move(network->model), options));
  opened.lit = std::make_shared<const recon::Reconstructor>(std::move(lit));
  return {};
}

/// Fails if the network takes another measurement, or another number of event images than there are.
Result<void> check_input(const MethodChoice& choice, const model::Model& model) {
  if (model.measurement() != choice.measurement) {
    return fail(ErrorCode::kInvalidValue, "", "this is the measurement ", capture::measurement_name(choice.measurement),
                ", and ", model.name, " takes ", capture::measurement_name(model.measurement()),
                "; use a model that takes it")
        .about("model");
  }
  const size_t transitions = choice.transitions;
  if (transitions == 0 || !capture::has_events(model.measurement())) return {};
  if (transitions + 1 == model.num_patterns) return {};
  const auto shown = model.codes ? capture::codes_of_whole_cycle(*model.codes) : std::nullopt;
  const bool has_lit_ones = shown && transitions + 1 == shown->num_patterns;
  if (!has_lit_ones && choice.codes && choice.codes->num_patterns == model.num_patterns) {
    return fail(ErrorCode::kShape, "", "there are ", transitions, " event images, and the patterns that were given ",
                "make ", model.num_patterns - 1, "; give those that the camera showed")
        .about("codes");
  }
  return fail(ErrorCode::kShape, "", "there are ", has_lit_ones ? "only the " : "", transitions, " event images",
              has_lit_ones ? " of the active patterns" : "", ", and ", model.name, " takes ", model.num_patterns - 1,
              has_lit_ones ? " of all transitions of the cycle; accumulate the recording with all transitions"
                           : "; use the model that belongs to the patterns of the recording")
      .about(has_lit_ones ? "transitions" : "model");
}

Result<void> check_output(Algorithm algorithm, const model::Model& model) {
  const bool is_depth = model::is_depth_network(model);
  if (is_depth == (algorithm == Algorithm::kDepth)) return {};
  return fail(ErrorCode::kUnsupported, "", model.name,
              is_depth ? " gives disparities and no light field; use `e2lf depth`, or another model"
                       : " gives light fields and no disparities; give a depth network, or estimate "
                         "the depth of its light fields");
}

Result<void> open_network(MethodChoice& choice, OpenedMethod& opened) {
  E2LF_RETURN_IF_ERROR(choose_network(choice, opened, opened.bundled));
  model::Model& model = *choice.model;
  E2LF_RETURN_IF_ERROR(check_output(choice.algorithm, model));
  opened.are_views_of_unstated_patterns = !model.codes && !model::reads_moved_pictures(model);
  E2LF_RETURN_IF_ERROR(adapt_to_patterns(choice, model));
  E2LF_RETURN_IF_ERROR(check_input(choice, model));
  opened.codes = known_codes(choice.codes, choice.events.codes, &model);
  const bool is_conditioned = model::is_conditioned_on_camera(model);
  if (!is_conditioned && choice.camera) {
    return fail(ErrorCode::kInvalidValue, "", model.name, " was trained for a single camera; omit the camera")
        .about("camera");
  }
  const bool has_pixels = is_conditioned && model.camera && model.camera->is_pixel();
  if (has_pixels && choice.camera && capture::to_json(*model.camera) != capture::to_json(*choice.camera)) {
    opened.models_camera = model.camera;
  }
  if (is_conditioned && opened.camera) {
    model.camera = opened.camera;
  } else if (is_conditioned && model.camera) {
    opened.camera = model.camera;
    opened.camera_stated_by = StatedBy::kModel;
  }
  E2LF_ASSIGN_OR_RETURN(const engine::Precision precision,
                        choice_of(choice.precision, engine::kPrecisions, "precision"));
  const engine::EngineOptions options{.precision = precision, .device = choice.device};
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor network, recon::Reconstructor::create(std::move(model), options));
  opened.network = std::make_shared<const recon::Reconstructor>(std::move(network));
  if (choice.lit_where_moving) E2LF_RETURN_IF_ERROR(open_lit(options, opened));
  return {};
}

Result<void> open_inversion(const MethodChoice& choice, OpenedMethod& opened) {
  opened.codes = known_codes(choice.codes, choice.events.codes, choice.model ? &*choice.model : nullptr);
  if (!opened.codes && choice.model) {
    return Error{ErrorCode::kNotFound, "the model contains no aperture patterns; give those of the camera",
                 choice.model->name, "codes"};
  }
  if (!opened.codes) {
    opened.codes.emplace();
    E2LF_ASSIGN_OR_RETURN(opened.codes->codes, usual_patterns());
    opened.bundled = bundled_model();
  }
  if (choice.constants) opened.codes->constants = *choice.constants;
  return {};
}

/// Returns the patterns between which a reader with this schedule forms event images.
std::optional<capture::Codes> reduced(const std::optional<capture::Codes>& codes, const cycles::Schedule* schedule) {
  return codes && schedule != nullptr ? cycles::codes_of_images(*codes, *schedule).value_or(*codes) : codes;
}

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
                   method.gives_disparities() ? "use a network for these patterns"
                                              : "use a network for these patterns, or the inversion"};
  }
  return Finding{
      "patterns-unstated", Severity::kWarning,
      cat(model.name, " does not state which patterns it was trained for, so that it may not match those of ",
          "the events"),
      "use a model that states its patterns"};
}

void add_network_findings(const OpenedMethod& method, Findings& findings) {
  const recon::Reconstructor& network = *method.network;
  if (auto patterns = patterns_finding(method)) findings.push_back(std::move(*patterns));
  if (!method.takes_sums() && method.camera && method.camera->is_pixel()) {
    findings.push_back(Finding{"pixels-foreign", Severity::kWarning,
                               cat("the events are those of physical pixels (", method.camera->name, "), which ",
                                   network.model().name, " was not trained for: the result will be wrong"),
                               conditioned_network_remedy(method.known_patterns(), method.gives_disparities())}
                           .about("model"));
  }
  if (const size_t made = network.num_passes(method.use.passes); made < method.use.passes) {
    findings.push_back({"passes-reduced",
                        Severity::kWarning,
                        cat("the network distinguishes ", made, " position", made == 1 ? "" : "s",
                            " on its pixel grid, so that ", method.use.passes, " passes are reduced to this number"),
                        "use fewer passes",
                        {{"passes", made}},
                        "passes"});
  }
}

void add_inversion_findings(const OpenedMethod& method, Findings& findings) {
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
}

}  // namespace

Result<model::Model> read_network(const fs::path& path) {
  return is_folder(path) ? model::import_release(path) : model::read_model(path);
}

std::optional<Finding> contradicted_codes(const MethodChoice& choice) {
  const auto differ = [](const std::optional<capture::Codes>& a, const std::optional<capture::Codes>& b) {
    return a && b && *a != *b && capture::whole_cycle(*a) != *b && *a != capture::whole_cycle(*b);
  };
  if (differ(choice.codes, choice.events.codes)) {
    return Finding{"patterns-contradicted", Severity::kWarning,
                   "the patterns that were given differ from those in the file of the events; those that were given "
                   "are used",
                   "omit the patterns, or check which ones the camera showed"}
        .about("codes");
  }
  if (differ(choice.codes ? choice.codes : choice.events.codes,
             reduced(choice.schedule ? choice.schedule->codes : std::nullopt, choice.schedule))) {
    return Finding{"patterns-contradicted", Severity::kWarning,
                   cat("the patterns of the schedule differ from those ",
                       choice.codes ? "that were given" : "in the file of the events", ", which are used"),
                   "check which patterns the camera showed"};
  }
  return std::nullopt;
}

Result<OpenedMethod> open_method(MethodChoice choice) {
  if (choice.measurement != capture::MeasurementKind::kEventImages &&
      (choice.algorithm == Algorithm::kInversion || !choice.model)) {
    return fail(ErrorCode::kInvalidValue, "", "this is the measurement ", capture::measurement_name(choice.measurement),
                "; give a network that was trained for it");
  }
  choice.codes = reduced(choice.codes, choice.schedule);
  // The patterns a1 to aN also stand for those of their whole cycle.
  for (std::optional<capture::Codes>* codes : {&choice.codes, &choice.events.codes}) {
    if (*codes && choice.transitions == 2 * (*codes)->num_patterns) *codes = capture::whole_cycle(**codes);
  }
  OpenedMethod opened;
  opened.algorithm = choice.algorithm;
  opened.use = choice.use;
  opened.camera = choice.camera ? choice.camera : choice.events.camera;
  if (opened.camera) opened.camera_stated_by = choice.camera ? StatedBy::kCaller : StatedBy::kEvents;
  opened.views = choice.camera && choice.camera->views ? choice.camera->views : choice.events.views;
  opened.findings = diagnose::findings_from_text(choice.events.findings);
  opened.is_confirmed = !diagnose::has_doubt(opened.findings);
  if (auto contradicted = contradicted_codes(choice)) opened.findings.push_back(std::move(*contradicted));
  switch (choice.algorithm) {
    case Algorithm::kNetwork:
    case Algorithm::kDepth:
      E2LF_RETURN_IF_ERROR(open_network(choice, opened));
      break;
    case Algorithm::kInversion:
      E2LF_RETURN_IF_ERROR(open_inversion(choice, opened));
      break;
  }
  E2LF_RETURN_IF_ERROR(opened.ready(opened.use));
  opened.network ? add_network_findings(opened, opened.findings) : add_inversion_findings(opened, opened.findings);
  return opened;
}

capture::SensorProfile OpenedMethod::sensor() const {
  if (camera) return *camera;
  return network ? network->model().camera.value_or(capture::SensorProfile()) : capture::SensorProfile();
}

bool OpenedMethod::are_patterns_the_models() const {
  return network && !are_views_of_unstated_patterns && are_patterns_stated(codes) && network->model().codes &&
         *network->model().codes == codes->codes;
}

capture::RecordedSetup OpenedMethod::known_setup() const {
  capture::RecordedSetup setup{.codes = known_patterns(), .camera = camera};
  if (!camera && sensor().is_pixel()) setup.camera = sensor();
  return setup;
}

std::optional<capture::Codes> OpenedMethod::known_patterns() const {
  if (codes) return codes->codes;
  return std::nullopt;
}

Tone OpenedMethod::complete(Tone tone) const {
  const bool is_pixel = camera && camera->is_pixel();
  if (!tone.black && (tone.gain || !is_pixel)) tone.black = 0.0F;
  return tone;
}

Result<recon::Method> OpenedMethod::ready(const MethodUse& wanted) const {
  if (!network && wanted.passes > 1) {
    return fail(ErrorCode::kInvalidValue, "", "the method ", word_of(algorithm, kAlgorithms),
                " supports a single pass; omit the number of passes")
        .about("passes");
  }
  if ((wanted.cycles > 1 || wanted.fused_cycles > 1) && !takes_sums()) {
    return fail(ErrorCode::kInvalidValue, "",
                network ? cat(network->model().name,
                              gives_disparities() ? " estimates each map" : " reconstructs each light field",
                              " from one cycle; omit the number of cycles, or ",
                              conditioned_network_remedy(known_patterns(), gives_disparities()))
                        : cat("the method ", word_of(algorithm, kAlgorithms),
                              " reconstructs each light field from one cycle; omit the number of cycles"))
        .about(wanted.cycles > 1 ? "cycles_per_field" : "fuse");
  }
  if (network) return method_of(network, wanted);
  return recon::Method([known = *codes](const capture::MeasurementView& measured, const ProgressFn&) {
    return recon::reconstruct_by_inversion(owned(measured.events), known.codes, known.constants);
  });
}

recon::Method method_of(std::shared_ptr<const recon::Reconstructor> network, const MethodUse& use) {
  return [network = std::move(network), use](const capture::MeasurementView& measured, const ProgressFn& progress) {
    return network->reconstruct(measured, progress, use.passes, use.cycles);
  };
}

Result<FieldSequence> open_sequence(const OpenedMethod& method, Tone tone) {
  const MethodUse& use = method.use;
  E2LF_ASSIGN_OR_RETURN(recon::Method ready, method.ready(use));
  std::optional<recon::Method> lit;
  if (method.lit && (use.cycles == 1 || model::is_conditioned_on_camera(method.lit->model()))) {
    lit = method_of(method.lit, use);
  }
  return FieldSequence(std::move(ready), method.complete(tone), use.cycles, std::move(lit));
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

}  // namespace e2lf::pipeline
