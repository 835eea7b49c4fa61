// SPDX-License-Identifier: MIT
#pragma once

#include "python/binding/recording.h"

/// The arguments of every function that opens a recording: the parameters of the C++ function, what it makes of them,
/// and how Python calls them. One list each, since pybind11 has no other way to share arguments.
#define E2LF_OPEN_PARAMETERS                                                                                     \
  const std::string &format, size_t width, size_t height, const std::string &stream, const std::string &columns, \
      const std::string &time_unit, std::optional<int64_t> from_us, std::optional<int64_t> to_us, bool relative, \
      bool shift_time, bool strict, int threads, const std::string &restart,                                     \
      const std::optional<::e2lf::recordings::CameraSetup>&camera_setup
#define E2LF_OPEN_VALUES                                                                                               \
  ::e2lf::python::OpenArguments {                                                                                      \
    format, stream, columns, time_unit, restart, width, height, from_us, to_us, relative, shift_time, strict, threads, \
        camera_setup                                                                                                   \
  }
#define E2LF_OPEN_ARGUMENTS                                                                    \
  py::arg("format") = "", py::arg("width") = 0, py::arg("height") = 0, py::arg("stream") = "", \
  py::arg("columns") = "", py::arg("time_unit") = "auto", py::arg("from_us") = py::none(),     \
  py::arg("to_us") = py::none(), py::arg("relative") = false, py::arg("shift_time") = false,   \
  py::arg("strict") = false, py::arg("threads") = 0, py::arg("restart") = "continue",          \
  py::arg("camera_setup") = py::none()
#define E2LF_OPEN_DOC                                                                                                \
  "\n\npath: a file, the folder of a bag of ROS 2, \"-\" for standard input, a named pipe, tcp://ADDRESS:PORT, "     \
  "camera://NAME or replay:FILE.\n"                                                                                  \
  "format: where the file does not tell.\n"                                                                          \
  "width, height: of the sensor in px, where the file does not tell.\n"                                              \
  "stream: number or name of a stream of events, where there are several.\n"                                         \
  "columns: order of the columns of a table of events, as \"txyp\".\n"                                               \
  "time_unit: of the times of tables: \"auto\", \"s\", \"ms\", \"us\" or \"ns\".\n"                                  \
  "from_us, to_us: leave out what is before or at and after these times of the recording's clock.\n"                 \
  "relative: they count from the first event or trigger.\n"                                                          \
  "shift_time: times begin at 0 instead of the sensor's own.\n"                                                      \
  "strict: damage is an error; otherwise the damaged part is left out and counted.\n"                                \
  "threads: for decoding; 0 = all cores.\n"                                                                          \
  "restart: where the clock starts again: \"continue\" moves the later part behind the earlier one, \"split\" ends " \
  "there (next_part() goes on), \"refuse\" is an error.\n"                                                           \
  "camera_setup: the CameraSetup of a live camera; None = as it is set, with all of its trigger inputs."
