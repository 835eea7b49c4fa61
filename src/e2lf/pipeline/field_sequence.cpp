// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_sequence.h"

#include <algorithm>
#include <chrono>

#include "e2lf/base/text.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/recon/scene_motion.h"

namespace e2lf::pipeline {

recon::Method colour_method(recon::Method grey, const capture::ColourFilter& filter) {
  return [grey = std::move(grey), filter](const capture::Measurement& measurement,
                                          const ProgressFn& progress) -> Result<lightfield::LightField> {
    if (measurement.kind != capture::MeasurementKind::kEventImages) {
      return Error{ErrorCode::kInvalidValue,
                   "colours can only be reconstructed from event images; leave the filter out", ""};
    }
    const capture::EventImages& images = measurement.events;
    if (images.height % 2 != 0 || images.width % 2 != 0) {
      return Error{ErrorCode::kShape,
                   cat("event images of ", images.width, "x", images.height,
                       " px do not divide into blocks of 2x2 colour filters; leave the filter out or crop the events"),
                   ""};
    }
    lightfield::LightField colour;
    for (size_t place = 0; place < 4; ++place) {
      const size_t channel = filter.channels[place];
      E2LF_ASSIGN_OR_RETURN(
          const lightfield::LightField one,
          grey(capture::Measurement(capture::behind_filter(images, place)), progress_of_pass(progress, place, 4)));
      if (place == 0) {
        lightfield::Shape shape = one.shape();
        shape.channels = 3;
        colour = lightfield::LightField(shape);
      }
      const auto share = static_cast<float>(std::count(filter.channels.begin(), filter.channels.end(), channel));
      for (size_t i = 0; i < one.data().size(); ++i) colour.data()[3 * i + channel] += one.data()[i] / share;
    }
    return colour;
  };
}

Result<Field> FieldSequence::next(const capture::Measurement& measurement, const ProgressFn& progress,
                                  const FieldObserver& observer) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  Field field;
  std::optional<capture::Measurement> lit;
  if (lit_) {
    field.motion = recon::scene_motion(measurement.events);
    if (*field.motion > recon::kMuchMotion) lit = recon::lit_transitions(measurement.events);
  }
  field.is_of_lit = lit.has_value();
  const capture::Measurement& used = lit ? *lit : measurement;
  E2LF_ASSIGN_OR_RETURN(field.light_field, (lit ? *lit_ : method_)(used, progress));
  field.reconstruct_s = std::chrono::duration<double>(Clock::now() - begin).count();
  if (observer) E2LF_RETURN_IF_ERROR(observer(field.light_field, used, field.is_of_lit));
  // Without events, the brightness of the scene is unknown; a later cycle determines it.
  const bool has_scene = !capture::has_events(used.kind) || !capture::is_without_events(used.events);
  if (!tone_.black && has_scene) tone_.black = recon::auto_black(field.light_field);
  field.black = tone_.black.value_or(0.0F);
  if (!tone_.gain && has_scene) tone_.gain = recon::auto_gain(field.light_field, field.black);
  field.gain = tone_.gain.value_or(1.0F);
  recon::apply_tone(field.light_field, field.black, field.gain);
  return field;
}

}  // namespace e2lf::pipeline
