// SPDX-License-Identifier: MIT

#include <algorithm>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/elements.h"
#include "e2lf/formats/table/table.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::formats::table {
namespace {

/// Calls visit(i, number) for the first `count` numbers of a column.
template <typename Visit>
void for_each_number(const NumberColumn& column, size_t count, const Visit& visit) {
  if (count == 0) return;  // there may be no records to point to
  const NumberField& field = column.field;
  const bool known = with_element_type(field.type, [&](auto type) {
    const uint8_t* next = column.records + field.offset;
    for (size_t i = 0; i < count; ++i, next += field.stride) visit(i, load_element<decltype(type)>(next));
  });
  E2LF_REQUIRE(known, "not a type of numbers: " + field.type);
}

/// Removes the events whose bad[i] is set, and returns their number.
size_t remove_bad(EventColumns& events, const Column<uint8_t>& bad) {
  if (std::find_if(bad.begin(), bad.end(), [](uint8_t b) { return b != 0; }) == bad.end()) return 0;
  size_t kept = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    if (bad[i] == 0) events.set(kept++, events[i]);
  }
  const size_t removed = events.size() - kept;
  events.resize(kept);
  return removed;
}

}  // namespace

bool is_number_type(const std::string& type) {
  return element_size(type) > 0;
}

template <typename T>
void to_column(const NumberColumn& column, size_t count, T* out, uint8_t* bad) {
  for_each_number(column, count, [&](size_t i, auto number) { bad[i] |= convert_one(number, out[i]); });
}

template void to_column(const NumberColumn&, size_t, uint8_t*, uint8_t*);
template void to_column(const NumberColumn&, size_t, uint16_t*, uint8_t*);

void to_times(const NumberColumn& column, TimeUnit unit, size_t count, int64_t* out, uint8_t* bad) {
  for_each_number(column, count, [&](size_t i, auto number) { bad[i] |= convert_time(number, unit, out[i]); });
}

size_t to_events(std::span<const NumberColumn> columns, const TableLayout& layout, size_t count, EventColumns& events) {
  const auto [x, y, p, t] = layout.columns;
  events.resize(count);
  Column<uint8_t> bad(count, 0);
  to_column(columns[x], count, events.x.data(), bad.data());
  to_column(columns[y], count, events.y.data(), bad.data());
  for_each_number(columns[p], count, [&](size_t i, auto number) {
    events.p[i] = layout.polarity.of(static_cast<double>(number));
    bad[i] |= events.p[i] == PolarityCode::kNone;
  });
  to_times(columns[t], layout.unit, count, events.t.data(), bad.data());
  return remove_bad(events, bad);
}

std::vector<double> to_doubles(const NumberColumn& column, size_t count) {
  std::vector<double> values(count);
  for_each_number(column, count, [&](size_t i, auto number) { values[i] = static_cast<double>(number); });
  return values;
}

TableSample::Column sample_of(std::string name, const NumberColumn& column, size_t count) {
  TableSample::Column sample{.name = std::move(name), .values = to_doubles(column, count)};
  sample.mantissa_bits = column.field.type == "f2" ? 10 : column.field.type == "f4" ? 23 : 0;
  return sample;
}

bool read_sensor_size(const std::function<std::vector<double>(const char* name)>& numbers, RecordingInfo& info) {
  constexpr double kWidestPx = 65536;
  std::vector<double> size = numbers("size");
  if (size.size() != 2) {
    size = numbers("sensor_resolution");
    std::reverse(size.begin(), size.end());
  }
  if (size.size() != 2) {
    size = numbers("width");
    for (const double height : numbers("height")) size.push_back(height);
  }
  const auto is_side = [](double side) { return side >= 1 && side <= kWidestPx && side == std::trunc(side); };
  if (size.size() != 2 || !is_side(size[0]) || !is_side(size[1])) return false;
  info.width = static_cast<size_t>(size[0]);
  info.height = static_cast<size_t>(size[1]);
  return true;
}

}  // namespace e2lf::formats::table
