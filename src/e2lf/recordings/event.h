// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "e2lf/base/memory.h"

namespace e2lf::recordings {

/// Times beyond +-this value (36,000 years) are damage. Readers drop them, so that differences of times never overflow.
inline constexpr int64_t kTimeLimitUs = int64_t{1} << 60;

[[nodiscard]] constexpr bool is_time(int64_t t_us) {
  return t_us >= -kTimeLimitUs && t_us <= kTimeLimitUs;
}

/// A change of the brightness of one pixel: x and y are counted from the top left, p is 1 for ON (brighter) and 0 for
/// OFF, and t is in microseconds.
struct Event {
  uint16_t x = 0;
  uint16_t y = 0;
  uint8_t p = 0;
  int64_t t = 0;
  bool operator==(const Event&) const = default;
};

/// An edge on an external trigger input: t is in microseconds, id is the number of the input, and p is 1 for a rising
/// and 0 for a falling edge.
struct Trigger {
  int64_t t = 0;
  uint16_t id = 0;
  uint8_t p = 0;
  bool operator==(const Trigger&) const = default;
};

/// Columns are resized and then filled by kernels.
template <typename T>
using Column = UninitialisedVector<T>;

/// Events as four columns of equal length.
struct EventColumns {
  Column<uint16_t> x;
  Column<uint16_t> y;
  Column<uint8_t> p;
  Column<int64_t> t;

  [[nodiscard]] size_t size() const { return t.size(); }
  [[nodiscard]] bool empty() const { return t.empty(); }
  [[nodiscard]] Event operator[](size_t i) const { return {x[i], y[i], p[i], t[i]}; }

  void clear() { resize(0); }

  /// Sets the length; the values of new elements are unspecified.
  void resize(size_t count) {
    for_each_column([count](auto& column) { column.resize(count); });
  }
  void reserve(size_t count) {
    for_each_column([count](auto& column) { column.reserve(count); });
  }
  void set(size_t i, const Event& event) {
    x[i] = event.x;
    y[i] = event.y;
    p[i] = event.p;
    t[i] = event.t;
  }
  void push_back(const Event& event) {
    x.push_back(event.x);
    y.push_back(event.y);
    p.push_back(event.p);
    t.push_back(event.t);
  }
  /// Appends the events [begin, end) of another set of columns.
  void append(const EventColumns& other, size_t begin, size_t end) {
    const auto copy = [begin, end](auto& to, const auto& from) {
      to.insert(to.end(), from.begin() + static_cast<ptrdiff_t>(begin), from.begin() + static_cast<ptrdiff_t>(end));
    };
    copy(x, other.x);
    copy(y, other.y);
    copy(p, other.p);
    copy(t, other.t);
  }
  void append(const EventColumns& other) { append(other, 0, other.size()); }
  /// Removes the events [begin, end) without releasing memory.
  void erase(size_t begin, size_t end) {
    for_each_column([begin, end](auto& column) {
      column.erase(column.begin() + static_cast<ptrdiff_t>(begin), column.begin() + static_cast<ptrdiff_t>(end));
    });
  }
  bool operator==(const EventColumns&) const = default;

 private:
  template <typename Visit>
  void for_each_column(const Visit& visit) {
    visit(x);
    visit(y);
    visit(p);
    visit(t);
  }
};

/// Returns the number of polarities that are ON; each is 0 or 1.
[[nodiscard]] uint64_t count_on(std::span<const uint8_t> p);

/// A section of a recording: events and triggers, each sorted by time.
struct EventBatch {
  EventColumns events;
  std::vector<Trigger> triggers;

  [[nodiscard]] bool empty() const { return events.empty() && triggers.empty(); }

  /// Return the times of the first and of the last event or trigger; INT64_MAX and INT64_MIN if there is none.
  [[nodiscard]] int64_t first_us() const {
    const int64_t trigger_us = triggers.empty() ? INT64_MAX : triggers.front().t;
    return events.empty() ? trigger_us : std::min(events.t.front(), trigger_us);
  }
  [[nodiscard]] int64_t last_us() const {
    const int64_t trigger_us = triggers.empty() ? INT64_MIN : triggers.back().t;
    return events.empty() ? trigger_us : std::max(events.t.back(), trigger_us);
  }

  /// Adds to all times.
  void shift(int64_t by_us) {
    for (int64_t& t_us : events.t) t_us += by_us;
    for (Trigger& trigger : triggers) trigger.t += by_us;
  }
  void clear() {
    events.clear();
    triggers.clear();
  }
  void append(const EventBatch& other) {
    events.append(other.events);
    triggers.insert(triggers.end(), other.triggers.begin(), other.triggers.end());
  }
  bool operator==(const EventBatch&) const = default;
};

}  // namespace e2lf::recordings
