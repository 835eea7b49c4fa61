// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/lightfield/views.h"
#include "python/binding/arrays.h"
#include "python/binding/recording.h"

/// The arguments of every function that opens a recording: the parameters of the C++ function, the OpenArguments made
/// of them, and the arguments in Python. They are macros, because pybind11 has no other way to share arguments.
#define E2LF_OPEN_PARAMETERS                                                                                     \
  const std::string &format, size_t width, size_t height, const std::string &stream, const std::string &columns, \
      const std::string &time_unit, const std::string &polarities, std::optional<int64_t> from_us,               \
      std::optional<int64_t> to_us, bool relative, bool shift_time, bool strict, int threads,                    \
      const std::string &restart, const std::optional<::e2lf::recordings::CameraSetup>&camera_setup
#define E2LF_OPEN_VALUES                                                                                          \
  ::e2lf::python::OpenArguments {                                                                                 \
    format, stream, columns, time_unit, polarities, restart, width, height, from_us, to_us, relative, shift_time, \
        strict, threads, camera_setup                                                                             \
  }
#define E2LF_OPEN_ARGUMENTS                                                                                        \
  py::arg("event_format") = "", py::arg("sensor_width") = 0, py::arg("sensor_height") = 0, py::arg("stream") = "", \
  py::arg("columns") = "", py::arg("time_unit") = ::e2lf::python::OpenArguments().time_unit,                       \
  py::arg("polarities") = "", py::arg("from_us") = py::none(), py::arg("to_us") = py::none(),                      \
  py::arg("relative") = false, py::arg("shift_time") = false, py::arg("strict") = false,                           \
  py::arg("threads") = ::e2lf::python::OpenArguments().threads,                                                    \
  py::arg("restart") = ::e2lf::python::OpenArguments().restart, py::arg("camera_setup") = py::none()
#define E2LF_OPEN_DOC                                                                                              \
  "\n\npath: a file, the folder of a bag of ROS 2, \"-\" for standard input, a named pipe, tcp://ADDRESS:PORT, "   \
  "camera://NAME or replay:FILE.\n"                                                                                \
  "event_format: format of the file if it cannot be detected.\n"                                                   \
  "sensor_width, sensor_height: size of the sensor in px if the file does not state it.\n"                         \
  "stream: number or name of a stream of events if there are several.\n"                                           \
  "columns: order of the columns of a table of events, e.g. \"txyp\".\n"                                           \
  "time_unit: unit of the times in tables: \"auto\", \"s\", \"ms\", \"us\" or \"ns\".\n"                           \
  "polarities: the numbers of OFF and ON in tables, e.g. \"1,2\"; empty = 0 and 1, or -1 and 1.\n"                 \
  "from_us, to_us: only from_us <= t < to_us is read, on the clock of the recording.\n"                            \
  "relative: whether from_us and to_us are relative to the first event or trigger.\n"                              \
  "shift_time: whether times begin at 0 instead of those of the sensor.\n"                                         \
  "strict: whether damage is an error; otherwise, the damaged part is left out and counted.\n"                     \
  "threads: number of threads for decoding; 0 = all cores.\n"                                                      \
  "restart: if the clock starts again: \"continue\" shifts the later part behind the earlier one, \"split\" ends " \
  "there (next_part() continues), \"refuse\" is an error.\n"                                                       \
  "camera_setup: the CameraSetup of a live camera; None = its current settings, with all of its trigger inputs."

/// The arguments of every function that can reorder the views; see above.
#define E2LF_ORIENTATION_PARAMETERS bool turn_views, bool flip_x, bool flip_y
#define E2LF_ORIENTATION_VALUE ::e2lf::python::orientation_of(turn_views, flip_x, flip_y)
#define E2LF_ORIENTATION_ARGUMENTS py::arg("turn_views") = false, py::arg("flip_x") = false, py::arg("flip_y") = false
#define E2LF_ORIENTATION_DOC                                                                                       \
  "turn_views, flip_x, flip_y: turn the grid of views by 180 degrees, exchange left and right views, or exchange " \
  "upper and lower views, which changes the sign of disparities.\n"

namespace e2lf::python {

/// Returns the combination of all arguments that are set.
inline capture::Orientation orientation_of(bool turn_views, bool flip_x, bool flip_y) {
  return capture::Orientation{flip_x, flip_y} + (turn_views ? capture::kTurned : capture::Orientation{});
}

/// Returns the light field with its views reordered.
inline LentLightField oriented(LentLightField field, const capture::Orientation& orientation) {
  if (orientation.flip_y) field.view = field.view.reversed(0);
  if (orientation.flip_x) field.view = field.view.reversed(1);
  return field;
}

/// Returns the name of an orientation, e.g. "turned", or nothing.
inline std::optional<std::string> orientation_word(const std::optional<capture::Orientation>& views) {
  return views ? std::optional<std::string>(capture::orientation_name(*views)) : std::nullopt;
}

inline constexpr const char* kViewsDoc =
    "Orientation of the views: \"upright\", \"turned\", \"flipped-x\", \"flipped-y\"; None if it is unknown.";

}  // namespace e2lf::python
