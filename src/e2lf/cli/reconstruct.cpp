// SPDX-License-Identifier: MIT
// e2lf reconstruct: event images or a recording -> light field
#include "e2lf/recon/reconstruct.h"

#include <cstdio>

#include "e2lf/aperture/codes_io.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/inputs.h"
#include "e2lf/cli/light_field_output.h"
#include "e2lf/cli/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/events/event_images.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/linear_estimate.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;
namespace {

struct ReconstructArguments {
  fs::path input, output;
  CodesSource codes;
  std::string method = "network", precision = "auto", gain = "auto", format = "png";
};

/// One way from the event images of a cycle to a light field.
using Method = std::function<Result<LightField>(const events::EventImages& images, const ProgressFn& progress)>;

Result<Method> network_method(const ReconstructArguments& arguments, RunRecord& record) {
  if (arguments.codes.model.empty()) {
    return Error{ErrorCode::kInvalidValue, "the network needs a model; give one with -m, or use --method inversion",
                 "--model"};
  }
  record.add_input(arguments.codes.model);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(arguments.codes.model));
  E2LF_ASSIGN_OR_RETURN(const engine::Precision precision, engine::precision_from_name(arguments.precision));
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor made,
                        recon::Reconstructor::create(std::move(model), {.precision = precision}));
  const auto reconstructor = std::make_shared<recon::Reconstructor>(std::move(made));
  record.note("precision", engine::precision_name(reconstructor->engine().precision()));
  return Method([reconstructor](const events::EventImages& images, const ProgressFn& progress) {
    return reconstructor->reconstruct(images, progress);
  });
}

/// The codes come from --codes or the model, else from the event images' file.
Result<Method> inversion_method(const ReconstructArguments& arguments, const events::EventImageFile& file,
                                RunRecord& record) {
  KnownCodes known;
  if (arguments.codes.codes.empty() && arguments.codes.model.empty() && file.codes) {
    E2LF_ASSIGN_OR_RETURN(known.codes, aperture::codes_from_npy(*file.codes, arguments.input.string()));
  } else {
    E2LF_ASSIGN_OR_RETURN(known, load_codes(arguments.codes, record));
  }
  return Method([known](const events::EventImages& images, const ProgressFn&) {
    return recon::reconstruct_by_inversion(images, known.codes, known.constants);
  });
}

Result<Method> make_method(const ReconstructArguments& arguments, const events::EventImageFile& file,
                           RunRecord& record) {
  return arguments.method == "network" ? network_method(arguments, record) : inversion_method(arguments, file, record);
}

fs::path cycle_folder(const fs::path& folder, size_t cycle, size_t num_cycles) {
  if (num_cycles == 1) return folder;
  std::string number = std::to_string(cycle);
  number.insert(0, number.size() < 5 ? 5 - number.size() : 0, '0');
  return folder / ("cycle_" + number);
}

Result<void> reconstruct(const ReconstructArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(AtomicFolder output, AtomicFolder::create(arguments.output, common.overwrite));
  RunRecord record("reconstruct");
  record.add_input(arguments.input);
  E2LF_ASSIGN_OR_RETURN(const events::EventImageFile file, events::read_event_images(arguments.input));
  E2LF_ASSIGN_OR_RETURN(const Method method, make_method(arguments, file, record));
  record.end_step("read");

  Json cycles = Json::array();
  for (size_t cycle = 0; cycle < file.cycles.size(); ++cycle) {
    LightField light_field;
    {
      ProgressBar bar(file.cycles.size() == 1 ? "reconstruct" : cat("reconstruct cycle ", cycle), common.quiet);
      E2LF_ASSIGN_OR_RETURN(light_field, method(file.cycles[cycle], bar.callback()));
    }
    E2LF_ASSIGN_OR_RETURN(const float gain, resolve_gain(arguments.gain, light_field));
    if (gain != 1.0F) {
      for (float& value : light_field.data()) value *= gain;
    }
    record.end_step(cat("reconstruct_", cycle));
    const fs::path folder = cycle_folder(output.path(), cycle, file.cycles.size());
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    ProgressBar bar("write", common.quiet);
    E2LF_RETURN_IF_ERROR(write_reconstruction(folder, light_field, arguments.format, bar.callback()));
    record.end_step(cat("write_", cycle));
    cycles.push_back({{"cycle", cycle}, {"gain", gain}});
  }
  record.note("cycles", cycles);
  E2LF_RETURN_IF_ERROR(record.write(output.path() / "run.json", verb));
  E2LF_RETURN_IF_ERROR(output.commit());

  if (common.json) {
    const Json result = {{"output", arguments.output.string()}, {"cycles", cycles}, {"timings_s", record.timings_s()}};
    std::printf("%s\n", result.dump(2).c_str());
  } else if (!common.quiet) {
    std::printf("%zu light field%s in %s (gain %.3g): views, contact_sheet.png, epi.png, run.json\n",
                file.cycles.size(), file.cycles.size() == 1 ? "" : "s", arguments.output.c_str(),
                cycles.front()["gain"].get<double>());
  }
  return {};
}

}  // namespace

int run_reconstruct(const std::vector<std::string>& arguments) {
  Verb verb("reconstruct", "Reconstruct the light field of each pattern cycle from its event images.",
            "e2lf reconstruct events.npz -m models/e2lf-n4.safetensors -o out/recon");
  ReconstructArguments reconstruction;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", reconstruction.input,
                 "event images: an .npz or .npy, or a folder of event_image_00000.npy ...")
      ->required();
  app.add_option("-o,--output", reconstruction.output, "folder to write")->required();
  add_codes_options(app, reconstruction.codes);
  app.add_option("--method", reconstruction.method, "network, or inversion (closed form, needs no model, only codes)")
      ->check(CLI::IsMember({"network", "inversion"}))
      ->capture_default_str();
  app.add_option("--precision", reconstruction.precision, "arithmetic of the network: auto, float32 or bfloat16")
      ->check(CLI::IsMember({"auto", "float32", "bfloat16"}))
      ->capture_default_str();
  app.add_option("--gain", reconstruction.gain,
                 "brightness of the output: auto (estimated) or a number; 1 = as computed")
      ->capture_default_str();
  app.add_option("--format", reconstruction.format, "png, png16 (64 views) or npy (float32 [8, 8, y, x], not clamped)")
      ->check(CLI::IsMember({"png", "png16", "npy"}))
      ->capture_default_str();
  return verb.run(arguments, [&] { return reconstruct(reconstruction, verb); });
}

}  // namespace e2lf::cli
