// SPDX-License-Identifier: MIT
#include "e2lf/live/networks.h"

#include "e2lf/base/progress.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/event_depth.h"

namespace e2lf::live {
namespace {

/// Sums `kSide` neighbouring columns each. The side is known to the compiler, which can then vectorise the loop.
template <size_t kSide, typename Convert>
void sum_columns(const std::vector<int>& columns, size_t width, const Convert& convert, int16_t* to) {
  for (size_t x = 0; x < width; ++x) {
    int sum = 0;
    for (size_t i = 0; i < kSide; ++i) sum += columns[x * kSide + i];
    to[x] = convert(sum);
  }
}

/// Computes images of a lower resolution from the sums over blocks.
template <typename Convert>
void sum_blocks_of(const capture::EventImages& images, size_t side, capture::EventImages& sums,
                   const Convert& convert) {
  const size_t height = images.height / side, width = images.width / side;
  E2LF_REQUIRE(side == 2 || side == 4, "a picture has half or a quarter of the size");
  E2LF_REQUIRE(height > 0 && width > 0, "the sums of blocks need a block");
  if (sums.count != images.count || sums.height != height || sums.width != width) {
    sums = capture::EventImages(images.count, height, width);
  }
  std::vector<int> column(images.width);
  int16_t* to = sums.values.data();
  for (size_t row = 0; row < images.count * height; ++row) {
    const int16_t* from = images.image(row / height).data() + row % height * side * images.width;
    std::fill(column.begin(), column.end(), 0);
    for (size_t y = 0; y < side; ++y, from += images.width) {
      for (size_t x = 0; x < images.width; ++x) column[x] += from[x];
    }
    side == 2 ? sum_columns<2>(column, width, convert, to) : sum_columns<4>(column, width, convert, to);
    to += width;
  }
}

}  // namespace

void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums) {
  sum_blocks_of(images, side, sums, capture::saturated);
}

void fuse_blocks(const capture::FusedCycles& fused, size_t side, capture::FusedCycles& blocks) {
  sum_blocks_of(fused.counts, side, blocks.counts, [side](int sum) {
    const auto pixels = static_cast<int>(side * side);
    return static_cast<int16_t>((sum + (sum < 0 ? -pixels : pixels) / 2) / pixels);
  });
  // The variance of a mean over pixels is that of one divided by the square of their number, summed.
  const size_t height = blocks.counts.height, width = blocks.counts.width;
  blocks.cycles.resize(1, height, width);
  const auto pixels = static_cast<float>(side * side);
  for (size_t y = 0; y < height; ++y) {
    float* const to = blocks.cycles.values.data() + y * width;
    std::fill_n(to, width, 0.0F);
    for (size_t row = y * side; row < (y + 1) * side; ++row) {
      const float* const from = fused.cycles.values.data() + row * fused.cycles.width;
      for (size_t x = 0; x < width * side; ++x) to[x / side] += 1 / from[x];
    }
    for (size_t x = 0; x < width; ++x) to[x] = pixels * pixels / to[x];
  }
}

namespace {

/// The event images in the resolution of a picture, and how many values of the camera each count sums unless they are
/// fused.
struct SizedImages {
  const capture::EventImages& events;
  capture::MeasurementView measured;
  size_t samples;
};

/// `memory` is that of images that are smaller than those of the cycle.
SizedImages images_of(const LiveCycle& cycle, PictureSize size, bool takes_fused, SizedMemory& memory) {
  const size_t side = block_side(size);
  const bool is_fused = takes_fused && !cycle.fused.is_empty();
  if (side > 1) sum_blocks(cycle.images, side, memory.sums);
  if (side > 1 && is_fused) fuse_blocks(cycle.fused, side, memory.fused);
  const capture::EventImages& events = side > 1 ? memory.sums : cycle.images;
  const capture::MeasurementView measured =
      is_fused ? capture::MeasurementView(events, side > 1 ? memory.fused : cycle.fused) : events;
  return {events, measured, cycle.cycles * side * side};
}

}  // namespace

FieldReport report_of(const LiveCycle& cycle, const QualityLevel& level, double reconstruct_s) {
  return {0,
          cycle.number,
          cycle.begin_us,
          cycle.cycles,
          cycle.fused_cycles,
          cycle.events,
          cycle.confidence,
          level,
          reconstruct_s,
          seconds_since(cycle.last_event)};
}

Result<void> Networks::make(const LiveCycle& cycle, bool exactly, LiveField& field) {
  const std::lock_guard lock(mutex_);
  return make_alone(cycle, exactly, field);
}

Result<void> Networks::make_alone(const LiveCycle& cycle, bool exactly, LiveField& field) {
  FieldMaker& maker = makers_[field.level.network];
  const auto [events, measured, samples] = images_of(cycle, field.level.size, maker.takes_fused(), sized_);
  E2LF_RETURN_IF_ERROR(maker.make(measured, samples, field.views, field.light_field, exactly));
  if (!views_.is_upright()) lightfield::orient(field.light_field, views_);
  return {};
}

Result<bool> Networks::complete_if_free(LiveField& field) {
  const std::unique_lock free(mutex_, std::try_to_lock);
  if (!free.owns_lock()) return false;
  E2LF_RETURN_IF_ERROR(field.complete([this](LiveField& each) { return make_alone(each.cycle, false, each); }));
  return true;
}

Pace Networks::pace(std::optional<PictureSize> named) const {
  std::vector<double> macs;
  for (const FieldMaker& maker : makers_) macs.push_back(model::macs_per_pixel(maker.reconstructor().model().network));
  return Pace(macs, named);
}

Result<FieldReport> DepthNetwork::make(const LiveCycle& cycle, PictureSize size, bool has_ended) {
  const std::lock_guard lock(mutex_);
  const auto before = maps_.newest();
  if (before && before->field.cycle >= cycle.number) return before->field;
  const Clock::time_point begin = Clock::now();
  auto next = std::make_shared<ShownDepth>();
  const auto [events, measured, samples] = images_of(cycle, size, maker_.takes_fused(), sized_);
  E2LF_RETURN_IF_ERROR(maker_.make(measured, samples, {}, outputs_));
  E2LF_ASSIGN_OR_RETURN(pipeline::EventDepth found,
                        pipeline::depth_of_outputs(maker_.reconstructor().model(), outputs_, events, samples, views_));
  for (float& value : found.map.disparity.pixels) value *= static_cast<float>(block_side(size));
  next->disparity = std::move(found.map.disparity);
  next->confidence = std::move(found.map.confidence);
  next->picture = std::move(found.picture);
  const LightFieldOutput bright(next->picture.pixels.data(), {1, 1, next->picture.height, next->picture.width, 1});
  recon::apply_tone(bright, 0, recon::auto_gain(bright));
  next->field = report_of(cycle, {.size = size}, seconds_since(begin));
  if (has_ended) next->field.latency_s = 0;
  next->field.serial = before ? before->field.serial + 1 : 1;
  const FieldReport report = next->field;
  maps_.put(std::move(next));
  return report;
}

}  // namespace e2lf::live
