// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/hot_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <span>

#include "e2lf/base/median.h"
#include "e2lf/base/threads.h"

namespace e2lf::capture {
namespace {

constexpr size_t kMostNeighbours = 24;
constexpr size_t kOutliers = 2;  // neighbours on either side that may be hot, too

/// Returns the least excess of a hot pixel, summed over all transitions.
int32_t least_excess(size_t cycles, size_t transitions, double in_single_cycle) {
  constexpr double kPerCycle = 2.0 / 3;
  const auto count = static_cast<double>(cycles);
  const double least = std::max(in_single_cycle * std::sqrt(count), kPerCycle * count);
  return static_cast<int32_t>(std::ceil(least * static_cast<double>(transitions)));
}

/// Counts, for each pixel of a row, the transitions in which it may exceed its neighbours, because at most kOutliers of
/// the eight nearest ones are not less. This leaves few pixels for excess(), which takes longer.
std::vector<uint8_t> possible_transitions(const Planes<int32_t>& counts, size_t y) {
  const size_t width = counts.width;
  std::vector<uint8_t> possible(width, static_cast<uint8_t>(std::min<size_t>(counts.count, UINT8_MAX)));
  if (y == 0 || y + 1 == counts.height || width < 3 || counts.count > UINT8_MAX) return possible;
  std::fill(possible.begin() + 1, possible.end() - 1, uint8_t{0});
  std::vector<uint8_t> not_less(width);
  for (size_t n = 0; n < counts.count; ++n) {
    const int32_t* const row = counts.image(n).data() + y * width;
    std::ranges::fill(not_less, uint8_t{0});
    for (const std::ptrdiff_t dy : {-1, 0, 1}) {
      for (const std::ptrdiff_t dx : {-1, 0, 1}) {
        if (dy == 0 && dx == 0) continue;
        const int32_t* const others = row + dy * static_cast<std::ptrdiff_t>(width) + dx;
        for (size_t x = 1; x + 1 < width; ++x) {
          const int32_t sign = row[x] >> 31;  // 0 or -1
          not_less[x] = static_cast<uint8_t>(not_less[x] + ((others[x] ^ sign) >= (row[x] ^ sign) ? 1 : 0));
        }
      }
    }
    for (size_t x = 1; x + 1 < width; ++x) possible[x] = static_cast<uint8_t>(possible[x] + (not_less[x] <= kOutliers));
  }
  return possible;
}

/// Returns by how many events a pixel exceeds its neighbours in the direction of its own sign.
int32_t excess(std::span<const int32_t> counts, size_t height, size_t width, size_t pixel, float beyond_range) {
  const int32_t sign = counts[pixel] < 0 ? -1 : 1, own = sign * counts[pixel];
  std::array<int32_t, kMostNeighbours> around{};
  size_t count = 0, not_less = 0;
  each_neighbour(height, width, pixel, [&](size_t neighbour) {
    around[count] = sign * counts[neighbour];
    not_less += around[count++] >= own ? 1 : 0;
    return not_less <= kOutliers;  // most pixels are done after a few neighbours
  });
  if (not_less > kOutliers || count <= 2 * kOutliers) return 0;
  std::sort(around.begin(), around.begin() + static_cast<ptrdiff_t>(count));
  const int32_t least = around[kOutliers], most = around[count - 1 - kOutliers];
  return std::max(0, own - most - static_cast<int32_t>(beyond_range * static_cast<float>(most - least)));
}

}  // namespace

void CountSums::add(const EventImages& cycle) {
  if (cycles++ == 0) counts = Planes<int32_t>(cycle.count, cycle.height, cycle.width);
  E2LF_REQUIRE(cycle.values.size() == counts.values.size(), "cycles of different sizes");
  for (size_t i = 0; i < cycle.values.size(); ++i) counts.values[i] += cycle.values[i];
}

void CountSums::fade() {
  for (int32_t& count : counts.values) count /= 2;
  cycles /= 2;
}

std::vector<size_t> hot_pixels(const CountSums& sums, const HotLimits& limits) {
  if (sums.cycles == 0) return {};
  const size_t height = sums.counts.height, width = sums.counts.width;
  const int32_t least = least_excess(sums.cycles, sums.counts.count, limits.in_single_cycle);
  std::vector<size_t> hot;
  std::mutex mutex;
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    std::vector<size_t> found;
    std::vector<uint8_t> possible;
    for (size_t pixel = begin * width; pixel < end * width; ++pixel) {
      if (pixel % width == 0) possible = possible_transitions(sums.counts, pixel / width);
      if (size_t{2} * possible[pixel % width] <= sums.counts.count) continue;
      int32_t sum = 0;
      for (size_t n = 0; n < sums.counts.count; ++n) sum += std::abs(sums.counts.image(n)[pixel]);
      if (sum < least) continue;
      sum = 0;
      size_t exceeded = 0;  // transitions
      for (size_t n = 0; n < sums.counts.count; ++n) {
        const int32_t more = excess(sums.counts.image(n), height, width, pixel, limits.beyond_range);
        sum += more;
        exceeded += more > 0 ? 1 : 0;
      }
      if (sum >= least && 2 * exceeded > sums.counts.count) found.push_back(pixel);
    }
    const std::lock_guard lock(mutex);
    hot.insert(hot.end(), found.begin(), found.end());
  });
  std::ranges::sort(hot);
  return hot;
}

size_t count_silent_pixels(const CountSums& sums) {
  constexpr int32_t kLeastAround = 20;
  const size_t height = sums.counts.height, width = sums.counts.width;
  std::vector<int32_t> events(height * width);
  for (size_t i = 0; i < sums.counts.values.size(); ++i) events[i % events.size()] += std::abs(sums.counts.values[i]);
  size_t silent = 0;
  for (size_t pixel = 0; pixel < events.size(); ++pixel) {
    if (events[pixel] != 0) continue;
    std::vector<int32_t> around;
    each_neighbour(height, width, pixel, [&](size_t neighbour) { around.push_back(events[neighbour]); });
    silent += !around.empty() && median(std::move(around)) >= kLeastAround;
  }
  return silent;
}

void replace_by_neighbours(const std::vector<size_t>& pixels, EventImages& images) {
  for (const size_t pixel : pixels) {
    for (size_t n = 0; n < images.count; ++n) {
      std::vector<int16_t> around;
      each_neighbour(images.height, images.width, pixel, [&](size_t neighbour) {
        if (!std::ranges::binary_search(pixels, neighbour)) around.push_back(images.image(n)[neighbour]);
      });
      images.image(n)[pixel] = median(std::move(around));
    }
  }
}

}  // namespace e2lf::capture
