// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/inputs.h"

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/cli/flags/model_option.h"
#include "e2lf/cli/flags/option_types.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

void add_codes_options(CLI::App& app, CodesSource& source) {
  add_model_option(app, "-m,--model", source.model,
                   "model file, or the name of a bundled model: its patterns and sensor constants");
  add_codes_option(
      app, source.codes,
      "aperture patterns (.json, .npy, .npz, or those of a model); default: those of the events' file, the "
      "model's, those of e2lf-n4");
}

Result<capture::Codes> read_patterns(const fs::path& path) {
  if (path.extension() != kBundledModels.extension) return capture::read_codes(path);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model.codes) return std::move(*model.codes);
  return Error{ErrorCode::kNotFound, "the model holds no aperture patterns; name a file that does", path.string()};
}

Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record) {
  if (source.model.empty()) return std::optional<model::Model>();
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(source.model));
  record.add_input(source.model, bytes);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::decode_model(bytes, source.model.string()));
  return std::optional(std::move(model));
}

Result<std::optional<KnownCodes>> find_codes(const CodesSource& source, const std::optional<model::Model>& model,
                                             const std::optional<capture::Codes>& of_events, RunRecord& record) {
  KnownCodes known;
  std::optional<capture::Codes> codes;
  if (model) {
    known.constants = model->constants;
    known.event_model = model->event_model;
    known.measurement = model->measurement();
    codes = model->codes;
    known.origin = CodesOrigin::kModel;
  }
  if (of_events) {
    codes = of_events;
    known.origin = CodesOrigin::kEvents;
  }
  if (!source.codes.empty()) {
    record.add_input(source.codes);
    E2LF_ASSIGN_OR_RETURN(codes, read_patterns(source.codes));
    known.origin = CodesOrigin::kGiven;
    if (of_events && *codes != *of_events) {
      log_warning(cat("the patterns of ", source.codes.string(), " are not those that the file of the events holds; ",
                      "taking them as told"));
    }
  }
  if (!codes) return std::optional<KnownCodes>();
  known.codes = std::move(*codes);
  return std::optional(std::move(known));
}

Result<KnownCodes> load_codes(const CodesSource& source, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const std::optional<model::Model> model, read_named_model(source, record));
  E2LF_ASSIGN_OR_RETURN(std::optional<KnownCodes> known, find_codes(source, model, std::nullopt, record));
  if (known) return std::move(*known);
  if (!source.model.empty()) {
    return Error{ErrorCode::kNotFound, "the model holds no aperture patterns; give them with --codes",
                 source.model.string()};
  }
  known.emplace();
  if (const auto path = bundled_model()) {
    E2LF_ASSIGN_OR_RETURN(known->codes, read_patterns(*path));
    record.add_input(*path);
    record.resolve("codes", path->stem().string());
    log_info(cat("no patterns named: taking those of ", path->stem().string()));
  } else {
    known->codes = capture::default_codes();
  }
  return std::move(*known);
}

Result<lightfield::LightField> read_with_progress(const fs::path& path, const lightfield::ReadOptions& options,
                                                  bool is_quiet) {
  ProgressBar bar("read " + path.filename().string(), is_quiet);
  bar.update(0, 1);
  return lightfield::read_light_field(path, options, bar.callback());
}

}  // namespace e2lf::cli
