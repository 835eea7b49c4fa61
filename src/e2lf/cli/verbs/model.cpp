// SPDX-License-Identifier: MIT
// e2lf model info | import | store | export
#include "e2lf/model/model.h"

#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/pipeline/simulated_cycles.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/video/import_event_video.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

int run_model_info(const std::vector<std::string>& arguments) {
  Verb verb("model info", "Describe a model file.", "e2lf model info e2lf-n4");
  fs::path path;
  add_model_option(verb.app(), "model,-m,--model", path, "model file (.safetensors), or a bundled model")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const Description found, describe(FileKind::kModel, path, {}));
    std::printf("%s", (verb.common().json ? json_text(found.json) : found.text()).c_str());
    return {};
  });
}

/// Converts weights to a model file; read() reads them, and write() writes the model.
template <typename Read, typename Write>
Result<void> import_weights(const std::vector<fs::path>& inputs, const fs::path& output, const Verb& verb,
                            const Read& read, const Write& write) {
  E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(output, verb, ".safetensors", inputs));
  RunRecord record(verb, inputs);
  E2LF_ASSIGN_OR_RETURN(const auto model, read());
  E2LF_RETURN_IF_ERROR(write(file.path(), model));
  record.end_step("import");
  if (inputs.size() == 1) record.resolve("as", model.name);
  E2LF_RETURN_IF_ERROR(commit(file, record));
  if (!verb.common().quiet) std::printf("%s: %s\n", output.c_str(), model.name.c_str());
  return {};
}

int run_model_import(const std::vector<std::string>& arguments) {
  Verb verb("model import",
            "Convert the paper's released weights, or a published network that reconstructs frames from events, to a "
            "model file.",
            "e2lf model import --release DIR_WITH_RecNet_AND_AcqNet -o release.safetensors");
  fs::path release, checkpoint, output;
  std::string as;
  CLI::Option* const of_release =
      verb.app().add_option("--release", release, "folder with RecNet.safetensors and AcqNet.safetensors");
  verb.app()
      .add_option("--checkpoint", checkpoint,
                  cat("state dictionary of ", join(video::event_video_names()), ", as a .safetensors file"))
      ->excludes(of_release);
  verb.app()
      .add_option("--as", as, "network of a checkpoint; default: determined by its tensors")
      ->check(CLI::IsMember(video::event_video_names()))
      ->excludes(of_release);
  verb.app().add_option("-o,--output", output, "model file to write")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    if (!checkpoint.empty()) {
      return import_weights(
          {checkpoint}, output, verb, [&] { return video::import_event_video(checkpoint, as); },
          [](const auto& path, const auto& model) { return write_video_model(path, model); });
    }
    if (release.empty()) {
      return fail(ErrorCode::kInvalidValue, "--release", "nothing to import; give --release or --checkpoint");
    }
    // Many users will put the output beside the released weights, so only these are the inputs, not their folder.
    return import_weights(
        {release / "RecNet.safetensors", release / "AcqNet.safetensors"}, output, verb,
        [&] { return model::import_release(release); },
        [](const auto& path, const auto& model) { return write_model(path, model); });
  });
}

/// The flags of the verbs that write a model, and how they write it.
struct RewriteArguments {
  fs::path input, output;
  std::string camera;
};

void add_rewrite_options(Verb& verb, RewriteArguments& arguments, const std::string& output_help,
                         const std::string& camera_use) {
  add_model_option(verb.app(), "model,-m,--model", arguments.input, "model file (.safetensors), or a bundled model")
      ->required();
  verb.app().add_option("-o,--output", arguments.output, output_help)->required();
  add_camera_option(verb.app(), arguments.camera, "networks conditioned on the sensor profile: " + camera_use);
}

/// Reads the model, sets the camera for which it is conditioned if --camera names one, and writes the result of
/// `write(path, model)`. Returns the model.
template <typename Write>
Result<model::Model> rewrite(const RewriteArguments& arguments, const char* step, const char* ending, const Verb& verb,
                             const Write& write) {
  E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(arguments.output, verb, ending));
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(arguments.input));
  E2LF_ASSIGN_OR_RETURN(model, geometry::for_own_patterns(std::move(model)));
  if (!arguments.camera.empty()) {
    if (!model::is_conditioned_on_camera(model)) {
      return fail(ErrorCode::kInvalidValue, "--camera", model.name, " works for a single camera; leave --camera out");
    }
    E2LF_ASSIGN_OR_RETURN(model.camera, load_camera(arguments.camera, record));
  }
  E2LF_RETURN_IF_ERROR(write(file.path(), model));
  record.end_step(step);
  E2LF_RETURN_IF_ERROR(commit(file, record));
  return model;
}

/// Measures what the network loses on the light fields in `paths`: a network for any patterns with the default ones.
Result<model::PrecisionLoss> check_precision(model::Model model, const std::vector<fs::path>& paths, bool is_quiet) {
  if (model::is_for_any_patterns(model) && !model.codes) {
    E2LF_ASSIGN_OR_RETURN(const capture::Codes patterns, pipeline::usual_patterns());
    E2LF_ASSIGN_OR_RETURN(model, geometry::for_patterns(model, patterns));
  }
  std::vector<lightfield::LightField> scenes;
  for (const fs::path& path : paths) {
    E2LF_ASSIGN_OR_RETURN(lightfield::LightField scene,
                          load_scene(path, {.views_y = model.views_y, .views_x = model.views_x}, is_quiet));
    scenes.push_back(std::move(scene));
  }
  return pipeline::measure_precision_loss(model, scenes);
}

int run_model_store(const std::vector<std::string>& arguments) {
  Verb verb(
      "model store",
      "Store a model with weights of 16 bits, which halves its size with relative errors of 2^-8 at most; and with "
      "another default camera, for other patterns, or with what it loses in faster arithmetic.",
      "e2lf model store MODEL.safetensors -o SMALL.safetensors");
  RewriteArguments rewriting;
  fs::path codes;
  std::vector<fs::path> scenes;
  add_rewrite_options(verb, rewriting, "model file to write", "the camera to use if `reconstruct` names none");
  add_codes_option(verb.app(), codes, "aperture patterns to which a network for any patterns is adapted");
  verb.app().add_option("--check", scenes,
                        "light fields on which to measure what bfloat16 and int16 lose, so that --precision auto may "
                        "use them; for any patterns: with those of e2lf-n4");
  return verb.run(arguments, [&]() -> Result<void> {
    const auto write = [&](const fs::path& path, model::Model model) -> Result<void> {
      if (!codes.empty()) {
        E2LF_ASSIGN_OR_RETURN(const capture::Codes patterns, pipeline::read_patterns(codes));
        E2LF_ASSIGN_OR_RETURN(model, geometry::for_patterns(model, patterns));
      }
      if (!scenes.empty()) {
        E2LF_ASSIGN_OR_RETURN(model.precision_loss, check_precision(model, scenes, verb.common().quiet));
      }
      return model::write_model(path, model, model::WeightStorage::kBfloat16);
    };
    E2LF_RETURN_IF_ERROR(rewrite(rewriting, "store", ".safetensors", verb, write));
    return {};
  });
}

/// Returns the inputs and outputs of an exported file, for --json.
Json export_summary(const model::Model& model) {
  Json summary = Json::object();
  for (const auto& [key, value] : model::onnx_metadata(model)) {
    const Json parsed = Json::parse(value, nullptr, /*allow_exceptions=*/false);
    const bool is_json = key != "name" && (parsed.is_structured() || parsed.is_number());
    summary[key] = is_json ? parsed : Json(value);
  }
  return summary;
}

Result<void> export_model(const RewriteArguments& arguments, const Verb& verb) {
  const fs::path& output = arguments.output;
  if (output.extension() != ".onnx") {
    return fail(ErrorCode::kUnsupported, output, "models are exported as ONNX; use the extension .onnx");
  }
  E2LF_ASSIGN_OR_RETURN(
      const model::Model model,
      rewrite(arguments, "export", ".onnx", verb, [](const fs::path& path, const model::Model& model) -> Result<void> {
        E2LF_ASSIGN_OR_RETURN(const std::string bytes, model::onnx_file(model));
        return write_file(path, bytes);
      }));
  const std::string result = model::is_depth_network(model)
                                 ? cat("disparity [batch, ", model::kDepthOutputs, ", y, x]")
                                 : cat("views [batch, ", model.views_y * model.views_x, ", y, x]");
  print_result(verb.common(), export_summary(model),
               cat(output.string(), " takes events [batch, ", model.num_patterns - 1, ", y, x]",
                   model::is_conditioned_on_camera(model) ? ", traits" : "", " and returns ", result, "\n"));
  return {};
}

int run_model_export(const std::vector<std::string>& arguments) {
  Verb verb("model export",
            "Export a model as ONNX for other programs, with event images as input and views or a disparity as output.",
            "e2lf model export e2lf-n4 -o e2lf-n4.onnx");
  RewriteArguments exporting;
  add_rewrite_options(verb, exporting, "file to write (.onnx)", "the camera that records the events");
  return verb.run(arguments, [&] { return export_model(exporting, verb); });
}

}  // namespace

int run_model(const std::vector<std::string>& arguments) {
  return run_subverb("model",
                     {{"info", "describe a model file", run_model_info},
                      {"import", "convert released weights to a model file", run_model_import},
                      {"store", "store a model with weights of 16 bits, or another camera", run_model_store},
                      {"export", "export a model as ONNX, for other programs", run_model_export}},
                     arguments);
}

}  // namespace e2lf::cli
