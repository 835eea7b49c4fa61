// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

namespace e2lf::recordings::ecf {
namespace {

Error truncated(size_t byte) {
  return fail(ErrorCode::kTruncated, cat("chunk byte ", byte), "an ECF chunk ends early; the file is damaged");
}

Error overrun(const char* what) {
  return fail(ErrorCode::kFormat, "", "an ECF chunk has ", what, "; the file is damaged");
}

/// Reads little-endian values and stores whether the chunk was long enough.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : next_(bytes.data()), begin_(next_), end_(next_ + bytes.size()) {}

  bool u8(uint32_t& value) { return read<uint8_t>(value); }
  bool u16(uint32_t& value) { return read<uint16_t>(value); }
  bool u64(uint64_t& value) { return read<uint64_t>(value); }
  /// Returns the next `count` bytes, or null.
  const uint8_t* take(size_t count) {
    if (static_cast<size_t>(end_ - next_) < count) return nullptr;
    next_ += count;
    return next_ - count;
  }
  [[nodiscard]] Error error() const { return truncated(static_cast<size_t>(next_ - begin_)); }

 private:
  template <typename Word, typename Value>
  bool read(Value& value) {
    if (end_ - next_ < static_cast<ptrdiff_t>(sizeof(Word))) return false;
    value = load_le<Word>(next_);
    next_ += sizeof(Word);
    return true;
  }

  const uint8_t *next_, *begin_, *end_;
};

/// Writes a run of equal values at `done` and advances it; returns false if the run does not fit.
template <typename T>
bool fill_run(std::span<T> column, size_t& done, size_t count, T value) {
  if (count > column.size() - done) return false;
  T* const out = column.data() + done;
  for (size_t i = 0; i < count; ++i) out[i] = value;
  done += count;
  return true;
}

Result<void> read_times(Cursor& in, std::span<int64_t> t) {
  uint64_t now = 0, gap = 0;
  uint32_t digits = 0, byte = 0;
  if (!in.u64(now)) return in.error();
  for (size_t done = 0; done < t.size();) {
    if (!in.u8(byte)) return in.error();
    uint32_t count = byte & 15;
    if (byte >= 0xF0) {
      if (digits == 16) return overrun("a time gap of more than 64 bits");
      gap |= static_cast<uint64_t>(count) << (4 * digits++);
      continue;
    }
    if (now >= kEndOfTime || gap >= kEndOfTime) return overrun("a time beyond 2^62 us");
    now += gap + (byte >> 4);
    gap = digits = 0;
    if (now >= kEndOfTime) return overrun("a time beyond 2^62 us");
    if (count == 15 && !in.u16(count)) return in.error();
    if (count == 0) return overrun("a run of no times");
    if (!fill_run(t, done, count, static_cast<int64_t>(now))) return overrun("a run of times longer than itself");
  }
  return {};
}

/// Reads words with the length of a run in the low kCountBits, and its value above. The longest run means that 16 bits
/// with the length follow.
template <auto kReadWord, unsigned kCountBits, typename T>
Result<void> read_runs(Cursor& in, std::span<T> column, const char* overlong) {
  constexpr uint32_t kLongest = (1U << kCountBits) - 1;
  uint32_t word = 0;
  for (size_t done = 0; done < column.size();) {
    if (!(in.*kReadWord)(word)) return in.error();
    uint32_t count = word & kLongest;
    if (count == kLongest && !in.u16(count)) return in.error();
    if (!fill_run(column, done, count, static_cast<T>(word >> kCountBits))) return overrun(overlong);
  }
  return {};
}

Result<void> read_x_groups(Cursor& in, std::span<uint16_t> x) {
  uint32_t word = 0;
  for (size_t done = 0; done < x.size();) {
    if (!in.u16(word)) return in.error();
    const uint32_t base = word >> 5;
    x[done++] = static_cast<uint16_t>(base);
    for (uint32_t step = 1; step <= 5; ++step) {
      if ((word >> (5 - step) & 1) == 0) continue;
      if (done == x.size()) return overrun("a column group longer than itself");
      x[done++] = static_cast<uint16_t>(base + step);
    }
  }
  return {};
}

void unpack_xp(uint32_t value, const MutableChunkColumns& e, size_t i) {
  e.x[i] = static_cast<uint16_t>(value >> 1 & kMaxCoordinate);
  e.p[i] = static_cast<uint8_t>(value & 1);
}

void unpack_yxp(uint32_t value, const MutableChunkColumns& e, size_t i) {
  e.y[i] = static_cast<uint16_t>(value >> 12 & kMaxCoordinate);
  unpack_xp(value, e, i);
}

/// Calls set(i, value) for the `count` values of `width` bits (12 or 24), of which four are packed in three words of
/// type Word.
template <typename Word, typename Set>
void for_each_packed(const uint8_t* bytes, size_t count, Set&& set) {
  constexpr unsigned kBits = sizeof(Word) * 8, kQuarter = kBits / 4;
  constexpr Word kLow1 = static_cast<Word>((Word{1} << kQuarter) - 1);
  constexpr Word kLow2 = static_cast<Word>((Word{1} << 2 * kQuarter) - 1);
  constexpr Word kLow3 = static_cast<Word>((Word{1} << 3 * kQuarter) - 1);
  for (size_t i = 0; i < count; i += 4, bytes += 3 * sizeof(Word)) {
    Word w[3];
    std::memcpy(w, bytes, sizeof(w));
    const uint32_t values[4] = {
        static_cast<uint32_t>(w[0] >> kQuarter),
        static_cast<uint32_t>((w[0] & kLow1) | static_cast<uint32_t>(w[1] >> 2 * kQuarter) << kQuarter),
        static_cast<uint32_t>((w[1] & kLow2) | static_cast<uint32_t>(w[2] >> 3 * kQuarter) << 2 * kQuarter),
        static_cast<uint32_t>(w[2] & kLow3)};
    for (size_t j = 0; j < std::min<size_t>(4, count - i); ++j) set(i + j, values[j]);
  }
}

constexpr size_t kTimeBytesPerEvent = 17;  // 16 digits of a gap and the run
constexpr size_t kPlaceBytesPerEvent = 6;  // u16 y run, u16 x group, u8 p run, rounded up

uint8_t* put_u16(uint8_t* out, uint32_t value) {
  store_le(out, static_cast<uint16_t>(value));
  return out + 2;
}

/// Sets bit i if values[begin + i] differs from the value before it; begin > 0.
template <typename T>
uint64_t changes_at(std::span<const T> values, size_t begin) {
  std::array<uint8_t, 64> differs{};
  const T* const before = values.data() + begin - 1;
  const size_t count = std::min(differs.size(), values.size() - begin);
  for (size_t i = 0; i < count; ++i) differs[i] = before[i + 1] != before[i] ? 1 : 0;
  uint64_t changes = 0;
  for (size_t i = 0; i < 64; i += 8) {
    uint64_t bytes = 0;
    std::memcpy(&bytes, &differs[i], 8);
    // Gathers the lowest bits of eight bytes.
    changes |= (bytes * 0x0102040810204080) >> 56 << i;
  }
  return changes;
}

/// Calls visit(begin, end) for each run of equal values. The ends of runs are found for 64 values at a time, because
/// processors cannot predict the end of a short run.
template <typename T, typename Visit>
void for_each_run(std::span<const T> values, const Visit& visit) {
  size_t begin = 0;
  for (size_t block = 1; block < values.size(); block += 64) {
    for (uint64_t changes = changes_at(values, block); changes != 0; changes &= changes - 1) {
      const size_t end = block + static_cast<size_t>(std::countr_zero(changes));
      visit(begin, end);
      begin = end;
    }
  }
  visit(begin, values.size());
}

uint8_t* put_times(std::span<const int64_t> t, uint8_t* out) {
  int64_t last = t[0];
  store_le(out, last);
  out += sizeof(last);
  for_each_run(t, [&](size_t begin, size_t end) {
    auto gap = static_cast<uint64_t>(t[begin] - last);
    last = t[begin];
    if (gap >= 15) {
      for (; gap > 0; gap >>= 4) *out++ = static_cast<uint8_t>(0xF0 | (gap & 15));
    }
    const size_t count = end - begin;
    *out++ = static_cast<uint8_t>(gap << 4 | std::min<size_t>(count, 15));
    if (count >= 15) out = put_u16(out, static_cast<uint32_t>(count));
  });
  return out;
}

/// Writes what read_runs() reads, in words of the type of the values.
template <unsigned kCountBits, typename T>
uint8_t* put_runs(std::span<const T> values, uint8_t* out) {
  constexpr uint32_t kLongest = (1U << kCountBits) - 1;
  for_each_run(values, [&](size_t begin, size_t end) {
    const auto count = static_cast<uint32_t>(end - begin);
    store_le(out, static_cast<T>(uint32_t{values[begin]} << kCountBits | std::min(count, kLongest)));
    out += sizeof(T);
    if (count >= kLongest) out = put_u16(out, count);
  });
  return out;
}

uint8_t* put_x_groups(std::span<const uint16_t> x, uint8_t* out) {
  for (size_t i = 0; i < x.size();) {
    const uint32_t base = x[i++];
    uint32_t mask = 0;
    for (uint32_t last = 0; i < x.size(); ++i) {
      const uint32_t step = x[i] - base;  // wraps to a large number if x decreases
      if (step <= last || step > 5) break;
      mask |= 1u << (5 - step);
      last = step;
    }
    out = put_u16(out, base << 5 | mask);
  }
  return out;
}

/// Returns the minimum size of the output of put_x_groups() and put_runs(): a step that does not fit in a group
/// begins the next one.
size_t min_size_of_runs(const ChunkColumns& e) {
  const size_t n = e.x.size();
  uint32_t groups = 1, runs = 1;
  for (size_t i = 1; i < n; ++i) groups += static_cast<uint16_t>(e.x[i] - e.x[i - 1] - 1) > 4 ? 1 : 0;
  for (size_t i = 1; i < n; ++i) runs += e.p[i] != e.p[i - 1] ? 1 : 0;
  return size_t{2} * groups + runs;
}

/// Writes what for_each_packed() reads; the last group is filled up with zeros.
template <typename Word, typename Value>
uint8_t* put_packed(size_t count, const Value& value_of, uint8_t* out) {
  constexpr unsigned kQuarter = sizeof(Word) * 2;
  const auto value = [&](size_t i) { return i < count ? value_of(i) : 0U; };
  for (size_t i = 0; i < count; i += 4, out += 3 * sizeof(Word)) {
    const uint32_t v1 = value(i + 1), v2 = value(i + 2);
    const Word w[3] = {static_cast<Word>(value(i) << kQuarter | (v1 & ((1U << kQuarter) - 1))),
                       static_cast<Word>((v1 >> kQuarter) << 2 * kQuarter | (v2 & ((1U << 2 * kQuarter) - 1))),
                       static_cast<Word>((v2 >> 2 * kQuarter) << 3 * kQuarter | value(i + 3))};
    std::memcpy(out, w, sizeof(w));
  }
  return out;
}

}  // namespace

Result<size_t> event_count(std::span<const uint8_t> chunk) {
  if (chunk.size() < 12) return truncated(chunk.size());
  const size_t count = load_le<uint32_t>(chunk.data()) >> 2;
  if (count > kMaxChunkEvents) return overrun("a count of more than 65535 events");
  return count;
}

Result<void> decode(std::span<const uint8_t> chunk, const MutableChunkColumns& e) {
  E2LF_ASSIGN_OR_RETURN(const size_t n, event_count(chunk));
  E2LF_REQUIRE(e.x.size() == n && e.y.size() == n && e.p.size() == n && e.t.size() == n,
               "columns must have the chunk's number of events");
  const uint32_t layout = chunk[0] & 3;
  Cursor in(chunk.subspan(4));
  E2LF_RETURN_IF_ERROR(read_times(in, e.t));
  const size_t quads = (n + 3) / 4;
  if (layout & 2) {
    const uint8_t* packed = in.take(quads * 12);
    if (packed == nullptr) return in.error();
    for_each_packed<uint32_t>(packed, n, [&](size_t i, uint32_t value) { unpack_yxp(value, e, i); });
    return {};
  }
  E2LF_RETURN_IF_ERROR((read_runs<&Cursor::u16, 5>(in, e.y, "a row run longer than itself")));
  if (layout & 1) {
    const uint8_t* packed = in.take(quads * 6);
    if (packed == nullptr) return in.error();
    for_each_packed<uint16_t>(packed, n, [&](size_t i, uint32_t value) { unpack_xp(value, e, i); });
    return {};
  }
  E2LF_RETURN_IF_ERROR(read_x_groups(in, e.x));
  return read_runs<&Cursor::u8, 7>(in, e.p, "a polarity run longer than itself");
}

namespace {

/// Returns whether the events [begin, end), which are all at x = 0, are zeros in place of data.
bool are_zeros(bool has_packed_places, const MutableChunkColumns& e, size_t begin, size_t end) {
  if (end - begin < kMinZeros) return false;
  bool are_at_origin = true, have_equals = false;
  for (size_t i = begin; i < end; ++i) {
    are_at_origin = are_at_origin && e.y[i] == 0 && e.p[i] == 0;
    have_equals = have_equals || (i > begin && e.y[i] == e.y[i - 1] && e.p[i] == e.p[i - 1] && e.t[i] == e.t[i - 1]);
  }
  return has_packed_places ? are_at_origin : have_equals;
}

/// Moves the events [begin, end) to `to`, which is not after them.
void move_events(const MutableChunkColumns& e, size_t begin, size_t end, size_t to) {
  const auto move = [=](auto column) {
    std::copy(column.begin() + static_cast<ptrdiff_t>(begin), column.begin() + static_cast<ptrdiff_t>(end),
              column.begin() + static_cast<ptrdiff_t>(to));
  };
  move(e.x);
  move(e.y);
  move(e.p);
  move(e.t);
}

}  // namespace

size_t drop_zeros(std::span<const uint8_t> chunk, const MutableChunkColumns& e) {
  const size_t n = e.x.size();
  const bool has_packed_places = (chunk[0] & 2) != 0;
  // A place of its own is all zeros, while the others only have no column.
  const auto may_be_zero = [&](size_t i) { return e.x[i] == 0 && (!has_packed_places || (e.y[i] | e.p[i]) == 0); };
  std::vector<std::pair<size_t, size_t>> zeros;
  // A run of kMinZeros contains an event whose number is a multiple of it.
  for (size_t probe = 0; probe < n; probe += kMinZeros) {
    if (!may_be_zero(probe) || (!zeros.empty() && probe < zeros.back().second)) continue;
    size_t begin = probe, end = probe + 1;
    while (begin > 0 && may_be_zero(begin - 1)) --begin;
    while (end < n && may_be_zero(end)) ++end;
    if (are_zeros(has_packed_places, e, begin, end)) zeros.emplace_back(begin, end);
  }
  if (zeros.empty()) return n;
  size_t kept = zeros.front().first;
  for (size_t i = 0; i < zeros.size(); ++i) {
    const size_t next = i + 1 < zeros.size() ? zeros[i + 1].first : n;
    move_events(e, zeros[i].second, next, kept);
    kept += next - zeros[i].second;
  }
  return kept;
}

bool can_encode(const ChunkColumns& e) {
  if (e.x.empty() || e.x.size() > kMaxChunkEvents) return false;
  uint32_t coordinates = 0, polarities = 0;
  for (size_t i = 0; i < e.x.size(); ++i) {
    coordinates |= static_cast<uint32_t>(e.x[i] | e.y[i]);
    polarities |= e.p[i];
  }
  int64_t falls = e.t[0] < 0;
  for (size_t i = 1; i < e.t.size(); ++i) falls |= e.t[i] < e.t[i - 1];
  return coordinates <= kMaxCoordinate && polarities <= 1 && falls == 0 &&
         e.t.back() < static_cast<int64_t>(kEndOfTime);
}

size_t max_encoded_size(size_t events) {
  return 12 + events * (kTimeBytesPerEvent + kPlaceBytesPerEvent) + 12;
}

size_t encode(const ChunkColumns& e, std::span<uint8_t> out) {
  const size_t n = e.x.size();
  E2LF_ASSERT(can_encode(e));
  E2LF_REQUIRE(out.size() >= max_encoded_size(n), "the output is too small for an ECF chunk");
  uint8_t* const places = put_times(e.t, out.data() + 4);
  const size_t quads = (n + 3) / 4;

  // Encodes runs of y, then x groups with runs of p, and abandons each if its packed form is smaller. If this can be
  // determined in advance, groups are not formed, because processors cannot predict where they end.
  const auto xp = [&](size_t i) { return uint32_t{e.x[i]} << 1 | e.p[i]; };
  const auto yxp = [&](size_t i) { return uint32_t{e.y[i]} << 12 | xp(i); };
  uint32_t layout = 0;
  uint8_t* const after_y = put_runs<5>(e.y, places);
  uint8_t* end = nullptr;
  if (after_y + quads * 6 >= places + quads * 12) {
    layout = 2;
    end = put_packed<uint32_t>(n, yxp, places);
  } else {
    const bool may_group = min_size_of_runs(e) <= quads * 6;
    if (may_group) end = put_runs<7>(e.p, put_x_groups(e.x, after_y));
    if (!may_group || end > after_y + quads * 6) {
      layout = 1;
      end = put_packed<uint16_t>(n, xp, after_y);
    }
  }
  store_le(out.data(), static_cast<uint32_t>(n) << 2 | layout);
  return static_cast<size_t>(end - out.data());
}

}  // namespace e2lf::recordings::ecf
