// SPDX-License-Identifier: MIT
#include "e2lf/live/networks.h"

#include "e2lf/base/progress.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/event_depth.h"

namespace e2lf::live {
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
