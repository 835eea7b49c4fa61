// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Returns a recording in EVT4 of 64x48 px with these words. The library itself does not write EVT4.
inline std::vector<uint8_t> evt4_of_words(const std::vector<uint32_t>& words) {
  const std::string header = "% evt 4.0\n% format EVT4;height=48;width=64\n% end\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  for (const uint32_t word : words) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(word >> shift));
  }
  return bytes;
}

/// Returns the word of one event, or of a vector of events, by its type.
inline uint32_t evt4_event(uint32_t type, uint32_t low_us, uint32_t x, uint32_t y) {
  return type << 28 | low_us << 22 | x << 11 | y;
}

/// Returns the events and triggers as a recording in EVT4, with one word for each.
inline std::vector<uint8_t> evt4_file(const EventBatch& stream) {
  std::vector<uint32_t> words;
  int64_t high = -1;
  const auto put_time = [&](int64_t t_us) {
    if (t_us >> 6 == high) return;
    high = t_us >> 6;
    words.push_back(0xE0000000U | static_cast<uint32_t>(high));
  };
  size_t next = 0;
  const auto put_triggers_until = [&](int64_t t_us) {
    for (; next < stream.triggers.size() && stream.triggers[next].t <= t_us; ++next) {
      const Trigger& trigger = stream.triggers[next];
      put_time(trigger.t);
      words.push_back(0x90000000U | static_cast<uint32_t>(trigger.t & 63) << 22 |
                      static_cast<uint32_t>(trigger.id) << 8 | trigger.p);
    }
  };
  for (size_t i = 0; i < stream.events.size(); ++i) {
    put_triggers_until(stream.events.t[i]);
    put_time(stream.events.t[i]);
    words.push_back(evt4_event(0xAU | stream.events.p[i], static_cast<uint32_t>(stream.events.t[i] & 63),
                               stream.events.x[i], stream.events.y[i]));
  }
  put_triggers_until(INT64_MAX);
  return evt4_of_words(words);
}

}  // namespace e2lf::recordings
