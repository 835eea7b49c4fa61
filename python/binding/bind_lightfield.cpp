// SPDX-License-Identifier: MIT
// Binds the module lightfield to Python.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace fs = std::filesystem;
namespace {

using lightfield::Shape;

/// Runs a function that returns an image instead of a Result.
template <typename Work>
py::array picture(const Work& work) {
  return to_array(without_gil([&work]() -> Result<lightfield::Image> { return work(); }));
}

void check_index(size_t index, size_t size, const char* axis) {
  if (index >= size) throw py::index_error(cat(axis, " ", index, " is not in 0..", size - 1));
}

py::array read(const fs::path& path, Whole<size_t> views, Whole<size_t> step, bool colour, bool reverse_rows,
               const std::string& range, float white, Whole<size_t> view_columns, Whole<size_t> lenslet_views,
               E2LF_ORIENTATION_PARAMETERS, const ProgressArgument& progress) {
  lightfield::ReadOptions options;
  for (lightfield::AxisViews* axis : {&options.views_y, &options.views_x}) {
    axis->count = views;
    axis->step = std::max<size_t>(step, 1);
  }
  options.colour = colour;
  options.reverse_rows = reverse_rows;
  options.white = white;
  options.view_columns = view_columns;
  options.lenslet_views = lenslet_views;
  options.orientation = E2LF_ORIENTATION_VALUE;
  constexpr Choice<lightfield::RangePolicy> kRanges[] = {{"refuse", lightfield::RangePolicy::kRefuse},
                                                         {"clamp", lightfield::RangePolicy::kClamp},
                                                         {"keep", lightfield::RangePolicy::kKeep}};
  options.range = value_of(range, kRanges, "range");
  const ProgressFn told = progress_of(progress);
  return to_array(without_gil([&] { return lightfield::read_light_field(path, options, told); }));
}

void write(const fs::path& path, const py::array& light_field, const std::string& format, bool overwrite,
           const ProgressArgument& progress) {
  const auto values = light_field_of(light_field, "light_field");
  lightfield::WriteOptions options;
  options.overwrite = overwrite;
  options.format = take(format.empty() ? lightfield::format_of_path(path) : lightfield::parse_format(format));
  const ProgressFn told = progress_of(progress);
  without_gil([&] { return lightfield::write_light_field(path, *values, options, told); });
}

/// Returns a round aperture, the given weights, or equal weights for all views.
lightfield::Aperture aperture_of(const Shape& shape, std::optional<float> radius, float centre_y, float centre_x,
                                 const std::optional<py::array>& weights) {
  if (radius && weights) throw py::value_error("give a radius or weights, not both");
  lightfield::Aperture aperture =
      radius ? lightfield::round_aperture(shape, {*radius, centre_y, centre_x}) : lightfield::full_aperture(shape);
  if (weights) {
    const auto values = floats_of(*weights, "weights");
    if (values.ndim() != 2 || static_cast<size_t>(values.shape(0)) != shape.views_y ||
        static_cast<size_t>(values.shape(1)) != shape.views_x) {
      throw ResultError({ErrorCode::kShape, cat("give weights [", shape.views_y, ", ", shape.views_x, "]"), "weights"});
    }
    aperture.weights.assign(values.data(), values.data() + values.size());
  }
  float light = 0;
  for (const float weight : aperture.weights) {
    if (!(weight >= 0)) throw py::value_error("a weight of a view is at least 0");
    light += weight;
  }
  if (!(light > 0)) throw py::value_error("no light passes the aperture; give a larger radius or other weights");
  return aperture;
}

void bind_pictures(py::module_& module) {
  module.def(
      "refocus",
      [](const py::array& light_field, float disparity, std::optional<float> radius, float centre_y, float centre_x,
         const std::optional<py::array>& weights) {
        const auto field = light_field_of(light_field, "light_field");
        const auto aperture = aperture_of(lightfield::shape_of(*field), radius, centre_y, centre_x, weights);
        return picture([&] { return lightfield::refocus(*field, disparity, aperture); });
      },
      py::arg("light_field"), py::arg("disparity"), py::kw_only(), py::arg("radius") = py::none(),
      py::arg("centre_y") = 0.0F, py::arg("centre_x") = 0.0F, py::arg("weights") = py::none(),
      "Computes the image of a camera that is focused at a disparity (px per view step): float32 [y, x], or "
      "[y, x, 3].\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "radius: radius of the aperture in view steps; None = all views.\n"
      "centre_y, centre_x: offset of the aperture from the middle in view steps, which changes the viewpoint.\n"
      "weights: float32 [view_y, view_x], the weights of the views instead of a round aperture.");
  module.def(
      "horizontal_epi",
      [](const py::array& light_field, Whole<size_t> view_y, Whole<size_t> y) {
        const auto field = light_field_of(light_field, "light_field");
        check_index(view_y, lightfield::shape_of(*field).views_y, "view_y");
        check_index(y, lightfield::shape_of(*field).height, "y");
        return picture([&] { return lightfield::horizontal_epi(*field, view_y, y); });
      },
      py::arg("light_field"), py::arg("view_y"), py::arg("y"),
      "Returns the epipolar plane image of one row, float32 [view_x, x], in which a point of disparity d moves by d px "
      "from row to row.\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "view_y, y: the row of views and the row of pixels, from 0.");
  module.def(
      "vertical_epi",
      [](const py::array& light_field, Whole<size_t> view_x, Whole<size_t> x) {
        const auto field = light_field_of(light_field, "light_field");
        check_index(view_x, lightfield::shape_of(*field).views_x, "view_x");
        check_index(x, lightfield::shape_of(*field).width, "x");
        return picture([&] { return lightfield::vertical_epi(*field, view_x, x); });
      },
      py::arg("light_field"), py::arg("view_x"), py::arg("x"),
      "Returns the epipolar plane image of one column: float32 [y, view_y].\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "view_x, x: the column of views and the column of pixels, from 0.");
  module.def(
      "epi_picture",
      [](const py::array& light_field, std::optional<size_t> y, std::optional<size_t> x) {
        const auto field = light_field_of(light_field, "light_field");
        lightfield::EpiPictureOptions options = lightfield::middle_cut(lightfield::shape_of(*field));
        options.y = y.value_or(options.y);
        options.x = x.value_or(options.x);
        check_index(options.y, lightfield::shape_of(*field).height, "y");
        check_index(options.x, lightfield::shape_of(*field).width, "x");
        return picture([&] { return lightfield::epi_picture(*field, options); });
      },
      py::arg("light_field"), py::kw_only(), py::arg("y") = py::none(), py::arg("x") = py::none(),
      "Returns a view with the EPIs of a row and a column beside it: float32 [y, x, 3].\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "y, x: the row and the column of pixels; None = the middle.");
  module.def(
      "contact_sheet",
      [](const py::array& light_field, Whole<size_t> max_width) {
        const auto field = light_field_of(light_field, "light_field");
        if (max_width < lightfield::shape_of(*field).views_x * (1 + lightfield::kSheetGapPx)) {
          throw py::value_error("max_width is too small for one pixel per view");
        }
        return picture([&] { return lightfield::contact_sheet(*field, max_width); });
      },
      py::arg("light_field"), py::kw_only(), py::arg("max_width") = 1600,
      "Returns all views in one image, float32 [y, x] or [y, x, 3].\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "max_width: maximum width in px; views are reduced if they do not fit.");
}

void bind_images(py::module_& module) {
  module.def(
      "read_image",
      [](const fs::path& path) { return to_array(without_gil([&] { return lightfield::read_image(path); })); },
      py::arg("path"), "Reads a PNG or JPEG as float32 [y, x] or [y, x, 3] in [0, 1]; no gamma is applied.");
  module.def(
      "write_png",
      [](const fs::path& path, const py::array& image, int bits, bool overwrite) {
        if (bits != 8 && bits != 16) throw py::value_error("a PNG has 8 or 16 bits");
        const lightfield::Image values = image_of(image, "image");
        const auto depth = bits == 8 ? lightfield::PngDepth::k8 : lightfield::PngDepth::k16;
        write_output(path, overwrite,
                     [&](const fs::path& place) { return lightfield::write_png(place, values, depth); });
      },
      py::arg("path"), py::arg("image"), py::kw_only(), py::arg("bits") = 8, py::arg("overwrite") = false,
      "Writes an image as PNG.\n\n"
      "image: floating-point numbers [y, x] or [y, x, 3], where 0 is black and 1 is white; others are clamped.\n"
      "bits: bits per sample, 8 or 16.");
}

void bind_scenes(py::module_& module) {
  const auto render = [](const lightfield::ProceduralScene& scene, size_t width, size_t height, size_t views) {
    if (width < 16 || height < 16 || width > 8192 || height > 8192)
      throw py::value_error("width and height are 16..8192 px");
    if (views < 1 || views > 64) throw py::value_error("views is 1..64");
    return to_array(without_gil([&]() -> Result<lightfield::LightField> {
      return lightfield::render_light_field(scene, {views, views, height, width, 1});
    }));
  };
  module.def(
      "demo_scene",
      [render](Whole<size_t> width, Whole<size_t> height, Whole<size_t> views, Whole<uint64_t> seed) {
        return render(lightfield::demo_scene(seed), width, height, views);
      },
      py::arg("width") = 512, py::arg("height") = 384, py::kw_only(), py::arg("views") = 8, py::arg("seed") = 1,
      "Renders the scene of `e2lf demo`: float32 [view_y, view_x, y, x], with disparities of about -2 to 1.5 px.\n\n"
      "width, height: size of a view in px. views: number of views per axis. seed: selects a variant of the scene.");
  module.def(
      "turntable_scene",
      [render](float turn, Whole<size_t> width, Whole<size_t> height, Whole<size_t> views, Whole<uint64_t> seed) {
        return render(lightfield::turntable_scene(turn, seed), width, height, views);
      },
      py::arg("turn"), py::arg("width") = 512, py::arg("height") = 384, py::kw_only(), py::arg("views") = 8,
      py::arg("seed") = 1,
      "Renders a still life on a turntable: float32 [view_y, view_x, y, x].\n\n"
      "turn: rotation of the table in radians. width, height: size of a view in px. views: number of views per axis. "
      "seed: selects a variant of the scene.");
}

}  // namespace

void bind_lightfield(py::module_& module) {
  module.def(
      "read_light_field", &read, py::arg("path"), py::kw_only(), py::arg("views") = 8, py::arg("step") = 1,
      py::arg("colour") = false, py::arg("reverse_rows") = false, py::arg("range") = "refuse", py::arg("white") = 0.0F,
      py::arg("view_columns") = 0, py::arg("lenslet_views") = 0, E2LF_ORIENTATION_ARGUMENTS,
      py::arg("progress") = py::none(),
      "Reads a light field of any format: float32 [view_y, view_x, y, x] in [0, 1], with a last axis [channel] of 3 "
      "if colour is requested and available. Views are reordered as the run.json in its folder states.\n\n"
      "views: number of central views per axis; 0 = all.\n"
      "step: reads every step-th view, which multiplies the disparity by step.\n"
      "colour: whether to keep colour.\n"
      "reverse_rows: whether view rows are stored bottom to top.\n"
      "range: treatment of values outside [0, 1]: \"refuse\", \"clamp\" or \"keep\" (for reconstructions).\n"
      "white: stored value that is white; 0 = the largest of the type.\n"
      "view_columns: number of views in a row of the grid if views are numbered consecutively; 0 = detected.\n"
      "lenslet_views: number of views per axis of one picture that holds all: a lenslet mosaic, or a patch of "
      "BasicLFSR "
      "(.h5); 0 = as its name or content states.\n" E2LF_ORIENTATION_DOC "progress: called with (views done, views).");
  module.def(
      "write_light_field", &write, py::arg("path"), py::arg("light_field"), py::kw_only(), py::arg("format") = "",
      py::arg("overwrite") = false, py::arg("progress") = py::none(),
      "Writes a light field.\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].\n"
      "format: \"png\", \"png16\", \"hci\", \"stanford\" (folders), \"npy\", \"lenslet\", \"mat\", \"h5\"; if empty, "
      "determined by the extension.\n"
      "progress: called with (views done, views).");
  bind_pictures(module);
  bind_images(module);
  bind_scenes(module);
}

}  // namespace e2lf::python
