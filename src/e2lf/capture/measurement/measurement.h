// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/base/strided_view.h"

namespace e2lf::capture {

/// The events of a time window, distributed over a few points in time: float32 [bin, y, x], row-major. It is the input
/// of networks that reconstruct frames (Zhu et al., CVPR 2019; Rebecq et al., TPAMI 2021). cycles/event_windows.h
/// computes it.
using VoxelGrid = Planes<float>;

/// The intensities that the sensor receives under each pattern (Eq. 1), divided by the number of views: float32
/// [pattern, y, x], row-major.
using CodedIntensities = Planes<float>;

/// The event images of one cycle: int16 [transition, y, x], row-major. Each value is the sum of the signed events (+1
/// ON, -1 OFF) of a pixel during one transition between patterns (Eq. 2). N patterns have N - 1 transitions.
using EventImages = Planes<int16_t>;

/// Returns the count, limited to the range of int16.
[[nodiscard]] inline int16_t saturated(int count) {
  return static_cast<int16_t>(std::clamp<int>(count, INT16_MIN, INT16_MAX));
}

/// Returns whether no pixel has an event.
[[nodiscard]] inline bool is_without_events(const PlanesView<const int16_t>& images) {
  std::vector<int16_t> scratch;
  return std::ranges::all_of(images.values(scratch), [](int16_t count) { return count == 0; });
}

/// The data that a camera records of one light field. Intensity images have the units of coded intensities: 1 is white
/// through an open aperture.
enum class MeasurementKind {
  kEventImages,  ///< the N - 1 event images of an event camera
  kCodedImages,  ///< one intensity image for each of the N patterns (Eq. 1)
  kHybrid,       ///< event images, and one intensity image that is the sum over all patterns
  kLensArray,  ///< one intensity image behind a lens array: lens (i, j) covers the 8x8 pixels from (8 i, 8 j), and the
               ///< pixel (view_y, view_x) below it is the mean of that view over the area of the lens
};

/// The names of the measurements in files and options.
inline constexpr Choice<MeasurementKind> kMeasurementKinds[] = {{"event-images", MeasurementKind::kEventImages},
                                                                {"coded-images", MeasurementKind::kCodedImages},
                                                                {"hybrid", MeasurementKind::kHybrid},
                                                                {"lens-array", MeasurementKind::kLensArray}};

[[nodiscard]] constexpr const char* measurement_name(MeasurementKind kind) {
  return word_of(kind, kMeasurementKinds);
}

[[nodiscard]] constexpr bool has_events(MeasurementKind kind) {
  return kind == MeasurementKind::kEventImages || kind == MeasurementKind::kHybrid;
}
/// Returns the number of intensity images for N patterns, or 0 for a kind without any.
[[nodiscard]] constexpr size_t num_images(MeasurementKind kind, size_t num_patterns) {
  return kind == MeasurementKind::kEventImages ? 0 : kind == MeasurementKind::kCodedImages ? num_patterns : 1;
}

/// The unit of fused counts: 1/64 of an event.
inline constexpr size_t kFusedUnits = 64;

/// Event images of a cycle that were fused with those of the cycles before (recon::CycleFusion).
struct FusedCycles {
  EventImages counts;    ///< means over cycles in kFusedUnits, [transition, y, x]
  Planes<float> cycles;  ///< effective number of cycles of each pixel, [1, y, x]; at least 1

  [[nodiscard]] bool is_empty() const { return counts.values.empty(); }
};

/// The measurement of one light field.
struct Measurement {
  Measurement() = default;
  /// Event images convert implicitly, since they are the usual measurement.
  Measurement(EventImages events_) : events(std::move(events_)) {}  // NOLINT(google-explicit-constructor)

  MeasurementKind kind = MeasurementKind::kEventImages;
  EventImages events;       ///< empty if the kind has none
  CodedIntensities images;  ///< num_images() of them
  FusedCycles fused;        ///< what a network receives in place of `events`; empty if cycles are not fused

  [[nodiscard]] size_t height() const { return has_events(kind) ? events.height : images.height; }
  [[nodiscard]] size_t width() const { return has_events(kind) ? events.width : images.width; }
};

/// A measurement in memory that somebody else owns.
struct MeasurementView {
  // What owns the memory converts implicitly, as to other views.
  MeasurementView(const Measurement& owner)  // NOLINT(google-explicit-constructor)
      : kind(owner.kind),
        events(owner.events),
        images(owner.images),
        fused(owner.fused.counts),
        cycles(owner.fused.cycles) {}
  MeasurementView(const EventImages& owner) : events(owner) {}                    // NOLINT(google-explicit-constructor)
  MeasurementView(const PlanesView<const int16_t>& events_) : events(events_) {}  // NOLINT(google-explicit-constructor)
  MeasurementView(const EventImages& events_, const FusedCycles& fused_)
      : events(events_), fused(fused_.counts), cycles(fused_.cycles) {}

  MeasurementKind kind = MeasurementKind::kEventImages;
  PlanesView<const int16_t> events;
  PlanesView<const float> images;
  PlanesView<const int16_t> fused;  ///< FusedCycles::counts, of the same size as `events`, or empty
  PlanesView<const float> cycles;   ///< FusedCycles::cycles

  [[nodiscard]] bool is_fused() const { return fused.size() > 0; }
  [[nodiscard]] size_t height() const { return (has_events(kind) ? events.extents : images.extents)[1]; }
  [[nodiscard]] size_t width() const { return (has_events(kind) ? events.extents : images.extents)[2]; }
};

/// The number of pixels that a lens covers along each axis: one for each view.
inline constexpr size_t kLensPixels = 8;

}  // namespace e2lf::capture
