// SPDX-License-Identifier: MIT
// The target of pattern schedules: the input is a file.
#include "e2lf/cycles/schedule.h"
#include "require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf::cycles;
  using e2lf::fuzz::require;
  const auto schedule = parse_schedule(std::string(reinterpret_cast<const char*>(data), size), "input");
  if (!schedule) return 0;
  require(validate(*schedule, "input").ok(), "a schedule that was read is valid");
  require(schedule->cycle_us() > 0, "a cycle takes time");
  const auto back = parse_schedule(schedule_text(*schedule), "encoded");
  require(back.ok() && *back == *schedule, "a schedule comes back as written");
  return 0;
}
