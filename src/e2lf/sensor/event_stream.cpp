// SPDX-License-Identifier: MIT
#include "e2lf/sensor/event_stream.h"

#include <cmath>
#include <cstdlib>
#include <vector>

#include "e2lf/base/contract.h"
#include "e2lf/base/rng.h"

namespace e2lf::sensor {
namespace {

/// Calls visit(pixel, offset_us) for every event of one transition, pixel by pixel; the same in every pass.
template <typename Visit>
void for_each_event(std::span<const int> counts, const CounterRng& rng, int64_t settle_us, const Visit& visit) {
  for (size_t pixel = 0; pixel < counts.size(); ++pixel) {
    const int count = std::abs(counts[pixel]);
    if (count == 0) continue;
    const double u = double{rng.uniform(pixel)};
    for (int j = 0; j < count; ++j) {
      const double place = (j + u) / count;
      visit(pixel, static_cast<size_t>(place * place * static_cast<double>(settle_us)));
    }
  }
}

/// Appends one transition's events, sorted by counting how many fall into each microsecond.
void append_transition(std::span<const int> counts, size_t width, const CounterRng& rng, int64_t begin_us,
                       int64_t settle_us, events::EventColumns& out) {
  std::vector<size_t> places(static_cast<size_t>(settle_us) + 1);
  for_each_event(counts, rng, settle_us, [&](size_t, size_t offset) { ++places[offset + 1]; });
  places[0] = out.size();
  for (size_t i = 1; i < places.size(); ++i) places[i] += places[i - 1];
  out.resize(places.back());
  for_each_event(counts, rng, settle_us, [&](size_t pixel, size_t offset) {
    const size_t place = places[offset]++;
    out.x[place] = static_cast<uint16_t>(pixel % width);
    out.y[place] = static_cast<uint16_t>(pixel / width);
    out.p[place] = counts[pixel] > 0 ? 1 : 0;
    out.t[place] = begin_us + static_cast<int64_t>(offset);
  });
}

}  // namespace

events::EventBatch event_stream(std::span<const events::EventImages> cycles, const EventStreamOptions& options) {
  E2LF_REQUIRE(!cycles.empty(), "a recording needs at least one cycle");
  E2LF_REQUIRE(options.settle_us >= 1 && options.settle_us <= options.pattern_us,
               "events must settle while their pattern is shown");
  const events::EventImages& first = cycles[0];
  E2LF_REQUIRE(first.width <= 65536 && first.height <= 65536, "event coordinates have 16 bits");

  events::EventBatch batch;
  uint64_t change = 0;  // number of pattern changes so far, the first appearance included
  const auto show_pattern = [&](std::span<const int> counts) {
    const int64_t t = options.start_us + static_cast<int64_t>(change) * options.pattern_us;
    batch.triggers.push_back({t, 0, 1});
    append_transition(counts, first.width, CounterRng(options.seed, change), t, options.settle_us, batch.events);
    ++change;
  };
  std::vector<int> take_back(first.image_size()), counts(first.image_size());
  for (const events::EventImages& cycle : cycles) {
    E2LF_REQUIRE(cycle.transitions == first.transitions && cycle.height == first.height && cycle.width == first.width,
                 "all cycles of a recording must have one size");
    show_pattern(take_back);
    take_back.assign(first.image_size(), 0);
    for (size_t k = 0; k < cycle.transitions; ++k) {
      counts.assign(cycle.image(k).begin(), cycle.image(k).end());
      for (size_t pixel = 0; pixel < counts.size(); ++pixel) take_back[pixel] -= counts[pixel];
      show_pattern(counts);
    }
  }
  show_pattern(take_back);
  return batch;
}

}  // namespace e2lf::sensor
