// SPDX-License-Identifier: MIT
#include "python/binding/events.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "e2lf/base/text.h"
#include "python/binding/calls.h"

namespace e2lf::python {
namespace {

/// Keeps the memory of freed arrays for later ones. While recordings are read, it keeps enough for large slices,
/// because allocating new memory takes several times as long as filling it.
class RecordBuffers {
 public:
  /// Returns the largest buffer, because slices grow.
  EventRecords take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return {};
    EventRecords records = std::move(free_.back());
    free_.pop_back();
    records.clear();
    return records;
  }
  void give_back(EventRecords records) {
    const std::lock_guard lock(mutex_);
    const auto is_smaller = [](const EventRecords& a, const EventRecords& b) { return a.capacity() < b.capacity(); };
    free_.insert(std::upper_bound(free_.begin(), free_.end(), records, is_smaller), std::move(records));
    trim();
  }
  void count_readers(int change) {
    const std::lock_guard lock(mutex_);
    readers_ += change;
    trim();
  }

 private:
  void trim() {
    const size_t most_events = readers_ > 0 ? kMostEvents : kMostIdleEvents;
    const auto room = [](size_t sum, const EventRecords& records) { return sum + records.capacity(); };
    while (free_.size() > kMostBuffers || std::accumulate(free_.begin(), free_.end(), size_t{0}, room) > most_events) {
      free_.erase(free_.begin());
    }
  }

  static constexpr size_t kMostBuffers = 4;
  static constexpr size_t kMostEvents = size_t{1} << 25;      // 512 MB in all
  static constexpr size_t kMostIdleEvents = size_t{1} << 23;  // 128 MB
  std::mutex mutex_;
  std::vector<EventRecords> free_;  ///< by capacity, the largest last
  int readers_ = 0;
};

/// Never destroyed, because arrays may outlive all other objects.
RecordBuffers& buffers() {
  static auto* const all = new RecordBuffers;
  return *all;
}

struct Columns {
  const uint16_t* x;
  const uint16_t* y;
  const uint8_t* p;
  const int64_t* t;
};

void interleave_one_by_one(const Columns& from, size_t begin, size_t end, std::byte* records) {
  for (size_t i = begin; i < end; ++i) {
    const uint64_t head = uint64_t{from.x[i]} | uint64_t{from.y[i]} << 16 | uint64_t{from.p[i]} << 32;
    std::byte* to = records + i * sizeof(EventRecord);
    std::memcpy(to, &head, sizeof head);
    std::memcpy(to + sizeof head, from.t + i, sizeof(int64_t));
  }
}

#ifdef __SSE2__
/// Processes eight events at a time, which halves the time; iterating spends a third of its time here. With `kIsLarge`,
/// bypasses the caches, which avoids reading the memory that is overwritten; `records` must then be aligned to 16
/// bytes.
template <bool kIsLarge>
void interleave_eights(const Columns& from, size_t count, std::byte* records) {
  const auto load = [](const auto* values) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(values)); };
  const auto store = [](__m128i* to, __m128i record) {
    if constexpr (kIsLarge) {
      _mm_stream_si128(to, record);
    } else {
      _mm_storeu_si128(to, record);
    }
  };
  const __m128i zero = _mm_setzero_si128();
  size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m128i x = load(from.x + i), y = load(from.y + i);
    const __m128i p = _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from.p + i)), zero);
    const __m128i xy[2] = {_mm_unpacklo_epi16(x, y), _mm_unpackhi_epi16(x, y)};
    const __m128i p0[2] = {_mm_unpacklo_epi16(p, zero), _mm_unpackhi_epi16(p, zero)};
    auto* to = reinterpret_cast<__m128i*>(records + i * sizeof(EventRecord));
    for (size_t half = 0; half < 2; ++half) {
      const __m128i heads[2] = {_mm_unpacklo_epi32(xy[half], p0[half]), _mm_unpackhi_epi32(xy[half], p0[half])};
      for (size_t pair = 0; pair < 2; ++pair) {
        const __m128i t = load(from.t + i + 4 * half + 2 * pair);
        store(to++, _mm_unpacklo_epi64(heads[pair], t));
        store(to++, _mm_unpackhi_epi64(heads[pair], t));
      }
    }
  }
  if constexpr (kIsLarge) _mm_sfence();
  interleave_one_by_one(from, i, count, records);
}

void interleave(const Columns& from, size_t count, std::byte* records, bool is_large) {
  if (is_large && reinterpret_cast<uintptr_t>(records) % sizeof(__m128i) == 0) {
    interleave_eights<true>(from, count, records);
  } else {
    interleave_eights<false>(from, count, records);
  }
}
#else
void interleave(const Columns& from, size_t count, std::byte* records, bool /*is_large*/) {
  interleave_one_by_one(from, 0, count, records);
}
#endif

/// Returns a field as integers within [least, most].
py::array_t<int64_t> field_of(const py::array& array, const char* name, int64_t least, int64_t most) {
  const std::string place = cat("field ", name);
  if (!array.dtype().has_fields() || !array.dtype().attr("fields").contains(name)) {
    throw ResultError({ErrorCode::kFormat, "the field is missing; give a structured array that contains it", place});
  }
  const py::array field = array[name];
  if (std::string("iub").find(field.dtype().kind()) == std::string::npos || array.ndim() != 1) {
    throw ResultError({ErrorCode::kFormat, "this is not a list of integers; times are in microseconds", place});
  }
  // Values beyond int64 would become negative.
  if (field.dtype().kind() == 'u') least = std::max<int64_t>(least, 0);
  py::array_t<int64_t> values = py::array_t<int64_t, py::array::c_style | py::array::forcecast>(field);
  for (py::ssize_t i = 0; i < values.size(); ++i) {
    const int64_t value = values.data()[i];
    if (value >= least && value <= most) continue;
    throw ResultError(
        {ErrorCode::kInvalidValue, cat("the value ", value, " of entry ", i, " is not in ", least, "..", most), place});
  }
  return values;
}

}  // namespace

const py::dtype& event_dtype() {
  static const auto* const dtype = [] {
    PYBIND11_NUMPY_DTYPE(EventRecord, x, y, p, t);
    return new py::dtype(py::dtype::of<EventRecord>());
  }();
  return *dtype;
}

const py::dtype& trigger_dtype() {
  static const auto* const dtype = [] {
    PYBIND11_NUMPY_DTYPE(TriggerRecord, p, t, id);
    return new py::dtype(py::dtype::of<TriggerRecord>());
  }();
  return *dtype;
}

/// A slice with more events does not fit in the caches.
constexpr size_t kCachedEvents = size_t{1} << 16;

void append_records(const recordings::EventColumns& events, size_t begin, size_t end, EventRecords& records) {
  static_assert(std::endian::native == std::endian::little);
  const size_t known = records.size();
  records.resize(known + end - begin);
  const Columns from = {events.x.data() + begin, events.y.data() + begin, events.p.data() + begin,
                        events.t.data() + begin};
  interleave(from, end - begin, reinterpret_cast<std::byte*>(records.data() + known), known >= kCachedEvents);
}

EventRecords take_records() {
  return buffers().take();
}

void count_readers(int change) {
  buffers().count_readers(change);
}

py::array to_array(EventRecords records) {
  const auto size = static_cast<py::ssize_t>(records.size());
  auto owner = std::make_unique<EventRecords>(std::move(records));
  const py::capsule capsule(owner.get(), [](void* self) {
    const std::unique_ptr<EventRecords> ended(static_cast<EventRecords*>(self));
    buffers().give_back(std::move(*ended));
  });
  const EventRecords* values = owner.release();
  return py::array(event_dtype(), {size}, {}, values->data(), capsule);
}

py::array to_array(std::span<const recordings::Trigger> triggers) {
  py::array array(trigger_dtype(), std::vector{static_cast<py::ssize_t>(triggers.size())});
  auto* to = static_cast<TriggerRecord*>(array.mutable_data());
  for (const recordings::Trigger& trigger : triggers) {
    *to++ = {static_cast<int16_t>(trigger.p), {}, trigger.t, static_cast<int16_t>(trigger.id), {}};
  }
  return array;
}

void append_events(const py::array& array, recordings::EventColumns& events) {
  const auto x = field_of(array, "x", 0, UINT16_MAX);
  const auto y = field_of(array, "y", 0, UINT16_MAX);
  const auto p = field_of(array, "p", 0, 1);
  const auto t = field_of(array, "t", -recordings::kTimeLimitUs, recordings::kTimeLimitUs);
  const size_t known = events.size(), size = static_cast<size_t>(x.size());
  events.resize(known + size);
  for (size_t i = 0; i < size; ++i) {
    events.x[known + i] = static_cast<uint16_t>(x.data()[i]);
    events.y[known + i] = static_cast<uint16_t>(y.data()[i]);
    events.p[known + i] = static_cast<uint8_t>(p.data()[i]);
    events.t[known + i] = t.data()[i];
  }
}

void append_triggers(const py::array& array, std::vector<recordings::Trigger>& triggers) {
  const auto p = field_of(array, "p", 0, 1);
  const auto t = field_of(array, "t", -recordings::kTimeLimitUs, recordings::kTimeLimitUs);
  const auto id = field_of(array, "id", 0, INT16_MAX);
  for (py::ssize_t i = 0; i < p.size(); ++i) {
    triggers.push_back({t.data()[i], static_cast<uint16_t>(id.data()[i]), static_cast<uint8_t>(p.data()[i])});
  }
}

}  // namespace e2lf::python
