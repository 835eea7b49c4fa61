// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/live/field_maker.h"
#include "e2lf/live/live_reader.h"
#include "e2lf/live/look.h"
#include "e2lf/live/newest_slot.h"
#include "e2lf/live/pace.h"

namespace e2lf::live {

/// A light field whose picture is finished.
struct FieldReport {
  uint64_t serial = 0;  ///< counts the light fields from 1
  uint64_t cycle = 0;   ///< the number of its cycle in the recording
  int64_t begin_us = 0;
  size_t cycles = 1;  ///< that were summed
  uint64_t events = 0;
  float confidence = 1;
  Gait gait;
  double reconstruct_s = 0;
  double latency_s = 0;  ///< from the arrival of the last event of the cycle until the picture was finished
};

struct SessionOptions {
  std::optional<PictureSize> size = {};        ///< nothing = as the pace demands
  std::optional<float> gain = {}, black = {};  ///< nothing = found at the first light field of a cycle with events
  capture::Orientation views = {};             ///< how the views come out
  std::function<void(const FieldReport&)> on_field = {};
  std::function<void(const Gait&)> on_gait = {};  ///< the size or the network has changed by itself
};

/// A picture of the newest light field, as the browser asked for it.
struct ShownPicture {
  uint64_t serial = 0;  ///< counts pictures from 1
  FieldReport field;
  Look look;
  Picture picture;
};

/// Reconstructs light fields at the pace of the hardware. One thread reads and accumulates, one reconstructs and one
/// makes pictures. Between the first two lies a slot that holds the newest cycle alone, so that nothing ever queues:
/// cycles that come while a light field is being made are skipped, except for the newest one, and counted.
class Session {
 public:
  /// `makers` are of one or more networks for the same patterns, from the best one to the fastest.
  Session(std::unique_ptr<LiveReader> reader, std::vector<FieldMaker> makers, SessionOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the threads.
  void start();
  /// Waits until the source has ended, after a request to stop too, and the last light field is shown. Fails as the
  /// source and the network do.
  [[nodiscard]] Result<void> wait();
  [[nodiscard]] bool has_ended() const;

  [[nodiscard]] LiveReader& reader() { return *reader_; }
  /// Returns the model of the fastest network, or of network `number`.
  [[nodiscard]] const model::Model& model() const { return model(makers_.size() - 1); }
  [[nodiscard]] const model::Model& model(size_t number) const { return makers_[number].reconstructor().model(); }
  /// Keeps a size, or chooses it by the pace.
  void set_size(std::optional<PictureSize> size);
  /// Finds gain and black level again at the next light field.
  void measure_tone();
  /// All figures: see Statistics::json(), with "size", "average", "has_ended" and the schedule.
  [[nodiscard]] Json json();

  /// Looks at the light fields as `look` says, and waits up to `patience` for a picture that is newer than `after` and
  /// looks so. Nothing if none is finished until then. Whoever asks does not delay the reconstruction. A look that has
  /// not changed for a second is given the views that it needs alone.
  [[nodiscard]] std::shared_ptr<const ShownPicture> picture(const Look& look, uint64_t after,
                                                            std::chrono::milliseconds patience);

  /// Makes all views of the newest light field, with its brightness as it is shown, or returns nothing if there is none
  /// yet. The values are those of pipeline::FieldSequence for this gain and black level.
  [[nodiscard]] std::optional<LiveField> freeze();

 private:
  void read();
  void reconstruct();
  void show();
  [[nodiscard]] Result<void> make(LiveCycle& cycle, LiveField& field);
  [[nodiscard]] Result<void> make_views(const LiveCycle& cycle, bool exactly, LiveField& field);
  [[nodiscard]] Pace pace_of(std::optional<PictureSize> size) const;
  void choose_views(LiveField& field);
  [[nodiscard]] bool complete();
  void find_tone(LiveField& field);
  void join();
  void fail(const Error& error);

  std::unique_ptr<LiveReader> reader_;
  std::mutex maker_mutex_;
  std::vector<FieldMaker> makers_;
  capture::Measurement sums_;  ///< of blocks of the cycle that is being made
  SessionOptions options_;
  NewestSlot<LiveCycle> slot_;
  uint64_t made_ = 0;

  mutable std::mutex settings_mutex_;
  Pace pace_;
  std::optional<float> gain_, black_;
  std::optional<Error> error_;

  // The newest light field. The thread that reconstructs exchanges it, so it waits for at most one picture.
  std::mutex field_mutex_;
  std::condition_variable field_changed_;
  LiveField shown_;
  Look look_;
  Clock::time_point look_since_{};
  bool is_new_ = false, is_last_ = false, look_changed_ = false;

  std::mutex picture_mutex_;
  std::condition_variable picture_changed_;
  std::shared_ptr<const ShownPicture> picture_;

  std::atomic<bool> has_ended_ = false;
  std::thread reading_, reconstructing_, showing_;
};

}  // namespace e2lf::live
