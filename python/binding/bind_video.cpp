// SPDX-License-Identifier: MIT
// Binds networks for frames to Python.
#include <algorithm>
#include <pybind11/stl.h>

#include "e2lf/base/text.h"
#include "e2lf/video/video_model.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

/// A network for frames, with its memory of previous frames.
class Video {
 public:
  Video(const video::VideoModel& model, size_t width, size_t height, const std::string& precision)
      : width_(width), height_(height), tone_(model.tone), video_(without_gil([&]() -> Result<video::EventVideo> {
          E2LF_ASSIGN_OR_RETURN(const engine::Precision number, choice_of(precision, engine::kPrecisions, "precision"));
          return video::EventVideo::create(model, height, width, {.precision = number});
        })) {}

  py::array next(const py::array& grid, bool toned) {
    const auto floats = floats_of(grid, "grid");
    const size_t bins = video_.model().bins;
    if (floats.ndim() != 3 || static_cast<size_t>(floats.shape(0)) != bins ||
        static_cast<size_t>(floats.shape(1)) != height_ || static_cast<size_t>(floats.shape(2)) != width_) {
      throw ResultError({ErrorCode::kShape, cat("give a grid [", bins, ", ", height_, ", ", width_, "]"), "grid"});
    }
    capture::VoxelGrid planes(bins, height_, width_);
    std::copy_n(floats.data(), floats.size(), planes.values.begin());
    const OneAtATime::Use use(use_, "network for frames");
    std::vector<float> frame = without_gil([&] { return video_.next(std::move(planes)); });
    if (toned) video::apply_frame_tone(tone_, frame);
    return py::array_t<float>(std::vector<size_t>{height_, width_}, frame.data());
  }

  void reset() {
    const OneAtATime::Use use(use_, "network for frames");
    video_.reset();
  }

 private:
  size_t width_, height_;
  video::FrameTone tone_;
  video::EventVideo video_;
  OneAtATime use_;
};

}  // namespace

void bind_video(py::module_& module) {
  py::class_<Video>(module, "FrameReconstructor",
                    "Makes grey frames from the voxel grids of consecutive windows. The network remembers the frames "
                    "before.\n\nmodel: a VideoModel. width, height: size of the sensor in px.\n"
                    "precision: \"auto\", \"float32\" or \"bfloat16\".")
      .def(py::init(
               [](const video::VideoModel& model, Whole<size_t> width, Whole<size_t> height,
                  const std::string& precision) { return std::make_unique<Video>(model, width, height, precision); }),
           py::arg("model"), py::arg("width"), py::arg("height"), py::kw_only(), py::arg("precision") = "auto")
      .def("next", &Video::next, py::arg("grid"), py::kw_only(), py::arg("toned") = true,
           "Returns the frame of the next window, float32 [y, x].\n\n"
           "grid: float32 [bin, y, x], as voxel_grid() returns it.\n"
           "toned: whether to map the frame to [0, 1] as the model requires; if not, it is the network's output.")
      .def("reset", &Video::reset, "Forgets the frames before.");
}

}  // namespace e2lf::python
