// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/live_reader.h"
#include "e2lf/live/pace.h"
#include "e2lf/live/render.h"
#include "e2lf/pipeline/field_sequence.h"
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

/// Passes values from one thread to another without a queue: the slot holds only the newest value. Values are swapped
/// rather than copied, so that their memory is reused.
template <typename T>
class NewestSlot {
 public:
  /// Swaps `value` with the content of the slot. Returns true if the previous content had not been taken.
  bool put(T& value) {
    bool was_full = false;
    {
      const std::lock_guard lock(mutex_);
      std::swap(value, value_);
      was_full = std::exchange(is_full_, true);
    }
    changed_.notify_one();
    return was_full;
  }

  /// Waits for a value and swaps it into `value`. Returns false once the slot is closed and empty.
  [[nodiscard]] bool take(T& value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_full_ || is_closed_; });
    if (!is_full_) return false;
    std::swap(value, value_);
    is_full_ = false;
    return true;
  }

  /// Declares that no further values will follow. A value in the slot can still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  T value_{};
  bool is_full_ = false, is_closed_ = false;
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
  double latency_s =
      0;  ///< time from the arrival of the last event to the completion of the picture; 0 = after the end
};

struct SessionOptions {
  std::optional<PictureSize> size = {};             ///< empty = selected by the pace
  pipeline::Tone tone = {.gain = {}, .black = {}};  ///< by default, determined from the first cycle that has events
  capture::Orientation views = {};                  ///< orientation in which the views are reconstructed
  std::optional<recon::Reconstructor> depth = {};   ///< network of disparities, for the same event images
  std::string fuse_obstacle = {};                   ///< why cycles cannot be fused; empty if they can
  /// Judges the events of the twenty-first cycle, or of the last one of a shorter source, summed over the cycles before
  /// it if there are several, in a thread of its own; empty = not at all. A cycle whose times are not confirmed, which
  /// would explain whatever is found, or that has no events is only judged if it is the last one.
  std::function<diagnose::Findings(const capture::EventImages& events, size_t cycles, bool is_confirmed)> check = {};
  /// Judges a gain that was determined from a light field; empty = not at all.
  std::function<std::optional<diagnose::Finding>(float gain)> judge_gain = {};
  std::function<void(const FieldReport&)> on_field = {};
  std::function<void(const QualityLevel&)> on_level =
      {};  ///< called after the size or the network was changed automatically
};

/// A picture of the newest light field, as requested by the browser.
struct ShownPicture {
  uint64_t serial = 0;  ///< counts pictures from 1
  FieldReport field;
  RenderSettings settings;
  Picture picture;
};

/// Event images in the resolution of a picture.
struct SizedMemory {
  capture::EventImages sums;
  capture::FusedCycles fused;
};

/// The disparities of a cycle, as requested by the browser.
struct ShownDepth {
  FieldReport field;             ///< `serial` counts the maps, and `level.size` is that of the map
  lightfield::Image disparity;   ///< px of the full size per view step
  lightfield::Image confidence;  ///< see depth::DisparityMap
  lightfield::Image picture;     ///< brightness, with its own gain
};

/// Reconstructs light fields from a live source as fast as the hardware permits. One thread reads and accumulates
/// events, one reconstructs, and one renders pictures. A slot between the first two holds only the newest cycle, so
/// that cycles never queue: of the cycles that arrive during a reconstruction, all but the newest are skipped and
/// counted, and those that are late when they are read (LateCycles) do not even get there.
class Session {
 public:
  /// `makers` are of one or more networks for the same patterns, from the best one to the fastest.
  Session(std::unique_ptr<LiveReader> reader, std::vector<FieldMaker> makers, SessionOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the threads.
  void start();
  /// Waits until the source has ended or a stop was requested, and until the last light field is shown. Fails as the
  /// source and the network do.
  [[nodiscard]] Result<void> wait();
  [[nodiscard]] bool has_ended() const { return has_ended_; }

  [[nodiscard]] LiveReader& reader() { return *reader_; }
  /// Returns the model of the fastest network, or of network `number`.
  [[nodiscard]] const model::Model& model() const { return model(makers_.size() - 1); }
  [[nodiscard]] const model::Model& model(size_t number) const { return makers_[number].reconstructor().model(); }
  /// Fixes the size, or, if it is empty, lets the pace determine it.
  void set_size(std::optional<PictureSize> size);
  /// Determines gain and black level again from the next light field.
  void measure_tone();
  /// Returns Statistics::json() and, among others, "size", "average", "has_ended" and the schedule.
  [[nodiscard]] Json json();

  /// Sets the rendering parameters to `settings`, and waits up to `patience` for a picture that was rendered with them
  /// and is newer than `after`. Returns null if there is none by then. Does not delay the reconstruction. If `settings`
  /// has not changed for a second, only the views that it needs are computed.
  [[nodiscard]] std::shared_ptr<const ShownPicture> picture(const RenderSettings& settings, uint64_t after,
                                                            std::chrono::milliseconds patience);

  /// Returns disparity_at() of the newest light field, or nothing if there is none yet. Computes its missing views.
  [[nodiscard]] std::optional<float> disparity_at(float x, float y);

  /// Waits up to `patience` for the disparities of a cycle that are newer than `after`. Returns null if there are none
  /// by then, or no network of disparities. While they are requested and no pictures, each cycle gets disparities in
  /// place of a light field: in the size that is fixed, or else in half size. After the end, those of the last cycle
  /// are computed if they are missing.
  [[nodiscard]] std::shared_ptr<const ShownDepth> depth(uint64_t after, std::chrono::milliseconds patience);
  [[nodiscard]] bool has_depth() const { return depth_maker_.has_value(); }

  /// Computes all views of the newest light field and returns it with the brightness in which it is shown, or nothing
  /// if there is none yet. The values are those that pipeline::FieldSequence computes for this gain and black level.
  [[nodiscard]] std::optional<LiveField> freeze();

  /// Returns the number of cycles that were fused for the newest light field, [y, x] in a quarter of the size, or
  /// nothing if none were.
  [[nodiscard]] std::optional<lightfield::ByteImage> fused_cycles();

 private:
  /// Starts a thread for a step, which is called `step` in the finding if an exception ends it. `at_end` is called in
  /// every case and lets the other threads end.
  template <typename Work, typename AtEnd>
  [[nodiscard]] std::thread start_step(const char* step, Work work, AtEnd at_end);
  void read();
  void end_reading();
  void reconstruct(LiveField field);
  void end_reconstruction();
  [[nodiscard]] LiveField prepare();
  void show();
  [[nodiscard]] Result<void> make(LiveCycle& cycle, LiveField& field);
  [[nodiscard]] Result<FieldReport> make_depth(const LiveCycle& cycle);
  void complete_depth();
  [[nodiscard]] Result<void> make_views(const LiveCycle& cycle, bool exactly, LiveField& field);
  [[nodiscard]] Pace pace_of(std::optional<PictureSize> size) const;
  void choose_views(LiveField& field);
  [[nodiscard]] bool complete();
  void begin_check(const LiveCycle& cycle, bool is_last);
  void join();
  void fail(const Error& error);

  std::unique_ptr<LiveReader> reader_;
  std::recursive_mutex maker_mutex_;
  std::vector<FieldMaker> makers_;
  SizedMemory sized_;  ///< blocks of the cycle that is being reconstructed
  SessionOptions options_;
  NewestSlot<LiveCycle> slot_;
  uint64_t made_ = 0;

  mutable std::mutex settings_mutex_;
  Pace pace_;
  std::optional<PictureSize> named_size_;  ///< empty = the pace determines the size
  pipeline::Tone tone_;
  std::optional<Error> error_;

  // The newest light field. The reconstruction thread swaps it, so that it waits for at most one picture.
  std::mutex field_mutex_;
  std::condition_variable field_changed_;
  LiveField shown_;
  RenderSettings render_settings_;
  Clock::time_point settings_since_{};
  bool is_new_ = false, is_last_ = false, settings_changed_ = false;

  // When the browser last asked for either, as the count of a clock.
  std::atomic<Clock::rep> picture_asked_ = 0, depth_asked_ = 0;
  std::optional<FieldMaker> depth_maker_;
  SizedMemory depth_sized_;
  lightfield::LightField depth_outputs_;
  std::shared_ptr<const ShownDepth> depth_;  ///< under picture_mutex_, like picture_

  std::mutex picture_mutex_;
  std::condition_variable picture_changed_;
  std::shared_ptr<const ShownPicture> picture_;

  std::atomic<bool> has_ended_ = false;
  std::thread reading_, reconstructing_, showing_, checking_;
};

}  // namespace e2lf::live
