// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <span>
#include <vector>

#include "e2lf/recordings/event.h"

/// Events and triggers as structured arrays, with the fields of the Metavision tools.
namespace e2lf::python {

namespace py = pybind11;

/// An event as OpenEB stores it.
struct EventRecord {
  uint16_t x, y;
  int16_t p;
  uint16_t padding;
  int64_t t;
};
static_assert(sizeof(EventRecord) == 16);

/// An edge of a trigger input, the same.
struct TriggerRecord {
  int16_t p;
  uint16_t padding[3];
  int64_t t;
  int16_t id;
  uint16_t more_padding[3];
};
static_assert(sizeof(TriggerRecord) == 24);

using EventRecords = recordings::Column<EventRecord>;

/// The types of the arrays: x, y uint16, p int16, t int64; p int16, t int64, id int16.
[[nodiscard]] const py::dtype& event_dtype();
[[nodiscard]] const py::dtype& trigger_dtype();

/// Appends the events [begin, end). Needs no GIL.
void append_records(const recordings::EventColumns& events, size_t begin, size_t end, EventRecords& records);

/// Empty records, in memory that an earlier array has given back where there is some: fresh memory costs as much as
/// the events in it. Needs no GIL.
[[nodiscard]] EventRecords take_records();

/// Says that a recording is read, or no longer: with how many there are, so does the memory that take_records() keeps.
void count_readers(int change);

/// An array over the records; nothing is copied.
[[nodiscard]] py::array to_array(EventRecords records);
[[nodiscard]] py::array to_array(std::span<const recordings::Trigger> triggers);

/// The other way, from arrays with these fields of any type of whole numbers. Fails with kFormat where a field is
/// missing and kInvalidValue where a value does not fit.
void append_events(const py::array& array, recordings::EventColumns& events);
void append_triggers(const py::array& array, std::vector<recordings::Trigger>& triggers);

}  // namespace e2lf::python
