// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/light_field_output.h"

#include <cmath>
#include <cstdlib>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/contact_sheet.h"
#include "e2lf/lightfield/epi.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/orient.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;

namespace {

/// Returns a finite number, or nothing if the text is none.
std::optional<float> finite_number(const std::string& text) {
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Result<std::optional<float>> parse_gain(const std::string& gain) {
  if (gain == "auto") return std::optional<float>();
  const auto value = finite_number(gain);
  if (!value || *value <= 0) {
    return Error{ErrorCode::kInvalidValue, cat("\"", gain, "\" is not a gain; give auto or a positive number"),
                 "--gain"};
  }
  return value;
}

Result<std::optional<float>> parse_black(const std::string& black) {
  if (black == "auto") return std::optional<float>();
  const auto value = finite_number(black);
  if (!value || *value < 0) {
    return Error{ErrorCode::kInvalidValue,
                 cat("\"", black, "\" is not a brightness; give auto, 0 or a positive number"), "--black"};
  }
  return value;
}

Result<void> write_reconstruction(const fs::path& folder, LightField& light_field, const std::string& format,
                                  const capture::Orientation& views, const ProgressFn& progress) {
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

capture::Orientation stored_views(const std::string& format, const capture::Orientation& views) {
  return format == "npy" ? views : capture::Orientation{};
}

}  // namespace e2lf::cli
