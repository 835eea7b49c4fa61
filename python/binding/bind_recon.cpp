// SPDX-License-Identifier: MIT
// Binds the module recon to Python.
#include <filesystem>
#include <memory>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <variant>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/model/model.h"
#include "e2lf/pipeline/event_depth.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/recon/event_check.h"
#include "e2lf/recon/fusion.h"
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
  if (!(number > 0) || std::isinf(number)) throw py::value_error("a gain is \"auto\" or a number above 0");
  return {.gain = static_cast<float>(number)};
}

/// The event images that a network is given: those of one cycle, sums over several, or fused ones.
class GivenImages {
 public:
  GivenImages(const py::object& images, size_t cycles) : cycles_(cycles) {
    if (cycles < 1) throw py::value_error("cycles are at least 1");
    if (py::isinstance(images, py::module_::import("e2lf._types").attr("FusedCycles"))) {
      refuse_cycles("fused cycles");
      set_fused(images);
      return;
    }
    py::array array = array_of(images);
    if (array.ndim() == 4 && array.shape(0) > 0) {
      refuse_cycles("images of several cycles");
      cycles_ = static_cast<size_t>(array.shape(0));
      array = array.attr("sum")(0);
    }
    events_ = event_images_of(array, "images");
    view_ = *events_;
  }

  [[nodiscard]] const capture::MeasurementView& view() const { return view_; }
  [[nodiscard]] size_t cycles() const { return cycles_; }
  [[nodiscard]] pipeline::MethodUse use(size_t passes = 1) const {
    return {.passes = passes, .cycles = cycles_, .fused_cycles = view_.is_fused() ? recon::kMostFusedCycles : 1};
  }
  /// Returns a copy of the images, as depth_of_events() takes them.
  [[nodiscard]] capture::Measurement measurement() const {
    capture::Measurement measurement(owned(view_.events));
    if (view_.is_fused()) measurement.fused = {owned(view_.fused), owned(view_.cycles)};
    return measurement;
  }

 private:
  static py::array array_of(const py::object& images) {
    py::array array = py::array::ensure(images);
    if (!array) throw py::type_error("images are an array or FusedCycles");
    return array;
  }

  void refuse_cycles(const char* what) const {
    if (cycles_ == 1) return;
    throw py::value_error(cat("the number of cycles follows from ", what, "; leave cycles out"));
  }

  void set_fused(const py::object& fused) {
    events_ = event_images_of(array_of(fused.attr("images")), "images");
    counts_ = event_images_of(array_of(fused.attr("counts")), "counts");
    number_ = floats_of(array_of(fused.attr("cycles")), "cycles");
    view_ = *events_;
    view_.fused = *counts_;
    const auto [transitions, height, width] = view_.events.extents;
    const bool fits = number_.ndim() == 2 && static_cast<size_t>(number_.shape(0)) == height &&
                      static_cast<size_t>(number_.shape(1)) == width;
    if (!fits || view_.fused.extents != view_.events.extents) {
      throw py::value_error("fused counts are [transition, y, x] as the images, and their cycles [y, x]");
    }
    view_.cycles = PlanesView<const float>(number_.data(), {1, height, width});
    std::vector<float> scratch;
    const auto values = view_.cycles.values(scratch);
    if (!std::ranges::all_of(values, [](float cycles) { return cycles >= 1 && std::isfinite(cycles); })) {
      throw py::value_error("the numbers of fused cycles are at least 1");
    }
  }

  size_t cycles_;
  LentImages events_, counts_;
  py::array_t<float, py::array::c_style> number_;
  capture::MeasurementView view_ = capture::MeasurementView(PlanesView<const int16_t>());
};

/// Fuses the cycles of a recording.
class Fusion {
 public:
  Fusion(const capture::SensorProfile& camera, Whole<size_t> most_cycles) : fusion_(camera, in_range(most_cycles)) {}

  py::object add(const py::array& images) {
    const auto counts = event_images_of(images, "images");
    const OneAtATime::Use use(use_, "fusion");
    capture::FusedCycles fused = without_gil([&]() -> Result<capture::FusedCycles> {
      if (counts->size() == 0) return fail(ErrorCode::kShape, "images", "there are no pixels; give event images");
      fusion_.add(*counts);
      return fusion_.fused();
    });
    lightfield::Image cycles(fused.cycles.width, fused.cycles.height, 1);
    cycles.pixels = std::move(fused.cycles.values);
    return make_tuple_of("FusedCycles", images, to_array(std::move(fused.counts)), to_array(std::move(cycles)));
  }

  [[nodiscard]] double changed() const { return fusion_.changed(); }

 private:
  static size_t in_range(size_t cycles) {
    if (cycles >= 1 && cycles <= recon::kMostFusedCycles) return cycles;
    throw py::value_error(cat("most_cycles is from 1 to ", recon::kMostFusedCycles));
  }

  recon::CycleFusion fusion_;
  OneAtATime use_;
};

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
    if (model::is_depth_network(*choice.model)) choice.algorithm = pipeline::Algorithm::kDepth;
    if (camera != nullptr) choice.camera = *camera;
    if (model::is_for_any_patterns(*choice.model) && !choice.model->is_adapted && choice.model->codes) {
      log_warning(cat(choice.model->name,
                      ": it is assumed that the camera showed the patterns of this file; state its "
                      "patterns as the codes of Model()"));
    }
    method_ = without_gil([&] { return pipeline::open_method(std::move(choice)); });
  }

  py::array reconstruct(const py::object& images, const GainArgument& gain, Whole<size_t> passes, Whole<size_t> cycles,
                        E2LF_ORIENTATION_PARAMETERS, const std::optional<py::array>& out,
                        const ProgressArgument& progress) {
    if (gives_depth()) throw py::value_error("this network gives disparities and no light field; call depth()");
    pipeline::Tone tone = tone_of(gain);
    if (passes < 1) throw py::value_error("passes are at least 1");
    const GivenImages given(images, cycles);
    const capture::MeasurementView& counts = given.view();
    const ProgressFn told = progress_of(progress);
    const OneAtATime::Use use(use_, "reconstructor");
    if (!out) {
      return to_array(without_gil(
          [&] { return reconstruct_once(method_, given.use(passes), tone, counts, E2LF_ORIENTATION_VALUE, told); }));
    }
    if (passes > 1) throw py::value_error("out takes one pass");
    take(method_.ready(given.use()));
    const LightFieldOutput field = output_of(*out, method_.network->field_shape(counts), "out");
    without_gil([&]() -> Result<void> {
      recon::ReconstructionMemory memory;
      E2LF_RETURN_IF_ERROR(method_.network->reconstruct_into(counts, given.cycles(), {}, memory, field, told));
      tone = method_.complete(tone);
      pipeline::apply_tone(counts, field, tone);
      lightfield::orient(field, E2LF_ORIENTATION_VALUE);
      return {};
    });
    return *out;
  }

  py::object depth(const py::object& images, Whole<size_t> cycles, E2LF_ORIENTATION_PARAMETERS,
                   const ProgressArgument& progress) {
    if (!gives_depth()) throw py::value_error("this network gives light fields; estimate their depth by e2lf.depth()");
    const GivenImages given(images, cycles);
    const ProgressFn told = progress_of(progress);
    const OneAtATime::Use use(use_, "reconstructor");
    depth::DisparityMap map = without_gil([&]() -> Result<depth::DisparityMap> {
      E2LF_RETURN_IF_ERROR(method_.ready(given.use()));
      E2LF_ASSIGN_OR_RETURN(
          pipeline::EventDepth found,
          pipeline::depth_of_events(method_, given.measurement(), given.cycles(), E2LF_ORIENTATION_VALUE, told));
      return std::move(found.map);
    });
    return make_tuple_of("DisparityMap", to_array(std::move(map.disparity)), to_array(std::move(map.confidence)),
                         std::pair(map.view.y, map.view.x), std::pair(map.range.least, map.range.most));
  }

  [[nodiscard]] std::string precision() const { return word_of(engine().precision(), engine::kPrecisions); }
  [[nodiscard]] std::vector<std::string> kernels() const { return engine().describe(); }

 private:
  [[nodiscard]] bool gives_depth() const { return model::is_depth_network(method_.network->model()); }
  [[nodiscard]] const engine::Engine& engine() const { return method_.network->engine(); }
  pipeline::OpenedMethod method_;
  OneAtATime use_;
};

py::array invert(const py::array& images, const py::array& codes,
                 const std::optional<capture::SensorConstants>& constants, const capture::SensorProfile* camera,
                 const GainArgument& gain, E2LF_ORIENTATION_PARAMETERS) {
  const pipeline::Tone tone = tone_of(gain);
  const auto counts = event_images_of(images, "images");
  const auto method = take(pipeline::open_method({.algorithm = pipeline::Algorithm::kInversion,
                                                  .codes = codes_of(codes, "codes"),
                                                  .camera = camera != nullptr ? std::optional(*camera) : std::nullopt,
                                                  .constants = constants}));
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
  py::class_<Fusion>(
      module, "CycleFusion",
      "Fuses the cycles of a scene of which parts move, as `e2lf reconstruct --fuse` does: each pixel is "
      "the mean of the cycles since the scene last changed there.\n\n"
      "camera: the Camera that recorded the events, whose noise tells changes.\n"
      "most_cycles: largest number of cycles in a mean, 1 to 64.")
      .def(py::init<const capture::SensorProfile&, Whole<size_t>>(), py::arg("camera"), py::arg("most_cycles") = 16)
      .def("add", &Fusion::add, py::arg("images"),
           "Adds the event images int16 [transition, y, x] of the next cycle, and returns FusedCycles for "
           "Reconstructor.reconstruct() and Reconstructor.depth().")
      .def_property_readonly("changed", &Fusion::changed,
                             "Share of the pixels that started again with the last cycle; 1 for the first one.")
      .def("__repr__", [](const Fusion&) { return "<e2lf.CycleFusion>"; });
  py::class_<Network>(
      module, "Reconstructor",
      "Reconstructs light fields from event images with one model. It is created once and used for every cycle, by one "
      "thread at a time.\n\n"
      "model: a Model, the name of a bundled model, or the path of a model file.\n"
      "precision: \"auto\", \"float32\", \"bfloat16\" or \"int16\".\n"
      "camera: the Camera that recorded the events, for networks conditioned on the sensor profile; None = that of the "
      "model.\n"
      "device: \"cpu\", or with PyTorch \"cuda\", \"cuda:N\" or \"torch-cpu\", as the option --device of the command "
      "line.")
      .def(py::init<const ModelArgument&, const std::string&, const capture::SensorProfile*, const std::string&>(),
           py::arg("model"), py::kw_only(), py::arg("precision") = "auto", py::arg("camera") = nullptr,
           py::arg("device") = "cpu")
      .def("reconstruct", &Network::reconstruct, py::arg("images"), py::kw_only(), py::arg("gain") = "auto",
           py::arg("passes") = 1, py::arg("cycles") = 1, E2LF_ORIENTATION_ARGUMENTS, py::arg("out") = py::none(),
           py::arg("progress") = py::none(),
           "Reconstructs a light field float32 [view_y, view_x, y, x], not clamped, from event images int16 "
           "[transition, y, x].\n\n"
           "images: event images of one cycle; or [cycle, transition, y, x], from which networks conditioned on the "
           "sensor profile reconstruct one light field of a static scene; or FusedCycles, for the same networks.\n"
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
          "images: int16 [transition, y, x], or [cycle, transition, y, x] of a static scene, or FusedCycles.\n"
          "cycles: number of cycles over which `images` were summed.\n" E2LF_ORIENTATION_DOC
          "progress: called with (done, total); an exception cancels the operation.")
      .def_property_readonly("precision", &Network::precision, "The precision that \"auto\" selected.")
      .def_property_readonly("kernels", &Network::kernels, "The kernel of each layer.")
      .def("__repr__", [](const Network& self) { return "<e2lf.Reconstructor in " + self.precision() + ">"; });
  module.def(
      "invert", &invert, py::arg("images"), py::arg("codes"), py::kw_only(), py::arg("constants") = py::none(),
      py::arg("camera") = nullptr, py::arg("gain") = "auto", E2LF_ORIENTATION_ARGUMENTS,
      "Reconstructs a light field without a trained network: float32 [view_y, view_x, y, x].\n\n"
      "images: int16 [transition, y, x]. codes: the patterns, [N, view_y, view_x].\n"
      "constants: SensorConstants of the camera; None = the paper's.\n"
      "camera: the Camera that recorded the events; with physical pixels, the gain \"auto\" makes the darkest parts "
      "black.\n"
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
