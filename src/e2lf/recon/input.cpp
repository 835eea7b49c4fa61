// SPDX-License-Identifier: MIT
#include "e2lf/recon/input.h"

#include <algorithm>

#include "e2lf/base/contract.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/intensity_table.h"

namespace e2lf::recon {
namespace {

/// What the counts of one row have added up to so far.
struct RowState {
  std::vector<int> total, last_change;  ///< last_change: sign of the last nonzero count, 0 before the first
};

void add_counts(std::span<const int16_t> counts, RowState& state) {
  for (size_t x = 0; x < counts.size(); ++x) {
    state.total[x] += counts[x];
    if (counts[x] != 0) state.last_change[x] = counts[x] > 0 ? 1 : -1;
  }
}

void fill_row(const model::InputGroup& group, std::span<const int16_t> counts, const RowState& state,
              const IntensityTable& table, size_t cycles, float* row) {
  const float scale = group.scale, mean_scale = scale / static_cast<float>(cycles);
  switch (group.kind) {
    case model::InputKind::kCounts:
      for (size_t x = 0; x < counts.size(); ++x) row[x] = mean_scale * static_cast<float>(counts[x]);
      break;
    case model::InputKind::kCumulative:
      for (size_t x = 0; x < counts.size(); ++x) row[x] = mean_scale * static_cast<float>(state.total[x]);
      break;
    case model::InputKind::kCamera:
      break;  // the same in every row
    case model::InputKind::kIntensity:
      for (size_t x = 0; x < counts.size(); ++x) {
        const float intensity = cycles == 1
                                    ? table.at_half_steps(2 * state.total[x] + state.last_change[x])
                                    : table.at_steps(static_cast<float>(state.total[x]) / static_cast<float>(cycles) +
                                                     0.5F * static_cast<float>(state.last_change[x]));
        row[x] = scale * std::min(intensity, 1.0F);
      }
      break;
  }
}

size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

/// The first channel of each group, and behind them the number of channels.
std::vector<size_t> group_begins(std::span<const model::InputGroup> groups, size_t transitions, size_t num_traits) {
  std::vector<size_t> begins = {0};
  for (const model::InputGroup& group : groups) {
    begins.push_back(begins.back() + (group.kind == model::InputKind::kCamera ? num_traits : transitions));
  }
  return begins;
}

void fill_traits(std::span<const float> traits, float scale, size_t first_channel, InputPlanes& planes) {
  float* plane = planes.values.data() + first_channel * planes.height * planes.width;
  for (const float trait : traits) plane = std::fill_n(plane, planes.height * planes.width, scale * trait);
}

}  // namespace

Result<InputPlanes> network_input(const capture::EventImages& images, std::span<const model::InputGroup> groups,
                                  const InputConditions& conditions, size_t size_multiple) {
  E2LF_REQUIRE(conditions.cycles >= 1, "counts are of one cycle at least");
  E2LF_REQUIRE(size_multiple >= 1, "a size multiple is at least 1");
  E2LF_REQUIRE(images.image_size() > 0, "event images must not be empty");
  if (std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.kind == model::InputKind::kIntensity; })) {
    E2LF_RETURN_IF_ERROR(IntensityTable::check(conditions.constants));
  }
  const IntensityTable table(conditions.constants);
  const std::vector<size_t> first_channels = group_begins(groups, images.transitions, conditions.traits.size());
  InputPlanes planes{
      first_channels.back(), round_up(images.height, size_multiple), round_up(images.width, size_multiple), {}};
  planes.values.resize(planes.channels * planes.height * planes.width);
  parallel_for(planes.height, 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      RowState state{std::vector<int>(images.width), std::vector<int>(images.width)};
      for (size_t k = 0; k < images.transitions; ++k) {
        const auto counts = images.image(k).subspan(std::min(y, images.height - 1) * images.width, images.width);
        add_counts(counts, state);
        for (size_t g = 0; g < groups.size(); ++g) {
          if (groups[g].kind == model::InputKind::kCamera) continue;
          float* row = planes.values.data() + ((first_channels[g] + k) * planes.height + y) * planes.width;
          fill_row(groups[g], counts, state, table, conditions.cycles, row);
          std::fill(row + images.width, row + planes.width, row[images.width - 1]);
        }
      }
    }
  });
  for (size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].kind == model::InputKind::kCamera)
      fill_traits(conditions.traits, groups[g].scale, first_channels[g], planes);
  }
  return planes;
}

}  // namespace e2lf::recon
