// SPDX-License-Identifier: MIT
// Binds the module cycles to Python.
#include <algorithm>
#include <pybind11/operators.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <variant>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/event_windows.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/recordings/open/registry.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/events.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace fs = std::filesystem;
namespace {

using cycles::Schedule;
using cycles::ScheduledPattern;

constexpr Choice<cycles::BurstSign> kSigns[] = {
    {"any", cycles::BurstSign::kAny}, {"on", cycles::BurstSign::kOn}, {"off", cycles::BurstSign::kOff}};

cycles::BurstSign sign_of(const std::string& name) {
  return value_of(name, kSigns, "sign");
}

Schedule checked(Schedule schedule) {
  take(cycles::validate(schedule, "schedule"));
  return schedule;
}

void bind_schedule(py::module_& module) {
  py::class_<ScheduledPattern>(module, "ScheduledPattern",
                               "One pattern on the aperture.\n\nname: the name of the pattern.\n"
                               "duration_us: duration of the pattern.\n"
                               "overhead_us: time from its end to the start of the next pattern.\n"
                               "image: number of the event image for its events; None = the events are not used.\n"
                               "sign: sign of the events that the change to it causes: \"any\", \"on\" or \"off\".")
      .def(py::init([](std::string name, int64_t duration_us, int64_t overhead_us, std::optional<size_t> image,
                       const std::string& sign) {
             return ScheduledPattern{std::move(name), duration_us, overhead_us, image, sign_of(sign)};
           }),
           py::arg("name"), py::arg("duration_us") = 10000, py::arg("overhead_us") = 0, py::arg("image") = py::none(),
           py::arg("sign") = "any")
      .def_readonly("name", &ScheduledPattern::name, "The name of the pattern.")
      .def_readonly("duration_us", &ScheduledPattern::duration_us, "Duration of the pattern, us.")
      .def_readonly("overhead_us", &ScheduledPattern::overhead_us,
                    "Time from its end to the start of the next pattern, us.")
      .def_readonly("image", &ScheduledPattern::image, "Number of the event image for its events, or None.")
      .def_property_readonly(
          "sign", [](const ScheduledPattern& self) { return word_of(self.sign, kSigns); },
          "Sign of the events that the change to it causes: \"any\", \"on\" or \"off\".")
      .def(py::self == py::self)
      .def(py::pickle(
          [](const ScheduledPattern& self) {
            return py::make_tuple(self.name, self.duration_us, self.overhead_us, self.image,
                                  word_of(self.sign, kSigns));
          },
          [](const py::tuple& state) {
            return ScheduledPattern{state[0].cast<std::string>(), state[1].cast<int64_t>(), state[2].cast<int64_t>(),
                                    state[3].cast<std::optional<size_t>>(), sign_of(state[4].cast<std::string>())};
          }))
      .def("__repr__", [](const ScheduledPattern& self) { return "<e2lf.ScheduledPattern " + self.name + ">"; });

  py::class_<Schedule>(module, "Schedule", "The patterns of one cycle in the order in which they are shown.")
      .def(py::init([](std::vector<ScheduledPattern> patterns) { return checked({std::move(patterns)}); }),
           py::arg("patterns"))
      .def_readonly("patterns", &Schedule::patterns, "A list of ScheduledPattern.")
      .def_property_readonly(
          "views", [](const Schedule& self) { return orientation_word(self.views); }, kViewsDoc)
      .def_property_readonly("num_images", &Schedule::num_images, "Number of event images in a cycle.")
      .def_property_readonly("cycle_us", &Schedule::cycle_us, "Duration of a cycle, us.")
      .def("to_json", &cycles::schedule_text, "Returns the text of a schedule file.")
      .def(py::self == py::self)
      .def("__len__", &Schedule::size)
      .def("__repr__",
           [](const Schedule& self) {
             return cat("<e2lf.Schedule of ", self.size(), " patterns, ", self.cycle_us(), " us>");
           })
      .def(py::pickle([](const Schedule& self) { return cycles::schedule_text(self); },
                      [](const std::string& text) { return take(cycles::parse_schedule(text, "pickle")); }));

  module.def(
      "read_schedule", [](const fs::path& path) { return take(cycles::read_schedule(path)); }, py::arg("path"),
      "Reads the JSON file of a schedule, as `e2lf codes render` writes it.");
  module.def(
      "paper_schedule",
      [](Whole<size_t> num_codes) {
        if (num_codes < 2) throw py::value_error("a schedule needs at least 2 codes");
        return cycles::paper_schedule(num_codes);
      },
      py::arg("num_codes") = 4,
      "Returns the paper's schedule: the inverses of all patterns, then the patterns; 94.7 ms for 4 codes.\n\n"
      "num_codes: number of patterns, at least 2.");
  module.def(
      "plain_schedule",
      [](Whole<size_t> num_codes, int64_t duration_us) {
        return checked(cycles::plain_schedule(num_codes, duration_us));
      },
      py::arg("num_codes"), py::arg("duration_us"),
      "Returns a schedule of the patterns without inverses.\n\n"
      "num_codes: number of patterns. duration_us: duration of each.");
}

using ScheduleArgument = std::variant<std::monostate, Schedule, fs::path>;

std::optional<Schedule> schedule_of(const ScheduleArgument& argument) {
  if (const auto* schedule = std::get_if<Schedule>(&argument)) return *schedule;
  if (const auto* path = std::get_if<fs::path>(&argument)) return take(cycles::read_schedule(*path));
  return std::nullopt;
}

/// An iterator over the cycles of a recording.
class CycleIterator {
 public:
  CycleIterator(std::string name, pipeline::CycleInput input)
      : name_(std::move(name)), is_live_(recordings::is_live_recording(name_)), input_(std::move(input)) {}

  py::object next() {
    const OneAtATime::Use use(use_, "reader of cycles");
    std::optional<pipeline::CycleImages> next;
    {
      const StopOnInterrupt interrupt(is_live_);
      next = without_gil([&] { return input_.next(); });
    }
    check_signals();
    if (!next) {
      if (!std::exchange(has_ended_, true)) {
        info::warn_of_losses(name_, input_.summary());
        diagnose::log_findings(name_, input_.rig().findings(input_.reader()));
        check_live(input_.summary());
      }
      throw py::stop_iteration();
    }
    const cycles::Cycle& cycle = *next->cycle;
    py::list slices;
    for (const cycles::TimeSlice& slice : cycle.slices) slices.append(py::make_tuple(slice.begin_us, slice.end_us));
    return make_tuple_of("Cycle", to_array(std::move(next->images.events)), cycle.number, cycle.begin_us,
                         std::move(slices), cycle.events, cycle.saturated, cycle.confidence);
  }

  [[nodiscard]] std::string source() const { return word_of(input_.reader().source(), info::kCycleSources); }
  [[nodiscard]] py::object report() {
    const OneAtATime::Use use(use_, "reader of cycles");
    Json report = input_.rig().json(input_.reader());
    report["left_out"] = info::losses_json(input_.summary());
    report["live"] = info::live_json(input_.summary());
    return to_python(report);
  }
  [[nodiscard]] capture::RecordedSetup setup() const { return take(input_.setup()); }

 private:
  std::string name_;
  bool is_live_, has_ended_ = false;
  pipeline::CycleInput input_;
  OneAtATime use_;
};

std::unique_ptr<CycleIterator> open_cycles(pipeline::CycleInputOptions options, const OpenArguments& open) {
  const std::string name = options.input.string();
  pipeline::EventSource reader = open_reader(name, open);
  const StopOnInterrupt interrupt(recordings::is_live_recording(name));
  return std::make_unique<CycleIterator>(
      name, without_gil([&] { return pipeline::CycleInput::open(std::move(reader), std::move(options)); }));
}

void bind_cycle_reader(py::module_& module) {
  py::class_<CycleIterator>(module, "Cycles", "An iterator over the cycles of a recording, returned by accumulate().")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &CycleIterator::next)
      .def_property_readonly("source", &CycleIterator::source,
                             "The source of the times: \"triggers\", \"bursts\" or \"schedule\".")
      .def_property_readonly(
          "codes", [](const CycleIterator& self) { return to_array(self.setup().codes); },
          "The patterns of the transitions, float32 [transitions + 1, view_y, view_x]; None if the "
          "recording does not state them.")
      .def_property_readonly(
          "views", [](const CycleIterator& self) { return orientation_word(self.setup().views); }, kViewsDoc)
      .def("report", &CycleIterator::report,
           "Returns the numbers of cycles found and dropped so far, with reasons, and the data that were left out.");
  const cycles::CycleOptions usual;
  module.def(
      "accumulate",
      [](const fs::path& path, const std::string& source, const ScheduleArgument& schedule,
         std::optional<Whole<size_t>> num_codes, const std::string& edge, std::optional<uint16_t> channel,
         std::optional<size_t> first_pattern, bool one_trigger_per_cycle, std::optional<int64_t> origin_us,
         int64_t trigger_delay_us, bool filter_pixels, const std::string& transitions, bool invert_polarity,
         E2LF_OPEN_PARAMETERS) {
        if (num_codes && *num_codes < 2) throw py::value_error("num_codes is at least 2");
        check_word(transitions, {"auto", "lit", "all"}, "transitions");
        cycles::CycleOptions options;
        options.source = value_of(source, info::kCycleSources, "source");
        options.edge = value_of(edge, cycles::kTriggerEdges, "edge");
        options.channel = channel;
        options.one_trigger_per_cycle = one_trigger_per_cycle;
        options.trigger_delay_us = trigger_delay_us;
        options.invert_polarity = invert_polarity;
        options.tracker.first_pattern = first_pattern;
        options.filters_pixels = filter_pixels;
        return open_cycles(
            {.input = path,
             .cycles = std::move(options),
             .schedule = {.schedule = schedule_of(schedule), .num_patterns = num_codes, .transitions = transitions},
             .origin_us = origin_us},
            E2LF_OPEN_VALUES);
      },
      py::arg("path"), py::kw_only(), py::arg("source") = word_of(usual.source, info::kCycleSources),
      py::arg("schedule") = py::none(), py::arg("num_codes") = py::none(),
      py::arg("edge") = word_of(usual.edge, cycles::kTriggerEdges), py::arg("channel") = usual.channel,
      py::arg("first_pattern") = usual.tracker.first_pattern,
      py::arg("one_trigger_per_cycle") = usual.one_trigger_per_cycle, py::arg("origin_us") = py::none(),
      py::arg("trigger_delay_us") = usual.trigger_delay_us, py::arg("filter_pixels") = usual.filters_pixels,
      py::arg("transitions") = pipeline::ScheduleChoice().transitions,
      py::arg("invert_polarity") = usual.invert_polarity, E2LF_OPEN_ARGUMENTS,
      "Divides a recording into pattern cycles and accumulates their event images. Returns an iterator over "
      "Cycle(images, number, begin_us, slices, events, saturated, confidence), where images is int16 "
      "[transition, y, x].\n\n"
      "source: source of the times at which patterns change: \"triggers\", \"bursts\" (the events), \"schedule\" "
      "(requires origin_us) or \"auto\".\n"
      "schedule: a Schedule or the path of its file; None = the paper's for num_codes patterns.\n"
      "num_codes: number of patterns; None = as the recording states, or else 4.\n"
      "edge, channel: edge and input of the triggers; channel None = all inputs.\n"
      "first_pattern: pattern of the first trigger or burst, from 0; None = determined from the recording.\n"
      "one_trigger_per_cycle: whether triggers mark cycles instead of patterns.\n"
      "origin_us: time at which the first pattern of any cycle began.\n"
      "trigger_delay_us: time from a trigger to the change of the pattern; negative if the pattern changes first.\n"
      "filter_pixels: whether hot pixels get the events of their neighbours.\n"
      "transitions: event images of the changes to the active patterns a2 to aN (\"lit\"), or of all changes of the "
      "whole cycle, from a1 to a2 until the change to the next a1 (\"all\"); \"auto\" = all if the patterns of the "
      "recording require it.\n"
      "invert_polarity: whether to exchange ON and OFF events." E2LF_OPEN_DOC);
}

/// Writes a recording of event images, as cycles::synthesise_cycle() makes it.
void synthesise(const fs::path& path, const std::vector<py::array>& images_of_cycles,
                const std::optional<py::array>& codes, const ScheduleArgument& schedule, bool triggers,
                int64_t begin_us, Whole<uint64_t> seed, const capture::SensorProfile* camera, bool overwrite) {
  std::vector<LentImages> images;
  for (const py::array& each : images_of_cycles) images.push_back(event_images_of(each, "cycles"));
  if (images.empty()) throw py::value_error("at least one cycle is required");
  cycles::SynthesisOptions options;
  options.schedule = schedule_of(schedule).value_or(cycles::paper_schedule(images.front()->extents[0] + 1));
  if (!triggers) options.trigger_channel.reset();
  options.begin_us = begin_us;
  options.seed = seed;
  recordings::RecordingInfo info;
  info.width = images.front()->extents[2];
  info.height = images.front()->extents[1];
  capture::RecordedSetup setup;
  if (codes) setup.codes = codes_of(*codes, "codes");
  if (camera != nullptr) setup.camera = *camera;
  info.header = capture::setup_to_header(setup);
  for (const auto& each : images) {
    if (each->extents == std::array{options.schedule.num_images(), info.height, info.width}) continue;
    throw ResultError({ErrorCode::kShape,
                       "the cycles differ in size, or their number of images differs from that of the schedule",
                       "cycles"});
  }
  without_gil([&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const recordings::Codec* codec, recordings::codec_to_write(path, ""));
    E2LF_ASSIGN_OR_RETURN(OutputFile output,
                          OutputFile::create(path, recordings::recording_output_rules({}, overwrite, *codec)));
    E2LF_ASSIGN_OR_RETURN(const auto writer, recordings::create_recording(output.path(), "", info));
    if (triggers && !writer->holds_triggers()) {
      return Error{ErrorCode::kUnsupported,
                   "this format cannot hold triggers; write .raw, .hdf5 or .dat, or leave them out", path.string()};
    }
    E2LF_RETURN_IF_ERROR(cycles::synthesise_recording(
        *writer, images.size(), options,
        [&](uint64_t number) -> Result<capture::EventImages> { return owned(*images[number]); }));
    E2LF_RETURN_IF_ERROR(writer->finish());
    return output.commit();
  });
}

/// Returns events in the order of time, with pixels inside of the image.
recordings::EventColumns sorted_events(const py::array& array, size_t width, size_t height) {
  recordings::EventColumns events;
  append_events(array, events);
  for (size_t i = 0; i < events.size(); ++i) {
    if (events.x[i] >= width || events.y[i] >= height) {
      throw ResultError({ErrorCode::kInvalidValue,
                         cat("event ", i, " lies at (", events.x[i], ", ", events.y[i], "), outside of ", width, "x",
                             height, " px; give the size of the sensor"),
                         "events"});
    }
    if (i > 0 && events.t[i] < events.t[i - 1]) {
      throw ResultError(
          {ErrorCode::kInvalidValue, cat("event ", i, " is earlier than the one before; sort them by t"), "events"});
    }
  }
  return events;
}

py::array event_images(const py::array& array, const std::vector<int64_t>& times_us, size_t width, size_t height) {
  if (times_us.size() < 2 || !std::ranges::is_sorted(times_us))
    throw py::value_error("times_us are the starts of at least one image and the end of the last, in ascending order");
  const recordings::EventColumns events = sorted_events(array, width, height);
  capture::EventImages images(times_us.size() - 1, height, width);
  const bool fits = without_gil([&]() -> Result<bool> {
    size_t image = 0;
    for (size_t i = 0; i < events.size(); ++i) {
      if (events.t[i] < times_us.front()) continue;
      while (image < images.count && events.t[i] >= times_us[image + 1]) ++image;
      if (image == images.count) break;
      int16_t& count = images.image(image)[events.y[i] * width + events.x[i]];
      const int sum = count + (events.p[i] != 0 ? 1 : -1);
      if (sum != static_cast<int16_t>(sum)) return false;
      count = static_cast<int16_t>(sum);
    }
    return true;
  });
  if (fits) return to_array(std::move(images));
  throw ResultError({ErrorCode::kInvalidValue, "a count does not fit into int16; use shorter intervals", "times_us"});
}

py::array voxel_grid(const py::array& array, size_t bins, size_t width, size_t height) {
  if (bins < 1) throw py::value_error("a grid has at least 1 bin");
  const recordings::EventColumns events = sorted_events(array, width, height);
  const auto grid =
      without_gil([&]() -> Result<capture::VoxelGrid> { return cycles::voxelise(events, bins, height, width); });
  return py::array_t<float>(std::vector<size_t>{bins, height, width}, grid.values.data());
}

void bind_event_arrays(py::module_& module) {
  module.def(
      "event_images",
      [](const py::array& events, const std::vector<int64_t>& times_us, Whole<size_t> width, Whole<size_t> height) {
        return event_images(events, times_us, width, height);
      },
      py::arg("events"), py::arg("times_us"), py::arg("width"), py::arg("height"),
      "Sums the signed events of intervals: int16 [transition, y, x].\n\n"
      "events: array with the fields x, y, p, t, sorted by t.\n"
      "times_us: starts of the intervals in us, followed by the end of the last one; other events are not used.\n"
      "width, height: size of the sensor in px.");
  module.def(
      "voxel_grid",
      [](const py::array& events, Whole<size_t> bins, Whole<size_t> width, Whole<size_t> height) {
        return voxel_grid(events, bins, width, height);
      },
      py::arg("events"), py::arg("bins"), py::arg("width"), py::arg("height"),
      "Distributes the events of a window over points in time, between which they are interpolated: float32 "
      "[bin, y, x].\n\n"
      "events: array with the fields x, y, p, t, sorted by t. bins: number of points in time.\n"
      "width, height: size of the sensor in px.");
}

}  // namespace

void bind_cycles(py::module_& module) {
  bind_schedule(module);
  bind_cycle_reader(module);
  bind_event_arrays(module);
  module.def("synthesise_recording", &synthesise, py::arg("path"), py::arg("cycles"), py::arg("codes") = py::none(),
             py::kw_only(), py::arg("schedule") = py::none(), py::arg("triggers") = true, py::arg("begin_us") = 100000,
             py::arg("seed") = cycles::SynthesisOptions().seed, py::arg("camera") = nullptr,
             py::arg("overwrite") = false,
             "Writes a recording with these event images, as a camera would record it: the events are distributed over "
             "the duration of each pattern, with triggers.\n\n"
             "cycles: a list of int16 [transition, y, x], or an array [cycle, transition, y, x].\n"
             "codes, camera: the patterns [N, view_y, view_x] and the Camera, which are stored in the header.\n"
             "schedule: a Schedule or the path of its file; None = the paper's.\n"
             "begin_us: start of the first cycle.\n"
             "triggers: whether to write a rising edge at the start of each pattern.\n"
             "seed: seed of the times within a pattern.");
}

}  // namespace e2lf::python
