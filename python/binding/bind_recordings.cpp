// SPDX-License-Identifier: MIT
// Binds the readers of the module recordings to Python.
#include <pybind11/operators.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/base/text.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/recording.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/module.h"

namespace e2lf::python {
using namespace pybind11::literals;
namespace fs = std::filesystem;
namespace {

using RecordingPointer = std::shared_ptr<Recording>;

/// An iterator over the slices of a recording, and one that returns only their events.
struct Slices {
  RecordingPointer recording;
  SliceSize size;

  [[nodiscard]] Slice next() const {
    std::optional<Slice> slice = recording->next(size);
    if (!slice) throw py::stop_iteration();
    return std::move(*slice);
  }
};
struct EventSlices : Slices {};

RecordingPointer open(const fs::path& path, const OpenArguments& arguments) {
  // Slices begin at from_us only if it is a time on their clock.
  const bool is_absolute = !arguments.relative && !arguments.shift_time;
  return std::make_shared<Recording>(path.string(), open_reader(path.string(), arguments, true),
                                     is_absolute ? arguments.from_us : std::nullopt);
}

SliceSize slice_size(std::optional<int64_t> delta_t, std::optional<int64_t> n_events) {
  if (delta_t && (*delta_t < 1 || *delta_t > recordings::kTimeLimitUs)) {
    throw py::value_error(cat("delta_t is from 1 to ", recordings::kTimeLimitUs, " us"));
  }
  if (n_events && *n_events < 1) throw py::value_error("n_events is a number of at least 1");
  SliceSize size;
  size.delta_us = delta_t;
  if (n_events) size.events = static_cast<size_t>(*n_events);
  return size;
}

py::object slice_of(Slice slice) {
  const int64_t begin_us = slice.begin_us, end_us = slice.end_us;
  py::array triggers = to_array(slice.triggers);
  return make_tuple_of("Slice", to_array(std::move(slice.events)), std::move(triggers), begin_us, end_us);
}

capture::RecordedSetup setup_of(const Recording& recording) {
  return take(pipeline::recorded_setup(recording.name(), recording.reader().info()));
}

/// Reads the whole recording into two arrays.
py::tuple read_events(const fs::path& path, const OpenArguments& arguments) {
  const auto reader = open_reader(path.string(), arguments);
  EventRecords records;
  std::vector<recordings::Trigger> triggers;
  const ProgressFn look_for_signals = progress_of({});
  without_gil([&]() -> Result<void> {
    recordings::EventBatch batch;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
      if (!more) return {};
      append_records(batch.events, 0, batch.events.size(), records);
      triggers.insert(triggers.end(), batch.triggers.begin(), batch.triggers.end());
      look_for_signals(records.size(), 0);
    }
  });
  info::warn_of_losses(path.string(), reader->summary());
  return py::make_tuple(to_array(std::move(records)), to_array(triggers));
}

/// Decodes a recording without making arrays, for comparison in bench/python/iterate.py.
uint64_t count_events(const fs::path& path, int threads) {
  const auto reader = open_reader(path.string(), {.threads = threads});
  return without_gil([&]() -> Result<uint64_t> {
    recordings::EventBatch batch;
    for (bool more = true; more;) {
      E2LF_ASSIGN_OR_RETURN(more, reader->read(batch));
    }
    return reader->summary().events();
  });
}

py::object describe(const fs::path& path, const OpenArguments& arguments, const ProgressArgument& progress) {
  info::DescribeOptions options;
  options.recording = open_options(path.string(), arguments);
  options.progress = progress_of(progress);
  const auto described = without_gil([&] { return info::describe(path, options); });
  return to_python(described.json);
}

void bind_recording(py::module_& module) {
  py::class_<Slices>(module, "Slices", "An iterator over slices of a Recording, returned by slices().")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](const Slices& self) { return slice_of(self.next()); });
  py::class_<EventSlices>(module, "EventSlices", "An iterator over the events of a Recording, returned by events().")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](const EventSlices& self) { return to_array(self.next().events); });
  py::class_<Recording, RecordingPointer> recording(
      module, "Recording",
      "A recording that is read from front to back in bounded memory, returned by open_recording().\n\n"
      "Iterating over it returns slices as they are decoded, which is fastest. It may be used by one thread at a "
      "time.");
  recording.def_property_readonly("name", &Recording::name, "The name under which it was opened.")
      .def_property_readonly(
          "format", [](const Recording& self) { return self.reader().info().format; }, "\"evt3\", \"hdf5\", ...")
      .def_property_readonly(
          "width", [](const Recording& self) { return self.reader().info().width; },
          "Width of the sensor in px; 0 if the file does not state it.")
      .def_property_readonly(
          "height", [](const Recording& self) { return self.reader().info().height; },
          "Height of the sensor in px; 0 if the file does not state it.")
      .def_property_readonly(
          "header",
          [](const Recording& self) {
            py::dict header;
            for (const auto& [key, value] : self.reader().info().header) header[py::str(key)] = py::str(value);
            return header;
          },
          "Keys and values of the header.")
      .def_property_readonly(
          "assumptions",
          [](const Recording& self) {
            py::list texts;
            for (const auto& assumption : self.reader().info().assumptions) texts.append(assumption.text);
            return texts;
          },
          "Properties that the file does not state and that were assumed.")
      .def_property_readonly(
          "codes", [](const Recording& self) { return to_array(setup_of(self).codes); },
          "The patterns with which it was recorded, float32 [N, view_y, view_x]; None if they are unknown.")
      .def_property_readonly(
          "camera", [](const Recording& self) { return setup_of(self).camera; },
          "The Camera with which it was recorded; None if it is unknown.")
      .def_property_readonly(
          "views", [](const Recording& self) { return orientation_word(setup_of(self).views); }, kViewsDoc)
      .def(
          "summary", [](Recording& self) { return to_python(info::summary_json(self.summary())); },
          "Returns a summary of the data read so far: counts of events and triggers, times in us, and the data that "
          "were left out, with reasons.")
      .def(
          "slices",
          [](RecordingPointer self, std::optional<int64_t> delta_t, std::optional<int64_t> n_events) {
            return Slices{std::move(self), slice_size(delta_t, n_events)};
          },
          py::arg("delta_t") = py::none(), py::arg("n_events") = py::none(),
          "Iterates over Slice(events, triggers, begin_us, end_us).\n\n"
          "delta_t: duration of each slice in us. Slices are contiguous and may be empty. The first begins at from_us, "
          "or else at the multiple of delta_t before the first event.\n"
          "n_events: number of events in each slice; the last may have fewer.\n"
          "If both are given, a slice ends at the earlier limit; if neither is given, slices are returned as decoded.")
      .def(
          "events",
          [](RecordingPointer self, std::optional<int64_t> delta_t, std::optional<int64_t> n_events) {
            return EventSlices{{std::move(self), slice_size(delta_t, n_events)}};
          },
          py::arg("delta_t") = py::none(), py::arg("n_events") = py::none(),
          "Iterates over the events of slices: structured arrays with fields x, y (uint16, px), p (int16, 1 = ON, 0 = "
          "OFF) and t (int64, us).\n\ndelta_t, n_events: as for slices().")
      .def(
          "between",
          [](Recording& self, int64_t begin_us, int64_t end_us) { return slice_of(self.between(begin_us, end_us)); },
          py::arg("begin_us"), py::arg("end_us"),
          "Returns the Slice begin_us <= t < end_us. Calls may be in any order, and reading continues after the slice. "
          "Not available for streams.")
      .def("seek", &Recording::seek, py::arg("t_us"), "Seeks to the first event or trigger with t >= t_us.")
      .def("next_part", &Recording::next_part,
           "Continues with the next part, which has its own times, after iterating has ended with restart=\"split\". "
           "Returns False if there is none.")
      .def("close", &Recording::close, "Closes the file, as leaving a with block does.")
      .def("__iter__",
           [](RecordingPointer self) {
             return Slices{std::move(self), {}};
           })
      .def("__enter__", [](RecordingPointer self) { return self; })
      .def("__exit__", [](Recording& self, const py::args&) { self.close(); })
      .def("__repr__", [](const Recording& self) { return "<e2lf.Recording " + self.name() + ">"; });
}

/// (x, y, width, height).
using RegionArgument = std::tuple<int, int, int, int>;

recordings::CameraSetup make_camera_setup(std::vector<std::string> trigger_channels, const fs::path& biases,
                                          std::optional<uint32_t> max_events_per_s,
                                          const std::vector<RegionArgument>& regions, std::string encoding,
                                          bool switches_filters_off) {
  if (!encoding.empty()) check_word(encoding, {"evt2", "evt2.1", "evt3"}, "encoding");
  recordings::CameraSetup setup{.trigger_channels = std::move(trigger_channels),
                                .biases = biases,
                                .max_events_per_s = max_events_per_s,
                                .regions = {},
                                .encoding = std::move(encoding),
                                .switches_filters_off = switches_filters_off};
  for (const auto& [x, y, width, height] : regions) setup.regions.push_back({x, y, width, height});
  return setup;
}

py::tuple parts_of(const recordings::CameraSetup& setup) {
  std::vector<RegionArgument> regions;
  for (const auto& region : setup.regions) regions.emplace_back(region.x, region.y, region.width, region.height);
  return py::make_tuple(setup.trigger_channels, setup.biases.string(), setup.max_events_per_s, regions, setup.encoding,
                        setup.switches_filters_off);
}

void bind_camera_setup(py::module_& module) {
  using recordings::CameraSetup;
  py::class_<CameraSetup>(
      module, "CameraSetup",
      "The settings of a live camera that are applied before it starts. Others are left as the camera has them.")
      .def(py::init(&make_camera_setup), py::kw_only(), py::arg("trigger_channels") = std::vector<std::string>(),
           py::arg("biases") = "", py::arg("max_events_per_s") = py::none(),
           py::arg("regions") = std::vector<RegionArgument>(), py::arg("encoding") = "",
           py::arg("switches_filters_off") = false,
           "trigger_channels: inputs to enable: \"main\", \"aux\", their number, or [\"none\"]; [] = all.\n"
           "biases: a file of biases (.bias).\n"
           "max_events_per_s: event rate above which the sensor drops events; 0 = no limit.\n"
           "regions: rectangles of the sensor that send events, (x, y, width, height) in px; [] = all.\n"
           "encoding: \"evt2\", \"evt2.1\" or \"evt3\".\n"
           "switches_filters_off: whether to switch off the anti-flicker and event trail filters of the sensor, which "
           "drop events of the patterns.")
      .def(py::self == py::self)
      .def(py::pickle(&parts_of, [](const py::tuple& state) {
        return py::cast<CameraSetup>(py::type::of<CameraSetup>()(
            **py::dict("trigger_channels"_a = state[0], "biases"_a = state[1], "max_events_per_s"_a = state[2],
                       "regions"_a = state[3], "encoding"_a = state[4], "switches_filters_off"_a = state[5])));
      }));
}

/// Returns the names of the live cameras that the plugins find.
std::vector<std::string> find_cameras() {
  return without_gil([]() -> Result<std::vector<std::string>> {
    std::vector<std::string> names;
    for (const recordings::CameraPlugin& plugin : recordings::camera_plugins()) {
      if (!plugin.list) continue;
      E2LF_ASSIGN_OR_RETURN(const std::vector<std::string> addresses, plugin.list());
      for (const std::string& address : addresses) names.push_back(cat("camera://", plugin.name, "/", address));
    }
    return names;
  });
}

}  // namespace

void bind_recordings(py::module_& module) {
  module.attr("event_dtype") = event_dtype();
  module.attr("trigger_dtype") = trigger_dtype();
  bind_camera_setup(module);
  bind_recording(module);
  module.def(
      "find_cameras", &find_cameras,
      "Returns the names of the connected cameras, which open_recording() opens: [\"camera://metavision/...\"].");
  module.def(
      "open_recording", [](const fs::path& path, E2LF_OPEN_PARAMETERS) { return open(path, E2LF_OPEN_VALUES); },
      py::arg("path"), py::kw_only(), E2LF_OPEN_ARGUMENTS, "Opens a recording of any format." E2LF_OPEN_DOC);
  module.def(
      "read_events", [](const fs::path& path, E2LF_OPEN_PARAMETERS) { return read_events(path, E2LF_OPEN_VALUES); },
      py::arg("path"), py::kw_only(), E2LF_OPEN_ARGUMENTS,
      "Reads a whole recording and returns (events, triggers), structured arrays of event_dtype and "
      "trigger_dtype." E2LF_OPEN_DOC);
  module.def("_count_events", &count_events, py::arg("path"), py::arg("threads"));
  module.def(
      "info",
      [](const fs::path& path, const std::string& format, size_t width, size_t height, const std::string& stream,
         const std::string& columns, const std::string& time_unit, const std::string& polarities,
         const ProgressArgument& progress) {
        return describe(path,
                        {.format = format,
                         .stream = stream,
                         .columns = columns,
                         .time_unit = time_unit,
                         .polarities = polarities,
                         .width = width,
                         .height = height},
                        progress);
      },
      py::arg("path"), py::kw_only(), py::arg("event_format") = "", py::arg("sensor_width") = 0,
      py::arg("sensor_height") = 0, py::arg("stream") = "", py::arg("columns") = "", py::arg("time_unit") = "auto",
      py::arg("polarities") = "", py::arg("progress") = py::none(),
      "Describes a file or folder. Returns a dict with `kind` and the content of `e2lf info --json`. Recordings are "
      "read to their end.\n\n"
      "event_format, sensor_width, sensor_height, stream, columns, time_unit, polarities: as for open_recording().\n"
      "progress: called with (done, total); an exception cancels the operation.");
}

}  // namespace e2lf::python
