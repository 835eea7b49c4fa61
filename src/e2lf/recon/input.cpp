// SPDX-License-Identifier: MIT
#include "e2lf/recon/input.h"

#include "e2lf/base/threads.h"
#include "e2lf/engine/kernel.h"

namespace e2lf::recon {
namespace {

/// The cumulative counts of one row.
struct RowState {
  std::vector<int> total, last_change;  ///< last_change: sign of the last non-zero count, 0 before the first
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
  const auto level = [&](size_t x) {
    return static_cast<float>(state.total[x]) / static_cast<float>(cycles) +
           0.5F * static_cast<float>(state.last_change[x]);
  };
  switch (group.kind) {
    case model::InputKind::kCounts:
      for (size_t x = 0; x < counts.size(); ++x) row[x] = mean_scale * static_cast<float>(counts[x]);
      break;
    case model::InputKind::kCumulative:
      for (size_t x = 0; x < counts.size(); ++x) row[x] = mean_scale * static_cast<float>(state.total[x]);
      break;
    case model::InputKind::kLevel:
      for (size_t x = 0; x < counts.size(); ++x) row[x] = scale * level(x);
      break;
    case model::InputKind::kIntensity:
      for (size_t x = 0; x < counts.size(); ++x) {
        const float intensity =
            cycles == 1 ? table.at_half_steps(2 * state.total[x] + state.last_change[x]) : table.at(double{level(x)});
        row[x] = scale * std::min(intensity, 1.0F);
      }
      break;
    default:
      break;  // not made from counts
  }
}

/// Returns the pixel of a row of `size` pixels that stands at `index` of the row continued by its mirror image.
size_t mirrored(size_t index, size_t size) {
  const size_t wrapped = index % (2 * size);
  return std::min(wrapped, 2 * size - 1 - wrapped);
}

/// Returns the same if the row is first extended by the mirror image of its first `shift` pixels.
size_t mirrored(size_t index, size_t size, size_t shift) {
  const size_t place = mirrored(index, size + shift);
  return place < shift ? mirrored(shift - 1 - place, size) : place - shift;
}

/// Returns the first channel of each group, followed by the number of channels.
std::vector<size_t> group_begins(std::span<const model::InputGroup> groups, size_t transitions,
                                 size_t conditioning_size, size_t num_images) {
  std::vector<size_t> begins = {0};
  for (const model::InputGroup& group : groups) {
    size_t channels = num_images;
    if (is_of_counts(group)) channels = transitions;
    if (group.kind == model::InputKind::kCamera) channels = conditioning_size;
    if (group.kind == model::InputKind::kLensArray) channels = capture::kLensPixels * capture::kLensPixels;
    begins.push_back(begins.back() + channels);
  }
  return begins;
}

/// Fills the planes of all groups that are made from event counts, which are sums over `cycles`.
void fill_counts(const PlanesView<const int16_t>& images, size_t cycles, std::span<const model::InputGroup> groups,
                 std::span<const size_t> first_channels, const InputConditions& conditions, InputPlanes& planes) {
  const IntensityTable table(conditions.constants);
  const size_t transitions = images.extents[0], height = images.extents[1], width = images.extents[2];
  const GridShift& shift = conditions.shift;
  parallel_for(planes.height, 8, [&](size_t begin, size_t end) {
    std::vector<int16_t> scratch;
    for (size_t y = begin; y < end; ++y) {
      RowState state{std::vector<int>(width), std::vector<int>(width)};
      for (size_t k = 0; k < transitions; ++k) {
        const auto counts = images[k][mirrored(y, height, shift.y)].values(scratch);
        add_counts(counts, state);
        for (size_t g = 0; g < groups.size(); ++g) {
          if (!is_of_counts(groups[g])) continue;
          float* row = planes.values.data() + ((first_channels[g] + k) * planes.height + y) * planes.width;
          fill_row(groups[g], counts, state, table, cycles, row + shift.x);
          for (size_t x = 0; x < shift.x; ++x) row[x] = row[shift.x + mirrored(x, width, shift.x)];
          for (size_t x = shift.x + width; x < planes.width; ++x) row[x] = row[mirrored(x, shift.x + width)];
        }
      }
    }
  });
}

/// Fills the planes of intensity images, which are extended in the same way as counts.
void fill_images(const PlanesView<const float>& images, float scale, const GridShift& shift, size_t first_channel,
                 InputPlanes& planes) {
  const auto [count, height, width] = images.extents;
  std::vector<size_t> columns(planes.width);
  for (size_t x = 0; x < planes.width; ++x) columns[x] = mirrored(x, width, shift.x);
  for (size_t n = 0; n < count; ++n) {
    for (size_t y = 0; y < planes.height; ++y) {
      const auto from = images[n][mirrored(y, height, shift.y)];
      float* row = planes.values.data() + ((first_channel + n) * planes.height + y) * planes.width;
      for (size_t x = 0; x < planes.width; ++x) row[x] = scale * from[columns[x]];
    }
  }
}

/// Fills the plane of the number of cycles, which differs between pixels.
void fill_cycles(const PlanesView<const float>& cycles, float scale, const GridShift& shift, size_t channel,
                 InputPlanes& planes) {
  fill_images(cycles, scale, shift, channel, planes);
  const size_t size = planes.height * planes.width;
  for (float& value : std::span(planes.values).subspan(channel * size, size)) {
    value = scale * capture::cycles_condition(value / scale);
  }
}

/// The position of a pixel between the centres of lenses.
struct LensPlace {
  size_t before, after;  ///< number of the lens
  float share;           ///< weight of the latter
};

LensPlace lens_place(size_t pixel, size_t lenses) {
  const float place = (static_cast<float>(pixel) + 0.5F) / static_cast<float>(capture::kLensPixels) - 0.5F;
  const float clamped = std::clamp(place, 0.0F, static_cast<float>(lenses - 1));
  const auto before = static_cast<size_t>(clamped);
  return {before, std::min(before + 1, lenses - 1), clamped - static_cast<float>(before)};
}

void fill_lens_array(const PlanesView<const float>& image, float scale, size_t first_channel, InputPlanes& planes) {
  constexpr size_t kSide = capture::kLensPixels;
  const size_t rows = image.extents[1] / kSide, columns = image.extents[2] / kSide;
  parallel_for(kSide * kSide, 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const auto at = [&](size_t row, size_t column) {
        return image[0][row * kSide + view / kSide][column * kSide + view % kSide];
      };
      for (size_t y = 0; y < planes.height; ++y) {
        const LensPlace v = lens_place(y, rows);
        float* to = planes.values.data() + ((first_channel + view) * planes.height + y) * planes.width;
        for (size_t x = 0; x < planes.width; ++x) {
          const LensPlace u = lens_place(x, columns);
          const float above = std::lerp(at(v.before, u.before), at(v.before, u.after), u.share);
          const float below = std::lerp(at(v.after, u.before), at(v.after, u.after), u.share);
          to[x] = scale * std::lerp(above, below, v.share);
        }
      }
    }
  });
}

}  // namespace

Result<void> network_input(const capture::MeasurementView& measurement, std::span<const model::InputGroup> groups,
                           const InputConditions& conditions, size_t size_multiple, InputPlanes& planes) {
  E2LF_REQUIRE(conditions.cycles >= 1, "counts are of one cycle at least");
  E2LF_REQUIRE(size_multiple >= 1, "a size multiple is at least 1");
  E2LF_REQUIRE(measurement.height() > 0 && measurement.width() > 0, "images must not be empty");
  E2LF_REQUIRE(measurement.kind != capture::MeasurementKind::kLensArray || conditions.shift == GridShift(),
               "lenses cannot be shifted");
  if (std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.kind == model::InputKind::kIntensity; })) {
    E2LF_RETURN_IF_ERROR(IntensityTable::check(conditions.constants));
  }
  const std::vector<size_t> first_channels = group_begins(
      groups, measurement.events.extents[0], conditions.conditioning.size(), measurement.images.extents[0]);
  using engine::round_up;
  planes.resize(first_channels.back(), round_up(measurement.height() + conditions.shift.y, size_multiple),
                round_up(measurement.width() + conditions.shift.x, size_multiple));
  if (std::any_of(groups.begin(), groups.end(), model::is_of_counts)) {
    const bool is_fused = measurement.is_fused();
    fill_counts(is_fused ? measurement.fused : measurement.events, is_fused ? capture::kFusedUnits : conditions.cycles,
                groups, first_channels, conditions, planes);
  }
  for (size_t g = 0; g < groups.size(); ++g) {
    const float scale = groups[g].scale;
    const bool is_image = groups[g].kind == model::InputKind::kImages || groups[g].kind == model::InputKind::kImageSum;
    if (groups[g].kind == model::InputKind::kCamera) {
      const size_t size = planes.height * planes.width;
      float* plane = planes.values.data() + first_channels[g] * size;
      for (const float trait : conditions.conditioning) plane = std::fill_n(plane, size, scale * trait);
      const size_t of_cycles = first_channels[g] + conditions.cycles_condition;
      if (measurement.is_fused() && of_cycles < first_channels[g + 1]) {
        fill_cycles(measurement.cycles, scale, conditions.shift, of_cycles, planes);
      }
    }
    if (is_image) fill_images(measurement.images, scale, conditions.shift, first_channels[g], planes);
    if (groups[g].kind == model::InputKind::kLensArray) {
      fill_lens_array(measurement.images, scale, first_channels[g], planes);
    }
  }
  return {};
}

}  // namespace e2lf::recon
