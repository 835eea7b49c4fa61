// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <span>
#include <vector>

#include "e2lf/recordings/event.h"

/// Conversion of events and triggers to structured arrays with the fields of the Metavision tools.
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

/// An edge of a trigger input as OpenEB stores it.
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

/// Appends the events [begin, end). Does not require the GIL.
void append_records(const recordings::EventColumns& events, size_t begin, size_t end, EventRecords& records);

/// Returns empty records in the memory of a freed array if possible, because allocating memory takes as long as filling
/// it. Does not require the GIL.
[[nodiscard]] EventRecords take_records();

/// Changes the number of recordings that are being read, on which the memory kept for take_records() depends.
void count_readers(int change);

/// Returns an array over the records without copying them.
[[nodiscard]] py::array to_array(EventRecords records);
[[nodiscard]] py::array to_array(std::span<const recordings::Trigger> triggers);

/// Append events and triggers from arrays with these fields, of any integer types. Fail with kFormat if a field is
/// missing, and with kInvalidValue if a value does not fit.
void append_events(const py::array& array, recordings::EventColumns& events);
void append_triggers(const py::array& array, std::vector<recordings::Trigger>& triggers);

}  // namespace e2lf::python
