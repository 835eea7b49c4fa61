// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/patterns.h"

#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::pipeline {

bool are_patterns_stated(const std::optional<KnownCodes>& known) {
  return known && (known->stated_by == StatedBy::kCaller || known->stated_by == StatedBy::kEvents);
}

capture::Codes codes_for(const model::Model& model, const capture::Codes& codes) {
  const bool is_whole = model.num_patterns == 2 * codes.num_patterns + 1 && model.num_patterns != codes.num_patterns;
  return is_whole ? capture::whole_cycle(codes) : codes;
}

std::optional<KnownCodes> known_codes(const std::optional<capture::Codes>& of_caller,
                                      const std::optional<capture::Codes>& of_events, const model::Model* model) {
  KnownCodes known;
  if (model != nullptr) {
    known.constants = model->constants;
    known.event_model = model->event_model;
    known.measurement = model->measurement();
  }
  const auto take = [&](const std::optional<capture::Codes>& codes, StatedBy stated_by) {
    if (!codes || known.stated_by != StatedBy::kNone) return;
    known.codes = model != nullptr ? codes_for(*model, *codes) : *codes;
    known.stated_by = stated_by;
  };
  take(of_caller, StatedBy::kCaller);
  take(of_events, StatedBy::kEvents);
  if (model != nullptr) take(model->codes, StatedBy::kModel);
  if (known.stated_by == StatedBy::kNone) return std::nullopt;
  return known;
}

Result<capture::Codes> usual_patterns() {
  const auto path = bundled_model();
  return path ? read_patterns(*path) : capture::default_codes();
}

Result<capture::Codes> read_patterns(const std::filesystem::path& path) {
  if (path.extension() != kBundledModels.extension) return capture::read_codes(path);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model.codes) return std::move(*model.codes);
  return Error{ErrorCode::kNotFound,
               "the model contains no aperture patterns; give a file that does: for those of the paper, the model that "
               "`e2lf model import --release FOLDER` writes",
               path.string()};
}

}  // namespace e2lf::pipeline
