// SPDX-License-Identifier: MIT
// Binds the module model to Python.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/info/describe.h"
#include "e2lf/model/model.h"
#include "e2lf/model/model_parts.h"
#include "e2lf/video/video_model.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace fs = std::filesystem;
namespace {

using model::Model;
using video::VideoModel;

// What the two kinds of models have in common.
Json header_of(const Model& model) {
  if (model.open_guide) {  // the header and the weights of its views alone would be another network
    take(Result<void>(fail(ErrorCode::kInvalidValue, "", model.name,
                           " is adapted to the patterns that the camera showed; give them to Model()")
                          .about("codes")));
  }
  return model::header_to_json(model);
}
Json header_of(const VideoModel& model) {
  return video::video_header_to_json(model);
}
py::object codes_of_model(const Model& model) {
  return to_array(model.codes);
}
py::object codes_of_model(const VideoModel&) {
  return py::none();
}
Result<void> decode(std::span<const uint8_t> bytes, Model& model) {
  E2LF_ASSIGN_OR_RETURN(model, model::decode_model(bytes, "model"));
  return {};
}
Result<void> decode(std::span<const uint8_t> bytes, VideoModel& model) {
  E2LF_ASSIGN_OR_RETURN(model, video::decode_video_model(bytes, "model"));
  return {};
}

Tensor tensor_of(const py::array& array, const char* name) {
  const auto floats = floats_of(array, name);
  return make_npy<float>({floats.shape(), floats.shape() + floats.ndim()},
                         std::span(floats.data(), static_cast<size_t>(floats.size())));
}

/// Makes a model from the content of a file, which is checked as that of a file is.
template <typename AnyModel>
std::shared_ptr<AnyModel> model_of(const py::dict& header, const std::map<std::string, py::array>& weights,
                                   const std::optional<py::array>& codes) {
  Safetensors file;
  file.metadata[model::kMetadataKey] = json_line(from_python(header));
  for (const auto& [name, values] : weights) file.tensors[name] = tensor_of(values, name.c_str());
  if (codes) file.tensors["aperture.codes"] = tensor_of(*codes, "codes");
  auto model = std::make_shared<AnyModel>();
  without_gil([&] { return decode(encode_safetensors(file), *model); });
  return model;
}

template <typename AnyModel>
py::dict weights_of(const AnyModel& model) {
  py::dict weights;
  for (const model::WeightShape& tensor : model::weight_shapes(model.network)) {
    const std::vector<py::ssize_t> shape(tensor.shape.begin(), tensor.shape.end());
    weights[py::str(tensor.name)] = py::array_t<float>(shape, model.weights.at(tensor.name).data());
  }
  return weights;
}

/// Adds what both classes of models offer.
template <typename AnyModel>
void bind_common(py::class_<AnyModel, std::shared_ptr<AnyModel>>& bound) {
  bound.def_readonly("name", &AnyModel::name, "The name in the model file.")
      .def_property_readonly(
          "header", [](const AnyModel& self) { return to_python(header_of(self)); },
          "The content of the model file except its tensors, including the layers of the network.")
      .def_property_readonly("weights", &weights_of<AnyModel>,
                             "The weights of the network by name, float32 [out, in, kernel, kernel] or [out].")
      .def(
          "summary", [](const AnyModel& self) { return to_python(summary_json(self)); },
          "Returns the content of `e2lf model info --json`.")
      .def("__str__", [](const AnyModel& self) { return info::Description{summary_json(self)}.text(); })
      .def(py::pickle(
          [](const AnyModel& self) {
            return py::make_tuple(to_python(header_of(self)), weights_of(self), codes_of_model(self));
          },
          [](const py::tuple& parts) {
            return model_of<AnyModel>(parts[0].cast<py::dict>(), parts[1].cast<std::map<std::string, py::array>>(),
                                      parts[2].cast<std::optional<py::array>>());
          }));
}

}  // namespace

std::shared_ptr<Model> read_model(const fs::path& name, const std::optional<py::array>& codes) {
  const auto patterns = codes ? std::optional(codes_of(*codes, "codes")) : std::nullopt;
  return std::make_shared<Model>(without_gil([&]() -> Result<Model> {
    E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledModels, name.string()));
    E2LF_ASSIGN_OR_RETURN(Model model, model::read_model(path));
    if (patterns && *patterns == model.codes && !model.open_guide) {
      model.is_adapted = true;  // as pipeline::open_method() uses its own patterns
      return model;
    }
    if (patterns) return geometry::for_patterns(model, *patterns);
    return geometry::for_own_patterns(std::move(model));
  }));
}

namespace {

std::shared_ptr<VideoModel> read_video_model(const fs::path& path) {
  return std::make_shared<VideoModel>(without_gil([&] { return video::read_video_model(path); }));
}

void bind_light_field_model(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>> bound(module, "Model", "The content of a model file.");
  bound
      .def(py::init(&read_model), py::arg("name"), py::arg("codes") = py::none(), "Reads a model as read_model() does.")
      .def_static("of", &model_of<Model>, py::arg("header"), py::arg("weights"), py::arg("codes") = py::none(),
                  "Makes a model from its parts, which are checked as those of a file.\n\n"
                  "header, weights: as the properties of the same names. codes: the patterns [N, view_y, view_x].")
      .def_readonly("num_patterns", &Model::num_patterns,
                    "The number N of patterns; reconstruction takes N - 1 event images.")
      .def_property_readonly(
          "views", [](const Model& self) { return py::make_tuple(self.views_y, self.views_x); },
          "The number of views, (view_y, view_x).")
      .def_property_readonly(
          "codes", [](const Model& self) { return to_array(self.codes); },
          "The patterns, float32 [N, view_y, view_x]; None if the model does not contain them.")
      .def_readonly("event_model", &Model::event_model, "The event model for which it was trained.")
      .def_readonly("black_first", &Model::black_first, "Whether the first pattern is black.")
      .def_readonly("constants", &Model::constants, "The sensor constants for which it was trained.")
      .def_readonly("camera", &Model::camera, "The camera that is used unless another is given, or None.")
      .def_property_readonly(
          "is_conditioned_on_camera", [](const Model& self) { return model::is_conditioned_on_camera(self); },
          "Whether the network is conditioned on the sensor profile and accepts sums over cycles.")
      .def("__repr__", [](const Model& self) { return "<e2lf.Model " + self.name + ">"; });
  bind_common(bound);
  module.def("read_model", &read_model, py::arg("path"), py::arg("codes") = py::none(),
             "Reads a model.\n\npath: a model file, or the name of a bundled model, such as \"e2lf-n4\". codes: the "
             "patterns [N, view_y, view_x] to which a network for any patterns, such as \"e2lf-any\", is adapted.");
  module.def(
      "write_model",
      [](const fs::path& path, const Model& model, bool overwrite) {
        write_output(path, overwrite, [&](const fs::path& place) { return model::write_model(place, model); });
      },
      py::arg("path"), py::arg("model"), py::kw_only(), py::arg("overwrite") = false,
      "Writes a model file.\n\nmodel: a Model.");
}

void bind_video_model(py::module_& module) {
  py::class_<VideoModel, std::shared_ptr<VideoModel>> bound(
      module, "VideoModel", "A model file whose network makes frames from voxel grids.\n\npath: the model file.");
  bound.def(py::init(&read_video_model), py::arg("path"))
      .def_static(
          "of",
          [](const py::dict& header, const std::map<std::string, py::array>& weights) {
            return model_of<VideoModel>(header, weights, std::nullopt);
          },
          py::arg("header"), py::arg("weights"),
          "Makes a model from its parts, which are checked as those of a file.\n\n"
          "header, weights: as the properties of the same names, the latter [out, in, kernel, kernel] or [out].")
      .def_readonly("bins", &VideoModel::bins, "The number of bins of the voxel grids.")
      .def("__repr__", [](const VideoModel& self) { return "<e2lf.VideoModel " + self.name + ">"; });
  bind_common(bound);
}

}  // namespace

void bind_model(py::module_& module) {
  bind_light_field_model(module);
  bind_video_model(module);
}

}  // namespace e2lf::python
