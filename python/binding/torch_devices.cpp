// SPDX-License-Identifier: MIT
// Networks on the devices of PyTorch, which the modules of e2lf.torch compute: a Reconstructor accepts their names.
#include <algorithm>
#include <cstring>
#include <pybind11/numpy.h>

#include "e2lf/engine/engine.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

/// Calls e2lf.torch.device, which needs the GIL; its exceptions become errors.
template <typename Work>
auto call_torch(const Work& work) -> decltype(work(py::module_())) {
  const py::gil_scoped_acquire gil;
  try {
    return work(py::module_::import("e2lf.torch.device"));
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_ImportError)) {
      return fail(ErrorCode::kMissingDependency, "", "networks on other devices need PyTorch (", error.what(),
                  "); install it, e.g. python3-torch of Debian, or use the device cpu");
    }
    if (error.matches(PyExc_LookupError)) {
      return fail(ErrorCode::kMissingDependency, "", error.value().attr("args")[py::int_(0)].cast<std::string>());
    }
    if (error.matches(PyExc_ValueError)) {
      return fail(ErrorCode::kUnsupported, "", error.value().attr("args")[py::int_(0)].cast<std::string>());
    }
    return fail(ErrorCode::kInternal, "", "PyTorch failed: ", error.what());
  }
}

class ModuleNetwork : public engine::DeviceNetwork {
 public:
  /// `module` is a Network of e2lf.torch.device.
  explicit ModuleNetwork(py::object module) : module_(std::move(module)) {}
  ModuleNetwork(const ModuleNetwork&) = delete;
  ModuleNetwork& operator=(const ModuleNetwork&) = delete;
  ~ModuleNetwork() override {
    const py::gil_scoped_acquire gil;
    module_ = py::object();
  }

  [[nodiscard]] Result<void> run(std::span<const float> input, size_t height, size_t width,
                                 std::span<float> output) const override {
    return call_torch([&](const py::module_&) -> Result<void> {
      const py::array_t<float> planes({input.size() / (height * width), height, width}, input.data());
      const auto result = py::array_t<float, py::array::c_style>::ensure(module_.attr("run")(planes));
      E2LF_REQUIRE(result && static_cast<size_t>(result.size()) == output.size(), "the output has another size");
      std::memcpy(output.data(), result.data(), output.size_bytes());
      return {};
    });
  }

  [[nodiscard]] engine::Precision precision() const override {
    const py::gil_scoped_acquire gil;
    return choice_of(module_.attr("precision").cast<std::string>(), engine::kPrecisions).value();
  }
  [[nodiscard]] std::vector<std::string> describe() const override {
    const py::gil_scoped_acquire gil;
    return {module_.attr("description").cast<std::string>()};
  }

 private:
  py::object module_;
};

Result<std::shared_ptr<const engine::DeviceNetwork>> open_network(const model::Network& network,
                                                                  const model::Weights& weights,
                                                                  const engine::EngineOptions& options) {
  E2LF_RETURN_IF_ERROR(model::infer_shapes(network));  // the sizes are those that the engine accepts
  using Opened = Result<std::shared_ptr<const engine::DeviceNetwork>>;
  return call_torch([&](const py::module_& devices) -> Opened {
    py::dict arrays;
    for (const auto& [name, values] : weights) {
      arrays[py::str(name)] = py::array_t<float>(static_cast<py::ssize_t>(values.size()), values.data());
    }
    const bool is_checked = std::ranges::find(options.checked, engine::Precision::kBfloat16) != options.checked.end();
    py::object module = devices.attr("Network")(to_python(to_json(network)), arrays, options.device,
                                                word_of(options.precision, engine::kPrecisions), is_checked);
    return std::shared_ptr<const engine::DeviceNetwork>(std::make_shared<ModuleNetwork>(std::move(module)));
  });
}

}  // namespace

void add_torch_devices() {
  const auto check = [](const std::string& name) {
    return call_torch([&](const py::module_& devices) -> Result<void> {
      devices.attr("device_of")(name);
      return {};
    });
  };
  for (const char* kind : {"cuda", "torch-cpu"}) engine::add_device_kind(kind, {check, open_network});
}

}  // namespace e2lf::python
