// SPDX-License-Identifier: MIT
// e2lf refocus: light field -> images of a camera with a wide aperture
#include "e2lf/lightfield/refocus.h"

#include <cstdio>

#include "e2lf/base/format.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
using lightfield::LightField;
namespace {

struct RefocusArguments {
  fs::path input, output;
  std::vector<float> disparities;
  lightfield::RoundAperture aperture;
  bool is_round = false;
  LightFieldFlags light_field{.views = 0};
};

/// Places images side by side, with a gap between them.
Image side_by_side(const std::vector<Image>& pictures) {
  constexpr size_t kGapPx = 4;
  const Image& first = pictures.front();
  Image all(pictures.size() * (first.width + kGapPx) - kGapPx, first.height, first.channels);
  std::fill(all.pixels.begin(), all.pixels.end(), 1.0F);
  const size_t row = first.width * first.channels, stride = (first.width + kGapPx) * first.channels;
  for (size_t i = 0; i < pictures.size(); ++i) {
    for (size_t y = 0; y < first.height; ++y) {
      std::copy_n(pictures[i].pixels.data() + y * row, row,
                  all.pixels.data() + y * all.width * first.channels + i * stride);
    }
  }
  return all;
}

Result<lightfield::Aperture> aperture_of(const RefocusArguments& arguments, const lightfield::Shape& shape) {
  if (!arguments.is_round) return lightfield::full_aperture(shape);
  lightfield::Aperture aperture = lightfield::round_aperture(shape, arguments.aperture);
  for (float weight : aperture.weights) {
    if (weight > 0) return aperture;
  }
  return Error{ErrorCode::kInvalidValue,
               "this aperture contains no view; give a larger --aperture or a centre that is nearer",
               arguments.input.string()};
}

Result<void> refocus(RefocusArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  arguments.is_round = verb.is_given("--aperture");
  if (!arguments.is_round && (verb.is_given("--centre-row") || verb.is_given("--centre-column"))) {
    return Error{ErrorCode::kInvalidValue, "the centre of the whole aperture is fixed; also give --aperture", ""};
  }
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, {arguments.input}, ".png"));
  RunRecord record("refocus", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const LightField light_field,
                        load_to_show(arguments.input, arguments.light_field, common.quiet, arguments.disparities));
  E2LF_ASSIGN_OR_RETURN(const lightfield::Aperture aperture, aperture_of(arguments, light_field.shape()));
  std::vector<Image> pictures;
  for (float disparity : arguments.disparities) {
    pictures.push_back(lightfield::refocus(light_field, disparity, aperture));
  }
  record.end_step("refocus");
  E2LF_RETURN_IF_ERROR(lightfield::write_png(output.path(), side_by_side(pictures)));
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
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
  app.add_option("--aperture", refocusing.aperture.radius,
                 "radius of a round aperture in view steps, where 0.5 is one view; default: all views");
  app.add_option("--centre-row", refocusing.aperture.centre_y, "offset of the round aperture downwards, in view steps");
  app.add_option("--centre-column", refocusing.aperture.centre_x,
                 "offset of the round aperture to the right, in view steps");
  add_light_field_options(app, refocusing.light_field, /*has_views=*/true);
  add_orientation_options(app, refocusing.light_field.orientation);
  return verb.run(arguments, [&] { return refocus(refocusing, verb); });
}

}  // namespace e2lf::cli
