// SPDX-License-Identifier: MIT
// Binds the module sensor to Python.
#include <algorithm>
#include <cmath>
#include <pybind11/stl.h>

#include "e2lf/base/text.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

constexpr float kRounding = 1e-3F;  ///< of values that should be in [0, 1]

/// Returns a light field whose intensities must be finite and not negative. Warns of those above 1.
LentLightField light_on_sensor(const py::array& light_field) {
  auto scene = light_field_of(light_field, "light_field");
  float largest = 0;
  without_gil([&]() -> Result<void> {
    bool is_light = true;
    for_each_value(*scene, [&](float value) {
      is_light = is_light && value >= 0 && std::isfinite(value);
      largest = std::max(largest, value);
    });
    if (is_light) return {};
    return Error{ErrorCode::kInvalidValue, "it contains NaN, infinity or negative intensities; clip them first",
                 "light_field"};
  });
  if (largest > 1 + kRounding) {
    const std::string text = formatted("light_field: intensities are in [0, 1], but the largest is %g", largest) +
                             "; divide 8-bit values by 255, or give scene_gain for a brighter scene";
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
  }
  return scene;
}

/// Simulates the paper's model, or the physical pixels of a camera; rejects arguments that do not apply.
py::array simulate(const py::array& light_field, const py::array& codes, const capture::SensorProfile* camera,
                   const std::optional<capture::SensorConstants>& constants, const std::string& event_model,
                   float scene_gain, float residue, Whole<uint64_t> seed, std::optional<Whole<uint64_t>> map_seed) {
  auto scene = light_on_sensor(light_field);
  // The camera sees the views in its own orientation.
  if (camera != nullptr && camera->views) scene = oriented(std::move(scene), *camera->views);
  const capture::Codes patterns = codes_of(codes, "codes");
  const bool is_pixel = camera != nullptr && camera->is_pixel();
  if (is_pixel && (constants || !event_model.empty() || residue != 0.0F)) {
    throw ResultError({ErrorCode::kInvalidValue,
                       "constants, event_model and residue belong to the paper's model; leave them out", "camera"});
  }
  if (!is_pixel && map_seed) {
    throw ResultError(
        {ErrorCode::kInvalidValue, "the paper's model has no map of thresholds; leave it out", "map_seed"});
  }
  if (is_pixel) {
    const sensor::PixelModelOptions options{.gain = scene_gain, .seed = seed, .map_seed = map_seed.value_or(seed)};
    return to_array(without_gil([&] { return sensor::simulate_pixel_events(patterns, *scene, *camera, options); }));
  }
  sensor::EventModelOptions options;
  if (camera != nullptr) options.constants = camera->constants;
  if (constants) options.constants = *constants;
  const std::string model = !event_model.empty() ? event_model : camera != nullptr ? camera->event_model : "";
  if (!model.empty()) options.model = take(sensor::event_model_from_name(model));
  options.gain = scene_gain;
  options.residue = residue;
  options.seed = seed;
  return to_array(without_gil([&] { return sensor::simulate_events(patterns, *scene, options); }));
}

}  // namespace

void bind_sensor(py::module_& module) {
  module.def(
      "simulate", &simulate, py::arg("light_field"), py::arg("codes"), py::kw_only(), py::arg("camera") = nullptr,
      py::arg("constants") = py::none(), py::arg("event_model") = "", py::arg("scene_gain") = 1.0F,
      py::arg("residue") = 0.0F, py::arg("seed") = sensor::EventModelOptions().seed, py::arg("map_seed") = py::none(),
      "Simulates the event images of one cycle: int16 [transition, y, x], N - 1 transitions for N patterns.\n\n"
      "light_field: grey, [view_y, view_x, y, x]. codes: [N, view_y, view_x].\n"
      "camera: a Camera; constants, event_model and residue cannot be given for one with physical pixels.\n"
      "constants: SensorConstants; None = the camera's or the paper's.\n"
      "event_model: \"reference-aware\" (Eq. 9, 10) or \"quantised\" (Eq. 8); empty = the camera's, or the former.\n"
      "scene_gain: factor for all intensities.\n"
      "residue: references start at random up to this many thresholds (0 to 1) above the black level.\n"
      "seed: seed of the noise, which should differ from cycle to cycle. map_seed: seed of the constant properties of "
      "physical pixels; None = seed.");
  module.def(
      "coded_intensities",
      [](const py::array& light_field, const py::array& codes) {
        const auto scene = light_on_sensor(light_field);
        const capture::Codes patterns = codes_of(codes, "codes");
        auto seen = without_gil([&] { return sensor::coded_intensities(patterns, *scene); });
        return py::array_t<float>(std::vector<size_t>{seen.count, seen.height, seen.width}, seen.values.data());
      },
      py::arg("light_field"), py::arg("codes"),
      "Computes the intensities behind each pattern (Eq. 1): float32 [N, y, x], divided by the number of views.\n\n"
      "light_field: grey, [view_y, view_x, y, x]. codes: [N, view_y, view_x].");
}

}  // namespace e2lf::python
