// SPDX-License-Identifier: MIT
// e2lf animate: light field -> film, or a quilt for displays with parallax
#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/film/film_file.h"
#include "e2lf/film/parallax.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

struct AnimateArguments {
  fs::path input, output;
  std::string path = "orbit";
  size_t frames = 48;
  int frames_per_s = 20;
  float still = 0, from = 0, to = 0;
  film::Quilt quilt;
  bool has_focus_range = false;
  LightFieldFlags light_field{.views = 0};
};

/// Estimates the range of disparities in the scene, for a sweep of the focus.
Result<depth::DisparityRange> focus_range(const AnimateArguments& arguments, const LightField& light_field,
                                          RunRecord& record) {
  if (arguments.has_focus_range) return depth::DisparityRange{arguments.from, arguments.to};
  E2LF_ASSIGN_OR_RETURN(const depth::DisparityMap map,
                        located(depth::estimate_disparity(light_field), arguments.input));
  const depth::DisparityRange range = depth::shown_range(map);
  record.resolve("from", range.least);
  record.resolve("to", range.most);
  return range;
}

using FrameFn = std::function<Image(size_t frame)>;

Result<FrameFn> frame_maker(const AnimateArguments& arguments, const LightField& light_field, RunRecord& record) {
  const lightfield::Shape& shape = light_field.shape();
  if (arguments.path == "focus") {
    E2LF_ASSIGN_OR_RETURN(const depth::DisparityRange range, focus_range(arguments, light_field, record));
    return FrameFn([&light_field, path = film::focus_sweep(range.least, range.most, arguments.frames)](size_t frame) {
      return lightfield::refocus(light_field, path[frame], lightfield::full_aperture(light_field.shape()));
    });
  }
  const auto path =
      arguments.path == "orbit" ? film::orbit(shape, arguments.frames) : film::sweep(shape, arguments.frames);
  return FrameFn([&light_field, path, still = arguments.still](size_t frame) {
    return film::picture_from(light_field, path[frame], still);
  });
}

Result<void> write_film(const fs::path& file, film::FilmFormat format, const AnimateArguments& arguments,
                        const FrameFn& frame_at, bool is_quiet) {
  ProgressBar bar("animate", is_quiet);
  const Image first = frame_at(0);
  E2LF_ASSIGN_OR_RETURN(film::FilmFile film, film::FilmFile::create(file, {format, arguments.frames_per_s}, first));
  E2LF_RETURN_IF_ERROR(film.add(first));
  for (size_t frame = 1; frame < arguments.frames; ++frame) {
    E2LF_RETURN_IF_ERROR(film.add(frame_at(frame)));
    bar.update(frame, arguments.frames);
  }
  return film.finish();
}

Result<void> make_film(const AnimateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(const film::FilmFormat format, film::film_format_of(arguments.output));
  E2LF_RETURN_IF_ERROR(located(film::check_film_support(), arguments.output));
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, {arguments.input}));
  RunRecord record("animate", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field, load_to_show(arguments.input, arguments.light_field, common.quiet,
                                                                   {arguments.still, arguments.from, arguments.to}));
  E2LF_ASSIGN_OR_RETURN(const FrameFn frame_at, frame_maker(arguments, light_field, record));
  E2LF_RETURN_IF_ERROR(write_film(output.path(), format, arguments, frame_at, common.quiet));
  record.end_step("animate");
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
  if (!common.quiet) std::printf("%zu frames in %s\n", arguments.frames, arguments.output.c_str());
  std::error_code error;
  constexpr uintmax_t kLargeBytes = uintmax_t{10} << 20;
  const uintmax_t bytes = fs::file_size(arguments.output, error);
  if (arguments.output.extension() == ".gif" && !error && bytes > kLargeBytes) {
    log_info(cat("a GIF of ", bytes >> 20, " MB; the same film is a fraction of that as .mp4 or .webm"));
  }
  return {};
}

/// Returns the given name with the suffix that displays read.
fs::path quilt_name(const fs::path& named, const lightfield::Shape& shape, const film::Quilt& quilt) {
  const std::string stem = named.stem().string();
  if (stem.find("_qs") != std::string::npos) return named;
  return named.parent_path() / (stem + film::quilt_suffix(shape, quilt) + ".png");
}

Result<void> make_quilt(const AnimateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  RunRecord record("animate", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field, load_to_show(arguments.input, arguments.light_field, common.quiet,
                                                                   {arguments.still, arguments.from, arguments.to}));
  const fs::path named = quilt_name(arguments.output, light_field.shape(), arguments.quilt);
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(named, verb, {arguments.input}));
  E2LF_ASSIGN_OR_RETURN(const auto picture,
                        located(film::quilt_picture(light_field, arguments.quilt, arguments.still), arguments.input));
  if (std::max(picture.width, picture.height) > film::kMostQuiltPx) {
    log_warning(cat("the quilt has ", picture.width, "x", picture.height, " px, but displays read at most ",
                    film::kMostQuiltPx, " px per side; give fewer --columns or --rows, or smaller views"));
  }
  E2LF_RETURN_IF_ERROR(lightfield::write_png(output.path(), picture));
  record.end_step("animate");
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
  if (!common.quiet) {
    std::printf("%zux%zu images in %s\n", arguments.quilt.columns, arguments.quilt.rows, named.c_str());
  }
  return {};
}

Result<void> animate(AnimateArguments& arguments, const Verb& verb) {
  if (verb.is_given("--from") != verb.is_given("--to")) {
    return Error{ErrorCode::kInvalidValue, "a sweep has two ends; give --from and --to", ""};
  }
  arguments.has_focus_range = verb.is_given("--from");
  if (arguments.output.extension() != ".png") return make_film(arguments, verb);
  if (verb.is_given("--path") || verb.is_given("--from")) {
    return Error{ErrorCode::kInvalidValue, "a .png file contains a quilt, which has no path; use .gif, .webm or .mp4",
                 arguments.output.string()};
  }
  return make_quilt(arguments, verb);
}

}  // namespace

int run_animate(const std::vector<std::string>& arguments) {
  Verb verb("animate",
            "Render a film that moves the viewpoint or the focus through a light field, or a quilt, one image with "
            "many viewpoints for displays that show parallax.",
            "e2lf animate out/demo/recon -o out/orbit.gif");
  AnimateArguments animation;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", animation.input, "light field")->required();
  app.add_option("-o,--output", animation.output,
                 "film to write (.gif, .webm, .mp4), or a quilt (.png), whose name gets the suffix that displays read")
      ->required();
  add_choice(app, "--path", animation.path, {"orbit", "sweep", "focus"},
             "path: orbit (a circle), sweep (from left to right) or focus (from near to far)");
  add_count(app, "--frames", animation.frames, 1, 10000, "duration of the film, which ends as it begins");
  add_count(app, "--fps", animation.frames_per_s, 1, 100, "frames per second");
  app.add_option("--still", animation.still,
                 "orbit, sweep, quilt: disparity of the points that do not move, px per view step")
      ->capture_default_str();
  app.add_option("--from", animation.from, "focus: first disparity, px per view step");
  app.add_option("--to", animation.to, "focus: last disparity; default of both: the nearest and farthest in the scene");
  add_count(app, "--columns", animation.quilt.columns, 1, 100, "number of columns of a quilt");
  add_count(app, "--rows", animation.quilt.rows, 1, 100, "number of rows of a quilt");
  add_light_field_options(app, animation.light_field, /*has_views=*/true);
  add_orientation_options(app, animation.light_field.orientation);
  return verb.run(arguments, [&] { return animate(animation, verb); });
}

}  // namespace e2lf::cli
