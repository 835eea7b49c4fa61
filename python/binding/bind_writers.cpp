// SPDX-License-Identifier: MIT
// Binds the writers of recordings and event images to Python.
#include <map>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/recordings/convert.h"
#include "e2lf/recordings/open/registry.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace fs = std::filesystem;
namespace {

Result<OutputFile> open_output(const fs::path& path, const std::string& format, const std::vector<fs::path>& inputs,
                               bool overwrite) {
  E2LF_ASSIGN_OR_RETURN(const recordings::Codec* codec, recordings::codec_to_write(path, format));
  return OutputFile::create(path, recordings::recording_output_rules(inputs, overwrite, *codec));
}

/// A recording that is being written. It appears at finish().
class Writer {
 public:
  Writer(fs::path path, OutputFile output, std::unique_ptr<recordings::RecordingWriter> writer)
      : path_(std::move(path)), output_(std::move(output)), writer_(std::move(writer)) {}

  [[nodiscard]] bool holds_triggers() { return open().holds_triggers(); }

  void write(const py::array& events, const std::optional<py::array>& triggers) {
    const OneAtATime::Use use(use_, "writer");
    recordings::RecordingWriter& writer = open();
    recordings::EventBatch batch;
    append_events(events, batch.events);
    if (triggers) append_triggers(*triggers, batch.triggers);
    if (!batch.triggers.empty() && !writer.holds_triggers()) {
      throw ResultError({ErrorCode::kUnsupported,
                         "this format cannot hold triggers; write .raw, .hdf5 or .dat, or leave them out",
                         path_.string()});
    }
    without_gil([&] { return writer.write(batch); });
  }

  void finish() {
    const OneAtATime::Use use(use_, "writer");
    without_gil([&]() -> Result<void> {
      E2LF_RETURN_IF_ERROR(open().finish());
      return output_->commit();
    });
    discard();
  }

  /// Ends without writing a file.
  void discard() {
    writer_.reset();
    output_.reset();
  }

 private:
  recordings::RecordingWriter& open() {
    if (!writer_) throw py::value_error("the recording is finished");
    return *writer_;
  }

  fs::path path_;
  std::optional<OutputFile> output_;
  std::unique_ptr<recordings::RecordingWriter> writer_;
  OneAtATime use_;
};

std::unique_ptr<Writer> create(const fs::path& path, Whole<size_t> width, Whole<size_t> height,
                               const std::string& format, const std::map<std::string, std::string>& header,
                               const std::optional<py::array>& codes, bool overwrite) {
  recordings::RecordingInfo info;
  info.width = width;
  info.height = height;
  if (codes) info.header = capture::codes_to_header(codes_of(*codes, "codes"));
  info.header.insert(info.header.end(), header.begin(), header.end());
  OutputFile output = take(open_output(path, format, {}, overwrite));
  auto writer = take(recordings::create_recording(output.path(), format, info));
  return std::make_unique<Writer>(path, std::move(output), std::move(writer));
}

py::object convert(const fs::path& input, const fs::path& output_path, const std::string& output_format, bool overwrite,
                   const ProgressArgument& progress, const OpenArguments& arguments) {
  OutputFile output = take(open_output(output_path, output_format, {input}, overwrite));
  const auto reader = open_reader(input.string(), arguments);
  const ProgressFn told = progress_of(progress);
  const auto report = without_gil([&]() -> Result<recordings::ConvertReport> {
    E2LF_ASSIGN_OR_RETURN(
        recordings::ConvertReport done,
        recordings::convert_recording(*reader, output.path(), {.format = output_format, .progress = told}));
    E2LF_RETURN_IF_ERROR(output.commit());
    return done;
  });
  info::warn_of_losses(input.string(), report.summary);
  const fs::path triggers = report.trigger_file.empty() ? fs::path() : output_path.parent_path() / report.trigger_file;
  return to_python({{"events", report.events},
                    {"triggers", report.triggers},
                    {"lost_triggers", report.lost_triggers},
                    {"trigger_file", triggers.string()},
                    {"left_out", info::losses_json(report.summary)},
                    {"sorted", report.summary.out_of_order},
                    {"warnings", report.warnings}});
}

}  // namespace

void bind_writers(py::module_& module) {
  py::class_<Writer>(
      module, "RecordingWriter",
      "Writes a recording from front to back; returned by create_recording(). The file appears complete at finish(), "
      "or at the end of a with block unless an exception leaves it.")
      .def_property_readonly("holds_triggers", &Writer::holds_triggers, "Whether the format can hold triggers.")
      .def("write", &Writer::write, py::arg("events"), py::arg("triggers") = py::none(),
           "Appends events (fields x, y, p, t) and triggers (p, t, id), each sorted by time and not earlier than those "
           "written before.")
      .def("finish", &Writer::finish, "Completes the file and moves it to its path.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](Writer& self, const py::object& type, const py::object&, const py::object&) {
        if (type.is_none()) {
          self.finish();
        } else {
          self.discard();
        }
      });
  module.def("create_recording", &create, py::arg("path"), py::arg("sensor_width"), py::arg("sensor_height"),
             py::kw_only(), py::arg("format") = "", py::arg("header") = std::map<std::string, std::string>(),
             py::arg("codes") = py::none(), py::arg("overwrite") = false,
             "Creates a recording.\n\n"
             "sensor_width, sensor_height: size of the sensor in px.\n"
             "format: \"evt3\", \"evt2\", \"evt2.1\", \"dat\", \"hdf5\", \"csv\" or \"npz\"; if empty, "
             "determined by the extension.\n"
             "header: keys and values for formats with a header.\n"
             "codes: the patterns [N, view_y, view_x] that were shown, which are stored in the header.");
  module.def(
      "convert",
      [](const fs::path& input, const fs::path& output, const std::string& output_format, bool overwrite,
         const ProgressArgument& progress,
         E2LF_OPEN_PARAMETERS) { return convert(input, output, output_format, overwrite, progress, E2LF_OPEN_VALUES); },
      py::arg("path"), py::arg("output"), py::kw_only(), py::arg("format") = "", py::arg("overwrite") = false,
      py::arg("progress") = py::none(), E2LF_OPEN_ARGUMENTS,
      "Converts a recording to another format in bounded memory. Returns a dict with counts, warnings and the data "
      "that were left out.\n\n"
      "format: if empty, determined by the extension.\n"
      "progress: called with (events so far, 0)." E2LF_OPEN_DOC);
}

}  // namespace e2lf::python
