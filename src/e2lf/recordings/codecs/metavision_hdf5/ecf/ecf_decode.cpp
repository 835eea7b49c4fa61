// SPDX-License-Identifier: MIT
// Decodes chunks of the ECF filter; declared in ecf_chunk.h.
#include <algorithm>
#include <cstring>

#include "e2lf/base/text.h"
#include "e2lf/recordings/codecs/metavision_hdf5/ecf/ecf_chunk.h"

namespace e2lf::recordings::ecf {
namespace {

constexpr uint64_t kTimeLimit = uint64_t{1} << 62;

Error truncated(size_t byte) {
  return {ErrorCode::kTruncated, "an ECF chunk ends early; the file is damaged", cat("chunk byte ", byte)};
}

Error overrun(const char* what) {
  return {ErrorCode::kFormat, cat("an ECF chunk has ", what, "; the file is damaged"), ""};
}

/// Reads little-endian values and stores whether the chunk was long enough.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : next_(bytes.data()), begin_(next_), end_(next_ + bytes.size()) {}

  bool u8(uint32_t& value) {
    if (next_ == end_) return false;
    value = *next_++;
    return true;
  }
  bool u16(uint32_t& value) {
    if (end_ - next_ < 2) return false;
    value = static_cast<uint32_t>(next_[0] | next_[1] << 8);
    next_ += 2;
    return true;
  }
  bool u64(uint64_t& value) {
    if (end_ - next_ < 8) return false;
    value = 0;
    for (int i = 7; i >= 0; --i) value = value << 8 | next_[i];
    next_ += 8;
    return true;
  }
  /// Returns the next `count` bytes, or null.
  const uint8_t* take(size_t count) {
    if (static_cast<size_t>(end_ - next_) < count) return nullptr;
    next_ += count;
    return next_ - count;
  }
  [[nodiscard]] Error error() const { return truncated(static_cast<size_t>(next_ - begin_)); }

 private:
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
    if (now >= kTimeLimit || gap >= kTimeLimit) return overrun("a time beyond 2^62 us");
    now += gap + (byte >> 4);
    gap = digits = 0;
    if (now >= kTimeLimit) return overrun("a time beyond 2^62 us");
    if (count == 15 && !in.u16(count)) return in.error();
    if (!fill_run(t, done, count, static_cast<int64_t>(now))) return overrun("a run of times longer than itself");
  }
  return {};
}

Result<void> read_y_runs(Cursor& in, std::span<uint16_t> y) {
  uint32_t word = 0;
  for (size_t done = 0; done < y.size();) {
    if (!in.u16(word)) return in.error();
    uint32_t count = word & 31;
    if (count == 31 && !in.u16(count)) return in.error();
    if (!fill_run(y, done, count, static_cast<uint16_t>(word >> 5))) return overrun("a row run longer than itself");
  }
  return {};
}

Result<void> read_p_runs(Cursor& in, std::span<uint8_t> p) {
  uint32_t byte = 0;
  for (size_t done = 0; done < p.size();) {
    if (!in.u8(byte)) return in.error();
    uint32_t count = byte & 127;
    if (count == 127 && !in.u16(count)) return in.error();
    if (!fill_run(p, done, count, static_cast<uint8_t>(byte >> 7))) return overrun("a polarity run longer than itself");
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

}  // namespace

Result<size_t> event_count(std::span<const uint8_t> chunk) {
  if (chunk.size() < 12) return truncated(chunk.size());
  uint32_t header = 0;
  std::memcpy(&header, chunk.data(), sizeof(header));
  const size_t count = header >> 2;
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
  E2LF_RETURN_IF_ERROR(read_y_runs(in, e.y));
  if (layout & 1) {
    const uint8_t* packed = in.take(quads * 6);
    if (packed == nullptr) return in.error();
    for_each_packed<uint16_t>(packed, n, [&](size_t i, uint32_t value) { unpack_xp(value, e, i); });
    return {};
  }
  E2LF_RETURN_IF_ERROR(read_x_groups(in, e.x));
  return read_p_runs(in, e.p);
}

}  // namespace e2lf::recordings::ecf
