// SPDX-License-Identifier: MIT
// e2lf demo: renders a procedural scene, simulates its events and reconstructs its light field
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/npy.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/pipeline/simulated_cycles.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;
namespace {

/// The best bundled network for static scenes.
constexpr const char* kModel = "models/e2lf-n8.safetensors";

struct DemoArguments {
  fs::path output = "out/demo", model;
  size_t width = 512, height = 384;
};

/// Opens the network of the given or bundled model, or the closed form with the built-in patterns if there is none.
Result<pipeline::OpenedMethod> open_method(const std::optional<fs::path>& path, RunRecord& record) {
  if (!path)
    return pipeline::open_method({.algorithm = pipeline::Algorithm::kInversion, .codes = capture::default_codes()});
  record.add_input(*path);
  pipeline::MethodChoice choice;
  E2LF_ASSIGN_OR_RETURN(choice.model, model::read_model(*path));
  if (choice.model->codes) return pipeline::open_method(std::move(choice));
  return fail(ErrorCode::kNotFound, path->string(),
              "the model contains no aperture patterns, which the camera of the demo needs; give a model that does");
}

Result<void> write_refocused(const fs::path& folder, const LightField& light_field) {
  const lightfield::Aperture open = lightfield::full_aperture(light_field.shape());
  E2LF_RETURN_IF_ERROR(
      lightfield::write_png(folder / "refocus_near.png", lightfield::refocus(light_field, -1.0F, open)));
  return lightfield::write_png(folder / "refocus_far.png", lightfield::refocus(light_field, 1.2F, open));
}

std::string result_text(const DemoArguments& arguments, const pipeline::OpenedMethod& method,
                        const eval::EvalRow& row) {
  return cat("method: ",
             method.network ? "network " + method.network->model().name
                            : "closed-form inversion (no trained model is bundled)",
             "\n", report::table_text(eval::quality_table({&row, 1})), "\nin ", arguments.output.string(), ":\n",
             kHasViewer ? "  index.html         open it in a browser: the scene beside its reconstruction, parallax, "
                          "refocusing, EPI\n"
                        : "",
             "  scene/             the true light field, 8x8 views, and its disparities\n"
             "  events.npz         what the camera records of it (look at events.png)\n"
             "  recon/             the reconstructed light field: views, contact_sheet.png, epi.png\n"
             "  refocus_near.png   the reconstruction focused on the front; refocus_far.png: on the back\n");
}

Result<void> demo(const DemoArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  const auto model = arguments.model.empty() ? bundled_file(kModel) : arguments.model;
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, verb, {model.value_or("")}));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const pipeline::OpenedMethod method, open_method(model, record));
  E2LF_ASSIGN_OR_RETURN(const recon::Method reconstruct, method.ready());
  const lightfield::Shape shape{8, 8, arguments.height, arguments.width, 1};
  const LightField scene = lightfield::render_light_field(lightfield::demo_scene(common.seed), shape);
  const lightfield::Image disparity =
      lightfield::render_disparity(lightfield::demo_scene(common.seed), {shape.height, shape.width, 0.5F, 0.5F});
  record.end_step("render");

  pipeline::SimulatedCamera camera{.codes = method.codes->codes, .seed = common.seed};
  camera.profile = method.sensor();
  if (!camera.profile.is_pixel()) {
    camera.profile.event_model = method.codes->event_model;
    camera.profile.constants = method.codes->constants;
  }
  E2LF_ASSIGN_OR_RETURN(const capture::Measurement measured, pipeline::simulate_cycle(camera, scene, 0));
  const capture::EventImages& images = measured.events;
  record.end_step("simulate");

  LightField light_field;
  {
    ProgressBar bar("reconstruct", common.quiet);
    E2LF_ASSIGN_OR_RETURN(light_field, reconstruct(measured, bar.callback()));
  }
  record.end_step("reconstruct");
  eval::EvalRow row{method.network ? method.network->model().name : word_of(method.algorithm, pipeline::kAlgorithms),
                    "demo scene",
                    {},
                    {}};
  E2LF_ASSIGN_OR_RETURN(row.quality, eval::compare(scene, light_field));
  row.events = eval::event_statistics(images);
  lightfield::Image found;
  if (depth::has_comparable_disparity(shape)) {
    ProgressBar bar("depth", common.quiet);
    E2LF_ASSIGN_OR_RETURN(depth::FoundDisparity judged, depth::judge_disparity(light_field, disparity, bar.callback()));
    found = std::move(judged.disparity);
    row.disparity = std::move(judged.error);
  }
  record.end_step("evaluate");

  const fs::path& folder = output.path();
  std::error_code ignored;
  fs::create_directory(folder / "scene", ignored);
  E2LF_RETURN_IF_ERROR(lightfield::write_views(folder / "scene", scene, lightfield::LightFieldFormat::kPng8));
  E2LF_RETURN_IF_ERROR(write_npy(folder / "scene" / "gt_disparity.npy",
                                 make_npy<float>({disparity.height, disparity.width}, disparity.pixels)));
  E2LF_RETURN_IF_ERROR(
      capture::write_event_images(folder / "events.npz", {{images}, {camera.codes, camera.profile, {}}}));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / "events.png", event_picture(images)));
  fs::create_directory(folder / "recon", ignored);
  E2LF_RETURN_IF_ERROR(write_reconstruction(folder / "recon", light_field, "png", {}, {}));
  E2LF_RETURN_IF_ERROR(write_refocused(folder, light_field));
  if (kHasViewer) {
    E2LF_RETURN_IF_ERROR(
        write_comparison_page(folder / "index.html", {scene, disparity}, {light_field, found}, row.disparity));
  }
  record.end_step("write");
  record.note("quality", eval::to_json(row));
  E2LF_RETURN_IF_ERROR(commit(output, record));
  print_result(common, eval::to_json(row), result_text(arguments, method, row));
  return {};
}

}  // namespace

int run_demo(const std::vector<std::string>& arguments) {
  Verb verb("demo", "Render a scene, simulate the events of a coded-aperture camera, reconstruct the light field.",
            "e2lf demo -o out/demo --overwrite");
  DemoArguments demo_arguments;
  CLI::App& app = verb.app();
  app.add_option("-o,--output", demo_arguments.output, "folder to write")->capture_default_str();
  add_model_option(app, "-m,--model", demo_arguments.model, "model file or bundled model; default: e2lf-n8");
  add_count(app, "--width", demo_arguments.width, 16, 8192, "width of each view, px");
  add_count(app, "--height", demo_arguments.height, 16, 8192, "height of each view, px");
  return verb.run(arguments, [&] { return demo(demo_arguments, verb); });
}

}  // namespace e2lf::cli
