// SPDX-License-Identifier: MIT
// e2lf model info | import | store | export
#include "e2lf/model/model.h"

#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/camera_option.h"
#include "e2lf/cli/flags/model_option.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "e2lf/model/summary.h"
#include "e2lf/model/video/import_event_video.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

template <typename AnyModel>
void print_model(const AnyModel& model, const Verb& verb) {
  const std::string text = verb.common().json ? json_text(model::summary_json(model)) : model::summary_text(model);
  std::printf("%s", text.c_str());
}

int run_model_info(const std::vector<std::string>& arguments) {
  Verb verb("model info", "Describe a model file.", "e2lf model info e2lf-n4");
  fs::path path;
  add_model_option(verb.app(), "model,-m,--model", path, "model file (.safetensors), or a bundled model")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const bool is_video, model::is_video_model(path));
    if (is_video) {
      E2LF_ASSIGN_OR_RETURN(const model::VideoModel model, model::read_video_model(path));
      print_model(model, verb);
      return {};
    }
    E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
    print_model(model, verb);
    return {};
  });
}

Result<void> import_checkpoint(const fs::path& checkpoint, const std::string& as, const fs::path& output,
                               const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(output, {.inputs = {checkpoint},
                                                                     .overwrite = verb.common().overwrite,
                                                                     .ending = ".safetensors"}));
  RunRecord record("model import");
  record.add_input(checkpoint);
  E2LF_ASSIGN_OR_RETURN(const model::VideoModel model, model::import_event_video(checkpoint, as));
  E2LF_RETURN_IF_ERROR(model::write_video_model(file.path(), model));
  record.end_step("import");
  record.resolve("as", model.name);
  E2LF_RETURN_IF_ERROR(record.write(file.record_path(), verb));
  E2LF_RETURN_IF_ERROR(file.commit());
  if (!verb.common().quiet) std::printf("%s: %s", output.c_str(), model::summary_text(model).c_str());
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
                  cat("state dictionary of ", join(model::event_video_names()), ", as a .safetensors file"))
      ->excludes(of_release);
  verb.app()
      .add_option("--as", as, "network of a checkpoint; default: determined by its tensors")
      ->check(CLI::IsMember(model::event_video_names()))
      ->excludes(of_release);
  verb.app().add_option("-o,--output", output, "model file to write")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    if (!checkpoint.empty()) return import_checkpoint(checkpoint, as, output, verb);
    if (release.empty()) {
      return Error{ErrorCode::kInvalidValue, "nothing to import; give --release or --checkpoint", "--release"};
    }
    // Many users will put the output beside the released weights, so only these are the inputs, not their folder.
    E2LF_ASSIGN_OR_RETURN(
        OutputFile file,
        OutputFile::create(output, {.inputs = {release / "RecNet.safetensors", release / "AcqNet.safetensors"},
                                    .overwrite = verb.common().overwrite,
                                    .ending = ".safetensors"}));
    RunRecord record("model import");
    for (const char* name : {"RecNet.safetensors", "AcqNet.safetensors"}) record.add_input(release / name);
    E2LF_ASSIGN_OR_RETURN(const model::Model model, model::import_release(release));
    E2LF_RETURN_IF_ERROR(model::write_model(file.path(), model));
    record.end_step("import");
    E2LF_RETURN_IF_ERROR(record.write(file.record_path(), verb));
    E2LF_RETURN_IF_ERROR(file.commit());
    if (!verb.common().quiet) std::printf("%s: %s", output.c_str(), model::summary_text(model).c_str());
    return {};
  });
}

/// Sets the camera of a network that is conditioned on the sensor profile to that of --camera; "" leaves it unchanged.
Result<void> set_camera(const std::string& camera, model::Model& model, RunRecord& record) {
  if (camera.empty()) return {};
  if (!model::is_told_the_camera(model)) {
    return Error{ErrorCode::kInvalidValue, cat(model.name, " works for a single camera; leave --camera out"),
                 "--camera"};
  }
  E2LF_ASSIGN_OR_RETURN(model.camera, load_camera(camera, record));
  return {};
}

int run_model_store(const std::vector<std::string>& arguments) {
  Verb verb("model store", "Store a model with weights of 16 or 32 bits, or with another default camera.",
            "e2lf model store MODEL.safetensors -o SMALL.safetensors --weights bfloat16");
  fs::path input, output;
  std::string weights = "bfloat16", camera;
  add_model_option(verb.app(), "model,-m,--model", input, "model file (.safetensors), or a bundled model")->required();
  verb.app().add_option("-o,--output", output, "model file to write")->required();
  verb.app()
      .add_option("--weights", weights, "bfloat16 (half the size, relative errors of 2^-8 at most) or float32")
      ->check(CLI::IsMember({"bfloat16", "float32"}))
      ->capture_default_str();
  add_camera_option(verb.app(), camera,
                    "networks conditioned on the sensor profile: the camera to use if `reconstruct` names none");
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(output, {.inputs = {input, camera},
                                                                       .overwrite = verb.common().overwrite,
                                                                       .ending = ".safetensors"}));
    RunRecord record("model store");
    record.add_input(input);
    E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(input));
    E2LF_RETURN_IF_ERROR(set_camera(camera, model, record));
    const bool is_half = weights == "bfloat16";
    E2LF_RETURN_IF_ERROR(model::write_model(
        file.path(), model, is_half ? model::WeightStorage::kBfloat16 : model::WeightStorage::kFloat32));
    record.end_step("store");
    E2LF_RETURN_IF_ERROR(record.write(file.record_path(), verb));
    return file.commit();
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

Result<void> export_model(const fs::path& input, const fs::path& output, const std::string& camera, const Verb& verb) {
  if (output.extension() != ".onnx") {
    return Error{ErrorCode::kUnsupported, "models are exported as ONNX; name the output with .onnx", output.string()};
  }
  E2LF_ASSIGN_OR_RETURN(
      OutputFile file,
      OutputFile::create(output, {.inputs = {input, camera}, .overwrite = verb.common().overwrite, .ending = ".onnx"}));
  RunRecord record("model export");
  record.add_input(input);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(input));
  E2LF_RETURN_IF_ERROR(set_camera(camera, model, record));
  E2LF_ASSIGN_OR_RETURN(const std::string bytes, model::onnx_file(model));
  E2LF_RETURN_IF_ERROR(write_file(file.path(), bytes));
  record.end_step("export");
  E2LF_RETURN_IF_ERROR(record.write(file.record_path(), verb));
  E2LF_RETURN_IF_ERROR(file.commit());
  if (verb.common().json) {
    std::printf("%s", json_text(export_summary(model)).c_str());
  } else if (!verb.common().quiet) {
    std::printf("%s takes events [batch, %zu, y, x]%s and returns views [batch, %zu, y, x]\n", output.c_str(),
                model.num_patterns - 1, model::is_told_the_camera(model) ? ", traits" : "",
                model.views_y * model.views_x);
  }
  return {};
}

int run_model_export(const std::vector<std::string>& arguments) {
  Verb verb("model export",
            "Export a model as ONNX for other programs, with event images as input and views as output.",
            "e2lf model export e2lf-n4 -o e2lf-n4.onnx");
  fs::path input, output;
  std::string camera;
  add_model_option(verb.app(), "model,-m,--model", input, "model file (.safetensors), or a bundled model")->required();
  verb.app().add_option("-o,--output", output, "file to write (.onnx)")->required();
  add_camera_option(verb.app(), camera,
                    "networks conditioned on the sensor profile: the camera that records the events");
  return verb.run(arguments, [&] { return export_model(input, output, camera, verb); });
}

}  // namespace

int run_model(const std::vector<std::string>& arguments) {
  return run_subverb("model",
                     {{"info", "describe a model file", run_model_info},
                      {"import", "convert released weights to a model file", run_model_import},
                      {"store", "store a model with weights of 16 or 32 bits, or another camera", run_model_store},
                      {"export", "export a model as ONNX, for other programs", run_model_export}},
                     arguments);
}

}  // namespace e2lf::cli
