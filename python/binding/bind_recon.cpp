// SPDX-License-Identifier: MIT
// Binds the module recon to Python.
#include <filesystem>
#include <memory>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <variant>

#include "e2lf/model/model.h"
#include "e2lf/pipeline/event_depth.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/recon/event_check.h"
#include "e2lf/recon/reconstruct.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

using GainArgument = std::variant<double, std::string>;
using ModelArgument = std::variant<std::shared_ptr<model::Model>, std::filesystem::path>;

model::Model model_of(const ModelArgument& model) {
  if (const auto* read = std::get_if<std::shared_ptr<model::Model>>(&model)) return **read;
  return *read_model(std::get<std::filesystem::path>(model));
}

pipeline::Tone tone_of(const GainArgument& gain) {
  if (const auto* word = std::get_if<std::string>(&gain)) {
    check_word(*word, {"auto"}, "gain");
    return {.black = std::nullopt};
  }
  const double number = std::get<double>(gain);
  if (!(number > 0)) throw py::value_error("a gain is \"auto\" or above 0");
  return {.gain = static_cast<float>(number)};
}

/// Reconstructs the light field of event images.
Result<lightfield::LightField> reconstruct_once(const pipeline::OpenedMethod& method, const pipeline::MethodUse& use,
                                                pipeline::Tone tone, const capture::MeasurementView& images,
                                                const capture::Orientation& orientation, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const recon::Method reconstruct, method.ready(use));
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField field, reconstruct(images, progress));
  tone = method.complete(tone);
  pipeline::apply_tone(images, field, tone);
  lightfield::orient(field, orientation);
  return field;
}

/// A network that is ready to run.
class Network {
 public:
  Network(const ModelArgument& model, const std::string& precision, const capture::SensorProfile* camera,
          const std::string& device) {
    pipeline::MethodChoice choice{.model = model_of(model), .precision = precision, .device = device};
    choice.measurement = choice.model->measurement();
    if (model::is_depth_network(*choice.model)) choice.algorithm = "depth";
    if (camera != nullptr) choice.camera = *camera;
    method_ = without_gil([&] { return pipeline::open_method(std::move(choice)); });
  }

  py::array reconstruct(py::array images, const GainArgument& gain, Whole<size_t> passes, Whole<size_t> cycles,
                        E2LF_ORIENTATION_PARAMETERS, const std::optional<py::array>& out,
                        const ProgressArgument& progress) {
    if (gives_depth()) throw py::value_error("this network gives disparities and no light field; call depth()");
    pipeline::Tone tone = tone_of(gain);
    if (passes < 1) throw py::value_error("passes are at least 1");
    sum_cycles(images, cycles);
    const auto counts = event_images_of(images, "images");
    const ProgressFn told = progress_of(progress);
    const OneAtATime::Use use(use_, "reconstructor");
    if (!out) {
      return to_array(without_gil([&] {
        return reconstruct_once(method_, {passes, cycles}, tone, *counts, E2LF_ORIENTATION_VALUE, told);
      }));
    }
    if (passes > 1) throw py::value_error("out takes one pass");
    take(method_.ready({passes, cycles}));
    const LightFieldOutput field = output_of(*out, method_.network->field_shape(*counts), "out");
    without_gil([&]() -> Result<void> {
      recon::ReconstructionMemory memory;
      E2LF_RETURN_IF_ERROR(method_.network->reconstruct_into(*counts, cycles, {}, memory, field, told));
      tone = method_.complete(tone);
      pipeline::apply_tone(*counts, field, tone);
      lightfield::orient(field, E2LF_ORIENTATION_VALUE);
      return {};
    });
    return *out;
  }

  py::object depth(py::array images, Whole<size_t> cycles, E2LF_ORIENTATION_PARAMETERS,
                   const ProgressArgument& progress) {
    if (!gives_depth()) throw py::value_error("this network gives light fields; estimate their depth by e2lf.depth()");
    sum_cycles(images, cycles);
    const auto counts = event_images_of(images, "images");
    const ProgressFn told = progress_of(progress);
    const OneAtATime::Use use(use_, "reconstructor");
    depth::DisparityMap map = without_gil([&]() -> Result<depth::DisparityMap> {
      E2LF_ASSIGN_OR_RETURN(pipeline::EventDepth found,
                            pipeline::depth_of_events(method_, capture::Measurement(owned(*counts)), cycles,
                                                      E2LF_ORIENTATION_VALUE, told));
      return std::move(found.map);
    });
    return make_tuple_of("DisparityMap", to_array(std::move(map.disparity)), to_array(std::move(map.confidence)),
                         std::pair(map.view.y, map.view.x), std::pair(map.range.least, map.range.most));
  }

  [[nodiscard]] std::string precision() const { return word_of(engine().precision(), engine::kPrecisions); }
  [[nodiscard]] std::vector<std::string> kernels() const { return engine().describe(); }

 private:
  /// Replaces images of several cycles by their sum.
  static void sum_cycles(py::array& images, Whole<size_t>& cycles) {
    if (cycles < 1) throw py::value_error("cycles are at least 1");
    if (images.ndim() != 4 || images.shape(0) == 0) return;
    if (cycles != 1) {
      throw py::value_error("the number of cycles follows from images of several cycles; leave cycles out");
    }
    cycles = static_cast<size_t>(images.shape(0));
    images = images.attr("sum")(0);
  }

  [[nodiscard]] bool gives_depth() const { return model::is_depth_network(method_.network->model()); }
  [[nodiscard]] const engine::Engine& engine() const { return method_.network->engine(); }
  pipeline::OpenedMethod method_;
  OneAtATime use_;
};

py::array invert(const py::array& images, const py::array& codes,
                 const std::optional<capture::SensorConstants>& constants, const GainArgument& gain,
                 E2LF_ORIENTATION_PARAMETERS) {
  const pipeline::Tone tone = tone_of(gain);
  const auto counts = event_images_of(images, "images");
  const auto method = take(pipeline::open_method({.algorithm = "inversion",
                                                  .codes = codes_of(codes, "codes"),
                                                  .constants = constants.value_or(capture::SensorConstants())}));
  return to_array(without_gil([&] { return reconstruct_once(method, {}, tone, *counts, E2LF_ORIENTATION_VALUE, {}); }));
}

py::dict event_error(const py::array& light_field, const py::array& images, const py::array& codes, float gain,
                     const std::optional<capture::SensorConstants>& constants, const std::string& event_model,
                     const capture::SensorProfile* camera) {
  const auto field = light_field_of(light_field, "light_field");
  const auto counts = event_images_of(images, "images");
  recon::EventCheck check{codes_of(codes, "codes"), constants.value_or(capture::SensorConstants()),
                          take(sensor::event_model_from_name(event_model))};
  if (camera != nullptr && camera->is_pixel()) check.pixels = *camera;
  const recon::EventError error = without_gil([&] { return recon::event_error(check, *field, gain, *counts); });
  py::dict result;
  result["at_first"] = error.at_first;
  result["least"] = error.least;
  result["residue"] = error.residue;
  return result;
}

}  // namespace

void bind_recon(py::module_& module) {
  py::class_<Network>(
      module, "Reconstructor",
      "Reconstructs light fields from event images with one model. It is created once and used for every cycle, by one "
      "thread at a time.\n\n"
      "model: a Model, the name of a bundled model, or the path of a model file.\n"
      "precision: \"auto\", \"float32\", \"bfloat16\" or \"int16\".\n"
      "camera: the Camera that recorded the events, for networks conditioned on the sensor profile; None = that of the "
      "model.\n"
      "device: \"cpu\". On a GPU, networks run as modules of e2lf.torch and by the command line (--device).")
      .def(py::init<const ModelArgument&, const std::string&, const capture::SensorProfile*, const std::string&>(),
           py::arg("model"), py::kw_only(), py::arg("precision") = "auto", py::arg("camera") = nullptr,
           py::arg("device") = "cpu")
      .def("reconstruct", &Network::reconstruct, py::arg("images"), py::kw_only(), py::arg("gain") = "auto",
           py::arg("passes") = 1, py::arg("cycles") = 1, E2LF_ORIENTATION_ARGUMENTS, py::arg("out") = py::none(),
           py::arg("progress") = py::none(),
           "Reconstructs a light field float32 [view_y, view_x, y, x], not clamped, from event images int16 "
           "[transition, y, x].\n\n"
           "images: event images of one cycle, or [cycle, transition, y, x], from which networks conditioned on the "
           "sensor profile reconstruct one light field of a static scene.\n"
           "gain: \"auto\" (well exposed; with physical pixels, the darkest parts become black) or a number; 1 = the "
           "output of the network.\n"
           "passes: number of shifted positions on the pixel grid of the network over which the result is averaged.\n"
           "cycles: number of cycles over which `images` were summed, for networks conditioned on the sensor "
           "profile.\n" E2LF_ORIENTATION_DOC
           "out: float32 [view_y, view_x, y, x] that receives the light field and is returned; None = a new array.\n"
           "progress: called with (done, total); an exception cancels the operation.")
      .def(
          "depth", &Network::depth, py::arg("images"), py::kw_only(), py::arg("cycles") = 1, E2LF_ORIENTATION_ARGUMENTS,
          py::arg("progress") = py::none(),
          "Estimates the disparity of view (4, 4), or (3, 3) of turned views, from event images, with a depth network. "
          "Returns a DisparityMap with "
          "disparity and confidence, float32 [y, x].\n\n"
          "images: int16 [transition, y, x], or [cycle, transition, y, x] of a static scene.\n"
          "cycles: number of cycles over which `images` were summed.\n" E2LF_ORIENTATION_DOC
          "progress: called with (done, total); an exception cancels the operation.")
      .def_property_readonly("precision", &Network::precision, "The precision that \"auto\" selected.")
      .def_property_readonly("kernels", &Network::kernels, "The kernel of each layer.")
      .def("__repr__", [](const Network& self) { return "<e2lf.Reconstructor in " + self.precision() + ">"; });
  module.def("invert", &invert, py::arg("images"), py::arg("codes"), py::kw_only(), py::arg("constants") = py::none(),
             py::arg("gain") = "auto", E2LF_ORIENTATION_ARGUMENTS,
             "Reconstructs a light field without a trained network: float32 [view_y, view_x, y, x].\n\n"
             "images: int16 [transition, y, x]. codes: the patterns, [N, view_y, view_x].\n"
             "constants: SensorConstants of the camera; None = the paper's.\n"
             "gain: \"auto\" or a number.\n"
             "turn_views, flip_x, flip_y: as for Reconstructor.reconstruct().");
  module.def(
      "auto_gain",
      [](const py::array& light_field) {
        const auto field = light_field_of(light_field, "light_field");
        return without_gil([&]() -> Result<float> { return recon::auto_gain(*field); });
      },
      py::arg("light_field"),
      "Returns the factor that makes a light field well exposed.\n\n"
      "light_field: [view_y, view_x, y, x], or with [channel].");
  module.def(
      "event_error", &event_error, py::arg("light_field"), py::arg("images"), py::arg("codes"), py::kw_only(),
      py::arg("gain") = 1.0F, py::arg("constants") = py::none(), py::arg("event_model") = "reference-aware",
      py::arg("camera") = nullptr,
      "Computes how well a light field explains event images: means of |simulated - given| over pixels and "
      "transitions.\n\n"
      "light_field: grey, [view_y, view_x, y, x]. images: int16 [transition, y, x]. codes: [N, view_y, view_x].\n"
      "gain: factor by which the light field was multiplied.\n"
      "constants, event_model: as for simulate().\n"
      "camera: a Camera with physical pixels, which replaces constants and event_model.\n"
      "Returns a dict: at_first (references start at the first level), least (references start `residue` thresholds "
      "above it), residue.");
}

}  // namespace e2lf::python
