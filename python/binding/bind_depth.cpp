// SPDX-License-Identifier: MIT
// Binds the module depth to Python.
#include <pybind11/stl.h>
#include <utility>

#include "e2lf/depth/disparity.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"
#include "python/binding/orientation_arguments.h"

namespace e2lf::python {
namespace {

py::object estimate(const py::array& light_field, const std::optional<std::pair<size_t, size_t>>& view,
                    const std::optional<std::pair<float, float>>& range_px, E2LF_ORIENTATION_PARAMETERS,
                    const ProgressArgument& progress) {
  const auto field = oriented(light_field_of(light_field, "light_field"), E2LF_ORIENTATION_VALUE);
  depth::DisparityOptions options;
  if (view) options.view = depth::ViewIndex{view->first, view->second};
  if (range_px) options.range = depth::DisparityRange{range_px->first, range_px->second};
  const ProgressFn told = progress_of(progress);
  depth::DisparityMap map = without_gil([&] { return depth::estimate_disparity(*field, options, told); });
  return make_tuple_of("DisparityMap", to_array(std::move(map.disparity)), to_array(std::move(map.confidence)),
                       std::pair(map.view.y, map.view.x), std::pair(map.range.least, map.range.most));
}

}  // namespace

void bind_depth(py::module_& module) {
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
