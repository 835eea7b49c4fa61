// SPDX-License-Identifier: MIT
// Encodes chunks of the ECF filter; declared in ecf_chunk.h.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "e2lf/recordings/codecs/metavision_hdf5/ecf/ecf_chunk.h"

namespace e2lf::recordings::ecf {
namespace {

constexpr size_t kTimeBytesPerEvent = 17;  // 16 digits of a gap and the run
constexpr size_t kPlaceBytesPerEvent = 6;  // u16 y run, u16 x group, u8 p run, rounded up

uint8_t* put_u16(uint8_t* out, uint32_t value) {
  out[0] = static_cast<uint8_t>(value);
  out[1] = static_cast<uint8_t>(value >> 8);
  return out + 2;
}

uint8_t* put_u32(uint8_t* out, uint32_t value) {
  return put_u16(put_u16(out, value), value >> 16);
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
  const auto first = static_cast<uint64_t>(t[0]);
  out = put_u32(put_u32(out, static_cast<uint32_t>(first)), static_cast<uint32_t>(first >> 32));
  int64_t last = t[0];
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

uint8_t* put_y_runs(std::span<const uint16_t> y, uint8_t* out) {
  for_each_run(y, [&](size_t begin, size_t end) {
    const auto count = static_cast<uint32_t>(end - begin);
    out = put_u16(out, static_cast<uint32_t>(y[begin]) << 5 | std::min(count, 31u));
    if (count >= 31) out = put_u16(out, count);
  });
  return out;
}

uint8_t* put_p_runs(std::span<const uint8_t> p, uint8_t* out) {
  for_each_run(p, [&](size_t begin, size_t end) {
    const auto count = static_cast<uint32_t>(end - begin);
    *out++ = static_cast<uint8_t>(p[begin] << 7 | std::min(count, 127u));
    if (count >= 127) out = put_u16(out, count);
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

/// Returns the minimum size of the output of put_x_groups() and put_p_runs(): a step that does not fit in a group
/// begins the next one.
size_t min_size_of_runs(const ChunkColumns& e) {
  const size_t n = e.x.size();
  uint32_t groups = 1, runs = 1;
  for (size_t i = 1; i < n; ++i) groups += static_cast<uint16_t>(e.x[i] - e.x[i - 1] - 1) > 4 ? 1 : 0;
  for (size_t i = 1; i < n; ++i) runs += e.p[i] != e.p[i - 1] ? 1 : 0;
  return size_t{2} * groups + runs;
}

uint8_t* put_xp_packed(const ChunkColumns& e, uint8_t* out) {
  const size_t n = e.x.size();
  const auto value = [&](size_t i) { return i < n ? static_cast<uint32_t>(e.x[i]) << 1 | e.p[i] : 0u; };
  for (size_t i = 0; i < n; i += 4) {
    const uint32_t v1 = value(i + 1), v2 = value(i + 2);
    out = put_u16(out, value(i) << 4 | (v1 & 0xF));
    out = put_u16(out, (v1 >> 4) << 8 | (v2 & 0xFF));
    out = put_u16(out, (v2 >> 8) << 12 | value(i + 3));
  }
  return out;
}

uint8_t* put_yxp_packed(const ChunkColumns& e, uint8_t* out) {
  const size_t n = e.x.size();
  const auto value = [&](size_t i) {
    return i < n ? static_cast<uint32_t>(e.y[i]) << 12 | static_cast<uint32_t>(e.x[i]) << 1 | e.p[i] : 0u;
  };
  for (size_t i = 0; i < n; i += 4) {
    const uint32_t v1 = value(i + 1), v2 = value(i + 2);
    out = put_u32(out, value(i) << 8 | (v1 & 0xFF));
    out = put_u32(out, (v1 >> 8) << 16 | (v2 & 0xFFFF));
    out = put_u32(out, (v2 >> 16) << 24 | value(i + 3));
  }
  return out;
}

}  // namespace

bool can_encode(const ChunkColumns& e) {
  if (e.x.empty() || e.x.size() > kMaxChunkEvents) return false;
  uint32_t coordinates = 0, polarities = 0;
  for (size_t i = 0; i < e.x.size(); ++i) {
    coordinates |= static_cast<uint32_t>(e.x[i] | e.y[i]);
    polarities |= e.p[i];
  }
  int64_t falls = e.t[0] < 0;
  for (size_t i = 1; i < e.t.size(); ++i) falls |= e.t[i] < e.t[i - 1];
  return coordinates <= kMaxCoordinate && polarities <= 1 && falls == 0 && e.t.back() < kEndOfTime;
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
  uint32_t layout = 0;
  uint8_t* const after_y = put_y_runs(e.y, places);
  uint8_t* end = nullptr;
  if (after_y + quads * 6 >= places + quads * 12) {
    layout = 2;
    end = put_yxp_packed(e, places);
  } else {
    const bool may_group = min_size_of_runs(e) <= quads * 6;
    if (may_group) end = put_p_runs(e.p, put_x_groups(e.x, after_y));
    if (!may_group || end > after_y + quads * 6) {
      layout = 1;
      end = put_xp_packed(e, after_y);
    }
  }
  put_u32(out.data(), static_cast<uint32_t>(n) << 2 | layout);
  return static_cast<size_t>(end - out.data());
}

}  // namespace e2lf::recordings::ecf
