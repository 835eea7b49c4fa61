// SPDX-License-Identifier: MIT
// e2lf epi: light field -> image of an epipolar plane
#include "e2lf/lightfield/epi.h"

#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/lightfield/contact_sheet.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

struct EpiArguments {
  fs::path input, output;
  size_t row = 0, column = 0, view = 0, px_per_view = 6;
  LightFieldFlags light_field{.views = 0};
};

/// Fails if there are not that many.
Result<void> check_place(const char* what, size_t place, size_t count, const fs::path& input) {
  if (place < count) return {};
  return Error{ErrorCode::kNotFound, cat("there is no ", what, " ", place, "; give 0 to ", count - 1), input.string()};
}

Result<Image> cut(const EpiArguments& arguments, const LightField& light_field, bool has_row, bool has_column,
                  bool has_view) {
  const lightfield::Shape& shape = light_field.shape();
  if (has_row) E2LF_RETURN_IF_ERROR(check_place("row", arguments.row, shape.height, arguments.input));
  if (has_column) E2LF_RETURN_IF_ERROR(check_place("column", arguments.column, shape.width, arguments.input));
  lightfield::EpiPictureOptions options = lightfield::middle_cut(shape);
  if (has_row) {
    if (has_view) options.view_y = arguments.view;
    E2LF_RETURN_IF_ERROR(check_place("row of views", options.view_y, shape.views_y, arguments.input));
  } else if (has_column) {
    if (has_view) options.view_x = arguments.view;
    E2LF_RETURN_IF_ERROR(check_place("column of views", options.view_x, shape.views_x, arguments.input));
  }
  if (has_row != has_column) {
    return has_row ? lightfield::enlarged(lightfield::horizontal_epi(light_field, options.view_y, arguments.row),
                                          arguments.px_per_view, 1)
                   : lightfield::enlarged(lightfield::vertical_epi(light_field, options.view_x, arguments.column), 1,
                                          arguments.px_per_view);
  }
  if (has_row) {
    options.y = arguments.row;
    options.x = arguments.column;
  }
  options.px_per_view = arguments.px_per_view;
  return lightfield::epi_picture(light_field, options);
}

Result<void> epi(const EpiArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  const bool has_row = verb.is_given("--row"), has_column = verb.is_given("--column");
  const bool has_view = verb.is_given("--view");
  if (has_view && has_row == has_column) {
    return Error{ErrorCode::kInvalidValue, "--view selects the views of a single cut; give --row or --column", ""};
  }
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, {arguments.input}, ".png"));
  RunRecord record("epi", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(arguments.input, arguments.light_field, common.quiet));
  E2LF_ASSIGN_OR_RETURN(const Image picture, cut(arguments, light_field, has_row, has_column, has_view));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(output.path(), picture));
  record.end_step("epi");
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
  if (!common.quiet) std::printf("%zux%zu px in %s\n", picture.width, picture.height, arguments.output.c_str());
  return {};
}

}  // namespace

int run_epi(const std::vector<std::string>& arguments) {
  Verb verb("epi",
            "Make an epipolar plane image: a cut of a light field along a row or column of pixels through all views of "
            "a row or column of views. With both cuts, or none, it is shown beside the view.",
            "e2lf epi out/demo/recon --row 200 -o out/epi.png");
  EpiArguments cutting;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", cutting.input, "light field")->required();
  app.add_option("-o,--output", cutting.output, "PNG file to write")->required();
  app.add_option("--row", cutting.row, "row of pixels to cut along, counted from 0; views are stacked downwards");
  app.add_option("--column", cutting.column,
                 "column of pixels to cut along, counted from 0; views are stacked to the right");
  app.add_option("--view", cutting.view, "the row of views, or with --column the column; default: the middle one");
  add_count(app, "--px-per-view", cutting.px_per_view, 1, 100, "thickness of each view's line, px");
  add_light_field_options(app, cutting.light_field, /*has_views=*/true);
  add_orientation_options(app, cutting.light_field.orientation);
  return verb.run(arguments, [&] { return epi(cutting, verb); });
}

}  // namespace e2lf::cli
