// SPDX-License-Identifier: MIT
#include "e2lf/base/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <sys/resource.h>

#include "e2lf/base/text.h"

namespace e2lf {
namespace {

constexpr uint64_t kUnknown = std::numeric_limits<uint64_t>::max();

/// Returns the value of the entry "key: N kB" in a file of /proc, in bytes.
uint64_t proc_bytes(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    uint64_t kib = 0;
    if (word == key + ":" && file >> kib) return kib * 1024;
  }
  return kUnknown;
}

uint64_t left_of_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  const uint64_t used = proc_bytes("/proc/self/status", "VmSize");
  if (used == kUnknown) return kUnknown;
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

std::string gib_text(uint64_t bytes) {
  const uint64_t tenths = (bytes * 10 + (uint64_t{1} << 30) - 1) >> 30;
  return cat(tenths / 10, ".", tenths % 10, " GiB");
}

}  // namespace

uint64_t available_memory_bytes() {
  return std::min(proc_bytes("/proc/meminfo", "MemAvailable"), left_of_limit());
}

Result<void> require_memory(uint64_t bytes, const std::string& remedy, const std::string& location) {
  const uint64_t available = available_memory_bytes();
  if (bytes <= available) return {};
  return fail(ErrorCode::kUnsupported, location, "this takes about ", gib_text(bytes), " of memory, and ",
              gib_text(available), " are free; ", remedy);
}

}  // namespace e2lf
