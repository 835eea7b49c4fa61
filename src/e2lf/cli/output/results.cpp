// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/results.h"

#include "e2lf/base/text.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

Result<void> write_reconstruction(const fs::path& folder, lightfield::LightField& light_field,
                                  const std::string& format, const capture::Orientation& views,
                                  const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightFieldFormat stored, lightfield::parse_format(format));
  const bool is_array = stored == lightfield::LightFieldFormat::kNpy;
  if (is_array) {
    E2LF_RETURN_IF_ERROR(lightfield::write_light_field(folder / "lightfield.npy", light_field, {.format = stored}));
  }
  lightfield::orient(light_field, views);
  if (!is_array) E2LF_RETURN_IF_ERROR(lightfield::write_views(folder, light_field, stored, progress));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder / "contact_sheet.png", lightfield::contact_sheet(light_field)));
  const lightfield::EpiPictureOptions cut = lightfield::middle_cut(light_field.shape());
  return lightfield::write_png(folder / "epi.png", lightfield::epi_picture(light_field, cut));
}

std::string cycle_name(size_t cycle) {
  return formatted("cycle_%05zu", cycle);
}

Result<fs::path> ResultParts::begin(const std::string& name) {
  if (is_one_) return folder_.path();
  return folder_.begin_part(name);
}

Result<void> ResultParts::commit(const std::string& name, Json about, const program::RunRecord& run) {
  if (is_one_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit_part(name, std::move(about)));
  if (is_in_place_ || is_strict_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit(run.json_so_far()));
  is_in_place_ = true;
  return {};
}

Result<void> ResultParts::finish(const program::RunRecord& run) {
  E2LF_ASSIGN_OR_RETURN(Json about, run.json());
  return is_in_place_ ? folder_.update_record(std::move(about)) : folder_.commit(std::move(about));
}

}  // namespace e2lf::cli
