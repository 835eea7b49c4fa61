// SPDX-License-Identifier: MIT
// Binds the module eval to Python.
#include <pybind11/stl.h>
#include <span>

#include "e2lf/base/text.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

/// Two light fields, or two images as light fields of one view, of the same shape.
struct Pair {
  LentLightField a, b;
};

/// Adds the axes of views to an image [y, x] or [y, x, channel].
py::array as_light_field(const py::array& array) {
  const bool is_image = array.ndim() == 2 || (array.ndim() == 3 && (array.shape(2) == 1 || array.shape(2) == 3));
  return is_image ? py::array(array[py::make_tuple(py::none(), py::none(), py::ellipsis())]) : array;
}

Pair pair_of(const py::array& a, const py::array& b) {
  Pair pair{light_field_of(as_light_field(a), "a"), light_field_of(as_light_field(b), "b")};
  if (pair.a->extents != pair.b->extents)
    throw ResultError({ErrorCode::kShape, "the two arrays differ in shape", "a, b"});
  return pair;
}

/// Returns the mean of `metric`(view of a, view of b) over the views.
template <typename Metric>
double mean_over_views(const Pair& pair, const Metric& metric) {
  const lightfield::Shape shape = lightfield::shape_of(*pair.a);
  return without_gil([&]() -> Result<double> {
    double sum = 0;
    std::vector<float> scratch[2];
    for (size_t view = 0; view < shape.num_views(); ++view) {
      const size_t row = view / shape.views_x, column = view % shape.views_x;
      sum += metric((*pair.a)[row][column].values(scratch[0]), (*pair.b)[row][column].values(scratch[1]));
    }
    return sum / static_cast<double>(shape.num_views());
  });
}

double psnr(const py::array& a, const py::array& b) {
  return mean_over_views(pair_of(a, b), [](std::span<const float> view_a, std::span<const float> view_b) {
    return eval::psnr_from_mse(eval::mean_squared_error(view_a, view_b));
  });
}

std::vector<float> channel_of(std::span<const float> view, size_t channel, size_t channels) {
  std::vector<float> values;
  for (size_t i = channel; i < view.size(); i += channels) values.push_back(view[i]);
  return values;
}

double ssim(const py::array& a, const py::array& b, const std::string& window) {
  check_word(window, {"uniform7", "gaussian"}, "window");
  const auto kind = window == "gaussian" ? eval::SsimWindow::kGaussian11 : eval::SsimWindow::kUniform7;
  const Pair pair = pair_of(a, b);
  const lightfield::Shape shape = lightfield::shape_of(*pair.a);
  const size_t least = eval::ssim_window_size(kind);
  if (shape.height < least || shape.width < least) {
    throw ResultError({ErrorCode::kShape, cat("views have at least ", least, "x", least, " px"), "a, b"});
  }
  return mean_over_views(pair, [&](std::span<const float> view_a, std::span<const float> view_b) {
    double sum = 0;
    for (size_t channel = 0; channel < shape.channels; ++channel) {
      sum += eval::ssim(channel_of(view_a, channel, shape.channels), channel_of(view_b, channel, shape.channels),
                        shape.height, shape.width, kind);
    }
    return sum / static_cast<double>(shape.channels);
  });
}

lightfield::LightField toned(const LightFieldView& field, const eval::Tone& tone) {
  lightfield::LightField result(field);
  for (float& value : result.data()) value = (value - tone.black) * tone.gain;
  return result;
}

py::object compare(const py::array& truth, const py::array& reconstruction, bool clamp, const std::string& fit,
                   const ProgressArgument& progress) {
  check_word(fit, {"none", "gain", "gain-and-black"}, "fit");
  const auto a = light_field_of(as_light_field(truth), "truth");
  const auto b = light_field_of(as_light_field(reconstruction), "reconstruction");
  const ProgressFn told = progress_of(progress);
  if (fit == "none") return to_python(eval::to_json(without_gil([&] { return eval::compare(*a, *b, clamp, told); })));
  if (a->extents != b->extents)
    throw ResultError({ErrorCode::kShape, "the two light fields differ in shape", "reconstruction"});
  eval::Tone tone;
  Json report = eval::to_json(without_gil([&]() -> Result<eval::LightFieldMetrics> {
    if (fit == "gain") tone.gain = eval::best_gain(*a, *b);
    if (fit != "gain") tone = eval::best_tone(*a, *b);
    return eval::compare(*a, toned(*b, tone), clamp, told);
  }));
  report["fitted_gain"] = tone.gain;
  report["fitted_black"] = tone.black;
  return to_python(report);
}

}  // namespace

void bind_eval(py::module_& module) {
  module.def(
      "psnr", &psnr, py::arg("a"), py::arg("b"),
      "Computes the peak signal-to-noise ratio in dB of values in [0, 1], as the mean over the views; inf if they are "
      "equal.\n\na, b: light fields [view_y, view_x, y, x] or images [y, x], or both with [channel].");
  module.def("ssim", &ssim, py::arg("a"), py::arg("b"), py::kw_only(), py::arg("window") = "uniform7",
             "Computes the mean SSIM of values in [0, 1] over the views and channels.\n\n"
             "a, b: light fields [view_y, view_x, y, x] or images [y, x], or both with [channel].\nwindow: "
             "\"uniform7\" or \"gaussian\" (11x11).");
  module.def("compare", &compare, py::arg("truth"), py::arg("reconstruction"), py::kw_only(), py::arg("clamp") = true,
             py::arg("fit") = "none", py::arg("progress") = py::none(),
             "Compares a reconstructed light field with the true one. Returns the dict that `e2lf eval --json` prints, "
             "with psnr_db, ssim_uniform7, ssim_gaussian, epi_rms_error, epi_relative_error and views.\n\n"
             "truth, reconstruction: [view_y, view_x, y, x] or [y, x], or both with [channel].\n"
             "clamp: clamp the reconstruction to [0, 1] first.\n"
             "fit: \"gain\" compares the reconstruction times the factor with the least squared error, and "
             "\"gain-and-black\" subtracts a black level first; the dict then has fitted_gain and fitted_black.\n"
             "progress: called with (views done, views).");
  module.def(
      "event_statistics",
      [](const py::array& images) {
        const auto counts = event_images_of(images, "images");
        return to_python(eval::to_json(eval::event_statistics(*counts)));
      },
      py::arg("images"),
      "Computes the cost of event images [transition, y, x]: a dict with events_per_pixel, total_events_per_pixel, "
      "min_measurement_ms, bits_per_sensor_pixel and more.");
}

}  // namespace e2lf::python
