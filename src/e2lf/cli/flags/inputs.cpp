// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/inputs.h"

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/model_option.h"
#include "e2lf/cli/flags/option_types.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using pipeline::KnownCodes;

void add_codes_options(CLI::App& app, CodesSource& source) {
  add_model_option(app, "-m,--model", source.model,
                   "model file, or the name of a bundled model: its patterns and sensor constants");
  add_codes_option(app, source.codes,
                   "aperture patterns (.json, .npy, .npz, or a model); default: those in the file of the events, or "
                   "else those of the model, or else those of e2lf-n4");
}

Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record) {
  if (source.model.empty()) return std::optional<model::Model>();
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(source.model));
  record.add_input(source.model, bytes);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::decode_model(bytes, source.model.string()));
  return std::optional(std::move(model));
}

Result<std::optional<capture::Codes>> read_named_codes(const CodesSource& source) {
  std::optional<capture::Codes> codes;
  if (!source.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, pipeline::read_patterns(source.codes));
  }
  return codes;
}

void note_named_codes(const CodesSource& source, const std::optional<capture::Codes>& codes,
                      const std::optional<capture::Codes>& of_events, RunRecord& record) {
  if (!codes) return;
  record.add_input(source.codes);
  if (!of_events || *codes == *of_events) return;
  log_warning(cat("the patterns of ", source.codes.string(), " differ from those in the file of the events; ",
                  "using those of --codes"));
}

Result<std::optional<KnownCodes>> find_codes(const CodesSource& source, const std::optional<model::Model>& model,
                                             const std::optional<capture::Codes>& of_events, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const std::optional<capture::Codes> named, read_named_codes(source));
  note_named_codes(source, named, of_events, record);
  return pipeline::known_codes(named, of_events, model ? &*model : nullptr);
}

Result<KnownCodes> load_codes(const CodesSource& source, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const std::optional<model::Model> model, read_named_model(source, record));
  E2LF_ASSIGN_OR_RETURN(std::optional<KnownCodes> known, find_codes(source, model, std::nullopt, record));
  if (known) return std::move(*known);
  if (!source.model.empty()) {
    return Error{ErrorCode::kNotFound, "the model contains no aperture patterns; give them with --codes",
                 source.model.string()};
  }
  known.emplace();
  E2LF_ASSIGN_OR_RETURN(known->codes, pipeline::usual_patterns());
  if (const auto path = bundled_model()) {
    record.add_input(*path);
    record.resolve("codes", path->stem().string());
    log_info(cat("no patterns were given; using those of ", path->stem().string()));
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
