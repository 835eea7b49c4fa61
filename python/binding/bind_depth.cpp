// SPDX-License-Identifier: MIT
// Binds the module depth to Python.
#include <pybind11/stl.h>
#include <utility>

#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/eval/report.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

py::object estimate(const py::array& light_field, const std::optional<std::pair<size_t, size_t>>& view,
                    const std::optional<std::pair<float, float>>& range_px, E2LF_ORIENTATION_PARAMETERS,
                    const ProgressArgument& progress) {
  const lightfield::LightField field(*oriented(light_field_of(light_field, "light_field"), E2LF_ORIENTATION_VALUE));
  depth::DisparityOptions options;
  if (view) options.view = depth::ViewIndex{view->first, view->second};
  if (range_px) options.range = depth::DisparityRange{range_px->first, range_px->second};
  const ProgressFn told = progress_of(progress);
  depth::DisparityMap map = without_gil([&] { return depth::estimate_disparity(field, options, told); });
  return make_tuple_of("DisparityMap", to_array(std::move(map.disparity)), to_array(std::move(map.confidence)),
                       std::pair(map.view.y, map.view.x), std::pair(map.range.least, map.range.most));
}

py::object compare_disparity(const py::array& truth, const py::array& estimate,
                             const std::optional<py::array>& confidence, size_t border) {
  const lightfield::Image true_map = image_of(truth, "truth"), map = image_of(estimate, "estimate");
  const lightfield::Image weights = confidence ? image_of(*confidence, "confidence") : lightfield::Image();
  return to_python(eval::to_json(without_gil([&] { return depth::compare(map, weights, true_map, border); })));
}

}  // namespace

void bind_depth(py::module_& module) {
  module.def(
      "compare_disparity", &compare_disparity, py::arg("truth"), py::arg("estimate"), py::kw_only(),
      py::arg("confidence") = py::none(), py::arg("border") = depth::kErrorBorderPx,
      "Compares a disparity map of any source with the true one. Returns the dict that `e2lf eval --json` prints "
      "under \"disparity\": the shares of bad pixels, the mean absolute error, the slope of the regression on the "
      "truth, and the error of the most certain pixels.\n\n"
      "truth, estimate: [y, x], px per view step; pixels whose truth is not finite are left out.\n"
      "confidence: [y, x] of any scale, higher for more certain pixels; None = without the error over it.\n"
      "border: the px that are left out on each side.");
  module.def(
      "depth", &estimate, py::arg("light_field"), py::kw_only(), py::arg("view") = py::none(),
      py::arg("range_px") = py::none(), E2LF_ORIENTATION_ARGUMENTS, py::arg("progress") = py::none(),
      "Estimates the disparity of each pixel of a view, as `e2lf depth` does. Returns a DisparityMap with disparity "
      "and confidence, float32 [y, x].\n\n"
      "light_field: [view_y, view_x, y, x]; one with [channel] is converted to grey.\n"
      "view: (view_y, view_x), the view for whose pixels disparities are estimated; None = the middle one, (4, 4) of "
      "8x8.\n"
      "range_px: (least, most), the range of disparities in px per view step; None = estimated, within 6 "
      "px.\n" E2LF_ORIENTATION_DOC "progress: called with (done, total); an exception cancels the operation.");
}

}  // namespace e2lf::python
