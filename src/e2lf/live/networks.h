// SPDX-License-Identifier: MIT
#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/pace.h"
#include "e2lf/live/render.h"
#include "e2lf/live/slots.h"
#include "e2lf/recon/reconstruct.h"

namespace e2lf::live {

/// Reconstructs a sequence of light fields with one network. Each count of a measurement is a sum over `samples`
/// values, cycles of a static scene times pixels of a block, or was fused. Networks that are not conditioned on the
/// sensor profile receive the mean.
class FieldMaker {
 public:
  /// The input of the network must be event images.
  explicit FieldMaker(recon::Reconstructor reconstructor) : reconstructor_(std::move(reconstructor)) {}

  /// Computes the values of one pass of recon::Reconstructor::reconstruct() into `field`: to the bit if `exactly`, and
  /// otherwise except for rounding, see recon::Reconstructor::prepared_for(), in the memory that the first call
  /// allocated. The network may compute only the given views; see reconstruct_into(). Fails as that function does.
  [[nodiscard]] Result<void> make(const capture::MeasurementView& images, size_t samples, std::span<const size_t> views,
                                  lightfield::LightField& field, bool exactly = false) {
    const size_t prepared = images.is_fused() ? kFused : samples;
    if (!exactly && (!fast_ || prepared != prepared_)) {
      E2LF_ASSIGN_OR_RETURN(
          fast_, prepared == kFused ? reconstructor_.prepared_for_fused() : reconstructor_.prepared_for(samples));
      memory_ = {};
      prepared_ = prepared;
    }
    const recon::Reconstructor& network = exactly ? reconstructor_ : *fast_;
    const lightfield::Shape shape = network.field_shape(images);
    if (!(field.shape() == shape)) field = lightfield::LightField::unset(shape);
    recon::ReconstructionMemory memory_once;
    return network.reconstruct_into(images, samples, views, exactly ? memory_once : memory_, field);
  }

  [[nodiscard]] const recon::Reconstructor& reconstructor() const { return reconstructor_; }
  /// Returns whether the network is told the number of cycles, so that these may be fused.
  [[nodiscard]] bool takes_fused() const { return model::is_conditioned_on_camera(reconstructor_.model()); }

 private:
  static constexpr size_t kFused = 0;
  recon::Reconstructor reconstructor_;
  std::optional<recon::Reconstructor> fast_;  ///< the network prepared for prepared_
  size_t prepared_ = 0;                       ///< number of samples, or kFused
  recon::ReconstructionMemory memory_;
};

/// The figures of a light field whose picture is complete.
struct FieldReport {
  uint64_t serial = 0;  ///< counts the light fields from 1
  uint64_t cycle = 0;   ///< number of its cycle in the recording
  int64_t begin_us = 0;
  size_t cycles = 1;        ///< number of cycles that were summed
  double fused_cycles = 0;  ///< mean number of cycles that were fused; 0 = none were
  uint64_t events = 0;
  float confidence = 1;
  QualityLevel level;
  double reconstruct_s = 0;
  /// Time from the arrival of the last event to the completion of the picture; 0 = after the end.
  double latency_s = 0;
};

/// Computes event images of a lower resolution: each count is the sum over a block of side x side pixels (2 or 4),
/// limited to the range of int16. Odd last rows and columns are left out. `sums` is resized if its shape differs,
/// otherwise its memory is used again. A network takes the sums as those of side^2 cycles of one pixel. Images that are
/// smaller than a block break the contract.
void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums);

/// Computes fused cycles of a lower resolution: each count is the mean over a block, and the number of cycles is that
/// of as many independent cycles of one pixel. The arguments are as above.
void fuse_blocks(const capture::FusedCycles& fused, size_t side, capture::FusedCycles& blocks);

/// Event images in the resolution of a picture.
struct SizedMemory {
  capture::EventImages sums;
  capture::FusedCycles fused;
};

/// The networks of light fields, which one thread uses at a time.
class Networks {
 public:
  /// `makers` are from the best network to the fastest; `views` is the orientation in which they reconstruct.
  Networks(std::vector<FieldMaker> makers, const capture::Orientation& views)
      : makers_(std::move(makers)), views_(views) {}

  /// Computes `field.views` (empty = all) of a cycle with the network and in the size of `field.level`, see
  /// FieldMaker::make(), and turns them upright. Waits until the networks are free.
  [[nodiscard]] Result<void> make(const LiveCycle& cycle, bool exactly, LiveField& field);
  /// Computes the missing views of a light field. Returns false if the networks are not free.
  [[nodiscard]] Result<bool> complete_if_free(LiveField& field);

  [[nodiscard]] const model::Model& model(size_t number) const { return makers_[number].reconstructor().model(); }
  [[nodiscard]] size_t size() const { return makers_.size(); }
  /// Returns a pace for these networks.
  [[nodiscard]] Pace pace(std::optional<PictureSize> named) const;

 private:
  [[nodiscard]] Result<void> make_alone(const LiveCycle& cycle, bool exactly, LiveField& field);

  std::mutex mutex_;
  std::vector<FieldMaker> makers_;
  capture::Orientation views_;
  SizedMemory sized_;  ///< blocks of the cycle that is being reconstructed
};

/// The disparities of a cycle, as requested by the browser.
struct ShownDepth {
  FieldReport field;             ///< `serial` counts the maps, and `level.size` is that of the map
  lightfield::Image disparity;   ///< px of the full size per view step
  lightfield::Image confidence;  ///< see depth::DisparityMap
  lightfield::Image picture;     ///< brightness, with its own gain
};

/// The network of disparities, and the newest map. Its functions may be called from any thread.
class DepthNetwork {
 public:
  DepthNetwork(recon::Reconstructor network, const capture::Orientation& views)
      : maker_(std::move(network)), views_(views) {}

  /// Makes the map of a cycle in this size, unless there is one of it or of a later cycle. Returns its figures; the
  /// latency is 0 if the source `has_ended`. Fails as the network does.
  [[nodiscard]] Result<FieldReport> make(const LiveCycle& cycle, PictureSize size, bool has_ended);
  [[nodiscard]] Published<ShownDepth>& maps() { return maps_; }

 private:
  std::mutex mutex_;
  FieldMaker maker_;
  capture::Orientation views_;
  SizedMemory sized_;
  lightfield::LightField outputs_;
  Published<ShownDepth> maps_;
};

/// Returns the figures of a light field or map that is complete now.
[[nodiscard]] FieldReport report_of(const LiveCycle& cycle, const QualityLevel& level, double reconstruct_s);

}  // namespace e2lf::live
