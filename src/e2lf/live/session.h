// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "e2lf/base/result.h"
#include "e2lf/live/live_reader.h"
#include "e2lf/live/networks.h"
#include "e2lf/live/slots.h"
#include "e2lf/pipeline/field_sequence.h"

namespace e2lf::live {

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

/// The size and the brightness of the light fields, and the first error. May be used by any thread.
class Tuning {
 public:
  Tuning(const Pace& pace, std::optional<PictureSize> named_size, const pipeline::Tone& tone)
      : pace_(pace), named_size_(named_size), tone_(tone) {}

  [[nodiscard]] QualityLevel level() const;
  /// Returns the size that is fixed, if one is.
  [[nodiscard]] std::optional<PictureSize> named_size() const;
  void set_size(std::optional<PictureSize> named_size, const Pace& pace);
  /// Returns whether gain or black level follow from the next light field.
  [[nodiscard]] bool finds_tone() const;
  void set_tone(const pipeline::Tone& tone);

  /// What a light field has changed.
  struct Change {
    std::optional<QualityLevel> level = {};
    std::optional<float> gain = {};
  };
  /// Adds a light field of all views that was made at its level, and states its gain and black level in it.
  Change add(double cycle_s, bool is_late, bool finds_tone, LiveField& field);

  void fail(const Error& error);
  [[nodiscard]] std::optional<Error> error() const;
  /// Adds "size", "size_choice", "gain", "black" and "error".
  void describe(Json& json) const;

 private:
  mutable std::mutex mutex_;
  Pace pace_;
  std::optional<PictureSize> named_size_;  ///< empty = the pace determines the size
  pipeline::Tone tone_;
  std::optional<Error> error_;
};

/// A picture of the newest light field, as requested by the browser.
struct ShownPicture {
  uint64_t serial = 0;  ///< counts pictures from 1
  FieldReport field;
  RenderSettings settings;
  Picture picture;
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
  [[nodiscard]] const model::Model& model() const { return networks_.model(networks_.size() - 1); }
  [[nodiscard]] const model::Model& model(size_t number) const { return networks_.model(number); }
  /// Fixes the size, or, if it is empty, lets the pace determine it.
  void set_size(std::optional<PictureSize> size) { tuning_.set_size(size, networks_.pace(size)); }
  /// Determines gain and black level again from the next light field.
  void measure_tone() { tuning_.set_tone(options_.tone); }
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
  [[nodiscard]] bool has_depth() const { return depth_.has_value(); }

  /// Computes all views of the newest light field and returns it with the brightness in which it is shown. Fails with
  /// kNotFound if there is none yet, and as the network does. The values are those that pipeline::FieldSequence
  /// computes for this gain and black level.
  [[nodiscard]] Result<LiveField> freeze();

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
  void choose_views(LiveField& field);
  [[nodiscard]] bool complete();
  void begin_check(const LiveCycle& cycle, bool is_last);
  void join();

  std::unique_ptr<LiveReader> reader_;
  SessionOptions options_;
  Networks networks_;
  std::optional<DepthNetwork> depth_;
  Tuning tuning_;
  NewestSlot<LiveCycle> slot_;
  uint64_t made_ = 0;

  // The newest light field. The reconstruction thread swaps it, so that it waits for at most one picture.
  std::mutex field_mutex_;
  std::condition_variable field_changed_;
  LiveField shown_;
  RenderSettings render_settings_;
  Clock::time_point settings_since_{};
  bool is_new_ = false, is_last_ = false, settings_changed_ = false;
  Published<ShownPicture> pictures_;

  // When the browser last asked for either, as the count of a clock.
  std::atomic<Clock::rep> picture_asked_ = 0, depth_asked_ = 0;
  std::atomic<bool> has_ended_ = false;
  std::thread reading_, reconstructing_, showing_, checking_;
};

}  // namespace e2lf::live
