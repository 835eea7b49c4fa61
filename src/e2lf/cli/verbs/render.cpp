// SPDX-License-Identifier: MIT
// The verbs that render a light field: refocus, epi and animate.
#include <cstdio>
#include <optional>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_picture.h"
#include "e2lf/film/film_file.h"
#include "e2lf/film/parallax.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

struct RefocusArguments {
  fs::path input, output;
  std::vector<float> disparities;
  std::optional<float> radius;  ///< of a round aperture, in view steps; empty = all views
  lightfield::RoundAperture aperture;
  LightFieldFlags light_field;
};

Result<lightfield::Aperture> aperture_of(const RefocusArguments& arguments, const lightfield::Shape& shape) {
  if (!arguments.radius) return lightfield::full_aperture(shape);
  lightfield::RoundAperture round = arguments.aperture;
  round.radius = *arguments.radius;
  lightfield::Aperture aperture = lightfield::round_aperture(shape, round);
  for (float weight : aperture.weights) {
    if (weight > 0) return aperture;
  }
  return fail(ErrorCode::kInvalidValue, arguments.input,
              "this aperture contains no view; give a larger --aperture or a centre that is nearer");
}

Result<void> refocus(const RefocusArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, ".png"));
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(arguments.input, arguments.light_field, common.quiet, arguments.disparities));
  E2LF_ASSIGN_OR_RETURN(const lightfield::Aperture aperture, aperture_of(arguments, light_field.shape()));
  std::vector<Image> pictures;
  for (float disparity : arguments.disparities) {
    pictures.push_back(lightfield::refocus(light_field, disparity, aperture));
  }
  record.end_step("refocus");
  E2LF_RETURN_IF_ERROR(lightfield::write_png(output.path(), lightfield::side_by_side(pictures)));
  E2LF_RETURN_IF_ERROR(commit(output, record));
  if (!common.quiet) {
    std::printf("%s of %zux%zu px in %s\n", counted(pictures.size(), "image").c_str(), pictures.front().width,
                pictures.front().height, arguments.output.c_str());
  }
  return {};
}

}  // namespace

int run_refocus(const std::vector<std::string>& arguments) {
  Verb verb("refocus",
            "Compute the image of a camera with a wide aperture that is focused at a given disparity, or several "
            "images side by side.",
            "e2lf refocus out/demo/recon --disparity=-1,0,1.2 -o out/refocus.png");
  RefocusArguments refocusing;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", refocusing.input, "light field")->required();
  app.add_option("-o,--output", refocusing.output, "PNG file to write")->required();
  app.add_option("--disparity", refocusing.disparities,
                 "disparity of the points in focus, px per view step, smaller for nearer points; several are separated "
                 "by commas, e.g. --disparity=-1,0")
      ->required()
      ->delimiter(',')
      ->expected(1, 64);
  CLI::Option* const radius =
      app.add_option("--aperture", refocusing.radius,
                     "radius of a round aperture in view steps, where 0.5 is one view; default: all views");
  app.add_option("--centre-row", refocusing.aperture.centre_y, "offset of the round aperture downwards, in view steps")
      ->needs(radius);
  app.add_option("--centre-column", refocusing.aperture.centre_x,
                 "offset of the round aperture to the right, in view steps")
      ->needs(radius);
  add_light_field_options(app, refocusing.light_field, /*has_views=*/true);
  add_orientation_options(app, refocusing.light_field.orientation);
  return verb.run(arguments, [&] { return refocus(refocusing, verb); });
}

namespace {

struct EpiArguments {
  fs::path input, output;
  std::optional<size_t> row, column, view;
  LightFieldFlags light_field;
};

/// Takes a place that is given. Fails if there are not that many.
Result<void> take_place(const std::optional<size_t>& given, const char* what, size_t count, const fs::path& input,
                        size_t& place) {
  place = given.value_or(place);
  if (place < count) return {};
  return fail(ErrorCode::kNotFound, input, "there is no ", what, " ", place, "; give 0 to ", count - 1);
}

Result<Image> cut(const EpiArguments& arguments, const LightField& light_field) {
  const lightfield::Shape& shape = light_field.shape();
  const fs::path& input = arguments.input;
  lightfield::EpiPictureOptions options = lightfield::middle_cut(shape);
  const auto &row = arguments.row, &column = arguments.column, &view = arguments.view;
  E2LF_RETURN_IF_ERROR(take_place(row, "row", shape.height, input, options.y));
  E2LF_RETURN_IF_ERROR(take_place(column, "column", shape.width, input, options.x));
  if (row && !column) {
    E2LF_RETURN_IF_ERROR(take_place(view, "row of views", shape.views_y, input, options.view_y));
    return lightfield::enlarged(lightfield::horizontal_epi(light_field, options.view_y, options.y),
                                lightfield::kEpiPxPerView, 1);
  }
  if (column && !row) {
    E2LF_RETURN_IF_ERROR(take_place(view, "column of views", shape.views_x, input, options.view_x));
    return lightfield::enlarged(lightfield::vertical_epi(light_field, options.view_x, options.x), 1,
                                lightfield::kEpiPxPerView);
  }
  return lightfield::epi_picture(light_field, options);
}

Result<void> epi(const EpiArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  if (arguments.view && arguments.row.has_value() == arguments.column.has_value()) {
    return fail(ErrorCode::kInvalidValue, "", "--view selects the views of a single cut; give --row or --column");
  }
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, ".png"));
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(arguments.input, arguments.light_field, common.quiet));
  E2LF_ASSIGN_OR_RETURN(const Image picture, cut(arguments, light_field));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(output.path(), picture));
  record.end_step("epi");
  E2LF_RETURN_IF_ERROR(commit(output, record));
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
  add_light_field_options(app, cutting.light_field, /*has_views=*/true);
  add_orientation_options(app, cutting.light_field.orientation);
  return verb.run(arguments, [&] { return epi(cutting, verb); });
}

namespace {

struct AnimateArguments {
  fs::path input, output;
  std::string path = "orbit";
  size_t frames = 48;
  float still = 0;
  std::optional<float> from, to;
  LightFieldFlags light_field;
};

/// Estimates the range of disparities in the scene, for a sweep of the focus.
Result<depth::DisparityRange> focus_range(const AnimateArguments& arguments, const LightField& light_field,
                                          RunRecord& record) {
  if (arguments.from) return depth::DisparityRange{*arguments.from, *arguments.to};
  E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap map,
                        pipeline::naming(arguments.input, depth::estimate_disparity(light_field)));
  const depth::DisparityRange range = depth::shown_range(map.disparity, map.confidence);
  record.resolve("from", range.least);
  record.resolve("to", range.most);
  return range;
}

Result<film::Film> film_of(const AnimateArguments& arguments, const LightField& light_field, RunRecord& record) {
  const lightfield::Shape& shape = light_field.shape();
  film::Film film{.frames = arguments.frames, .frames_per_s = 20};
  if (arguments.path == "focus") {
    E2LF_ASSIGN_OR_RETURN(const depth::DisparityRange range, focus_range(arguments, light_field, record));
    film.frame_at = [&light_field, path = film::focus_sweep(range.least, range.most, film.frames)](size_t frame) {
      return lightfield::refocus(light_field, path[frame], lightfield::full_aperture(light_field.shape()));
    };
    return film;
  }
  const auto path = arguments.path == "orbit" ? film::orbit(shape, film.frames) : film::sweep(shape, film.frames);
  film.frame_at = [&light_field, path, still = arguments.still](size_t frame) {
    return film::picture_from(light_field, path[frame], still);
  };
  return film;
}

Result<void> check_path(const AnimateArguments& arguments) {
  const bool is_focus = arguments.path == "focus";
  if (is_focus ? arguments.still == 0 : !arguments.from) return {};
  return fail(ErrorCode::kInvalidValue, is_focus ? "--still" : "--from", "the path ", arguments.path, " does not use ",
              is_focus ? "it" : "it and --to", "; choose another --path, or leave it out");
}

Result<void> animate(const AnimateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_RETURN_IF_ERROR(check_path(arguments));
  E2LF_ASSIGN_OR_RETURN(const film::FilmFormat format, film::film_format_of(arguments.output));
  E2LF_RETURN_IF_ERROR(pipeline::naming(arguments.output, film::check_film_support()));
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb));
  RunRecord record(verb, {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(arguments.input, arguments.light_field, common.quiet,
                                     {arguments.still, arguments.from.value_or(0), arguments.to.value_or(0)}));
  E2LF_ASSIGN_OR_RETURN(const film::Film film, film_of(arguments, light_field, record));
  {
    ProgressBar bar("animate", common.quiet);
    E2LF_RETURN_IF_ERROR(film::write_film(output.path(), format, film, bar.callback()));
  }
  record.end_step("animate");
  E2LF_RETURN_IF_ERROR(commit(output, record));
  if (!common.quiet) std::printf("%zu frames in %s\n", arguments.frames, arguments.output.c_str());
  return {};
}

}  // namespace

int run_animate(const std::vector<std::string>& arguments) {
  Verb verb("animate", "Render a film that moves the viewpoint or the focus through a light field.",
            "e2lf animate out/demo/recon -o out/orbit.gif");
  AnimateArguments animation;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", animation.input, "light field")->required();
  app.add_option("-o,--output", animation.output, "film to write (.gif, .webm, .mp4)")->required();
  add_choice(app, "--path", animation.path, {"orbit", "sweep", "focus"},
             "path: orbit (a circle), sweep (from left to right) or focus (from near to far)");
  add_count(app, "--frames", animation.frames, 1, 10000, "duration of the film, which ends as it begins");
  app.add_option("--still", animation.still, "orbit, sweep: disparity of the points that do not move, px per view step")
      ->capture_default_str();
  add_pair(app.add_option("--from", animation.from, "focus: first disparity, px per view step"),
           app.add_option("--to", animation.to,
                          "focus: last disparity; default of both: the nearest and farthest in the scene"));
  add_light_field_options(app, animation.light_field, /*has_views=*/true);
  add_orientation_options(app, animation.light_field.orientation);
  return verb.run(arguments, [&] { return animate(animation, verb); });
}

}  // namespace e2lf::cli
