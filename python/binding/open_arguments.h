// SPDX-License-Identifier: MIT
#pragma once

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
#define E2LF_OPEN_ARGUMENTS                                                                                            \
  py::arg("format") = "", py::arg("width") = 0, py::arg("height") = 0, py::arg("stream") = "",                         \
  py::arg("columns") = "", py::arg("time_unit") = "auto", py::arg("polarities") = "", py::arg("from_us") = py::none(), \
  py::arg("to_us") = py::none(), py::arg("relative") = false, py::arg("shift_time") = false,                           \
  py::arg("strict") = false, py::arg("threads") = 0, py::arg("restart") = "continue",                                  \
  py::arg("camera_setup") = py::none()
#define E2LF_OPEN_DOC                                                                                              \
  "\n\npath: a file, the folder of a bag of ROS 2, \"-\" for standard input, a named pipe, tcp://ADDRESS:PORT, "   \
  "camera://NAME or replay:FILE.\n"                                                                                \
  "format: format of the file if it cannot be detected.\n"                                                         \
  "width, height: size of the sensor in px if the file does not state it.\n"                                       \
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
