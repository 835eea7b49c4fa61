// SPDX-License-Identifier: MIT
// Binds the module eval to Python.
#include <pybind11/stl.h>
#include <span>

#include "e2lf/base/text.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/eval/ssim.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

using Floats = py::array_t<float, py::array::c_style>;

std::span<const float> span_of(const Floats& values) {
  return {values.data(), static_cast<size_t>(values.size())};
}

/// Returns two arrays of the same shape.
std::pair<Floats, Floats> pair_of(const py::array& a, const py::array& b) {
  std::pair<Floats, Floats> both(floats_of(a, "a"), floats_of(b, "b"));
  const std::vector<py::ssize_t> shape_a(both.first.shape(), both.first.shape() + both.first.ndim());
  const std::vector<py::ssize_t> shape_b(both.second.shape(), both.second.shape() + both.second.ndim());
  if (shape_a != shape_b || both.first.size() == 0) {
    throw ResultError({ErrorCode::kShape, "the two arrays differ in shape or are empty", "a, b"});
  }
  return both;
}

double psnr(const py::array& a, const py::array& b) {
  const auto both = pair_of(a, b);
  return without_gil([&]() -> Result<double> {
    return eval::psnr_from_mse(eval::mean_squared_error(span_of(both.first), span_of(both.second)));
  });
}

double ssim(const py::array& a, const py::array& b, const std::string& window) {
  check_word(window, {"uniform7", "gaussian"}, "window");
  const auto kind = window == "gaussian" ? eval::SsimWindow::kGaussian11 : eval::SsimWindow::kUniform7;
  const auto both = pair_of(a, b);
  const auto least = static_cast<py::ssize_t>(eval::ssim_window_size(kind));
  if (both.first.ndim() != 2 || both.first.shape(0) < least || both.first.shape(1) < least) {
    throw ResultError({ErrorCode::kShape, cat("give pictures [y, x] of at least ", least, "x", least, " px"), "a, b"});
  }
  return without_gil([&]() -> Result<double> {
    return eval::ssim(span_of(both.first), span_of(both.second), static_cast<size_t>(both.first.shape(0)),
                      static_cast<size_t>(both.first.shape(1)), kind);
  });
}

py::object compare(const py::array& truth, const py::array& reconstruction, bool clamp,
                   const ProgressArgument& progress) {
  const auto a = light_field_of(truth, "truth");
  const auto b = light_field_of(reconstruction, "reconstruction");
  const ProgressFn told = progress_of(progress);
  return to_python(eval::to_json(without_gil([&] { return eval::compare(*a, *b, {.clamp = clamp}, told); })));
}

}  // namespace

void bind_eval(py::module_& module) {
  module.def(
      "psnr", &psnr, py::arg("a"), py::arg("b"),
      "Computes the peak signal-to-noise ratio in dB of two arrays of the same shape with values in [0, 1]; inf if "
      "they are equal.\n\na, b: floating-point numbers, with any axes.");
  module.def("ssim", &ssim, py::arg("a"), py::arg("b"), py::kw_only(), py::arg("window") = "uniform7",
             "Computes the mean SSIM of two images with values in [0, 1].\n\n"
             "a, b: [y, x].\nwindow: \"uniform7\" or \"gaussian\" (11x11).");
  module.def("compare", &compare, py::arg("truth"), py::arg("reconstruction"), py::kw_only(), py::arg("clamp") = true,
             py::arg("progress") = py::none(),
             "Compares a reconstructed light field with the true one. Returns the dict that `e2lf eval --json` prints, "
             "with psnr_db, ssim_uniform7, ssim_gaussian, epi_rms_error, epi_relative_error and views.\n\n"
             "truth, reconstruction: [view_y, view_x, y, x], or both with [channel].\n"
             "clamp: clamp the reconstruction to [0, 1] first.\n"
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
