// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "e2lf/files/options.h"
#include "e2lf/live/pace.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// Computes quantiles of the last kKept values.
class RecentQuantiles {
 public:
  static constexpr size_t kKept = 4096;
  void add(double value);
  /// Returns the smallest value that at least the fraction q (0 to 1) of the values does not exceed, or 0 if there are
  /// no values.
  [[nodiscard]] double at(double q) const;

 private:
  std::vector<double> values_;
  size_t next_ = 0;
};

/// Why a cycle was not reconstructed.
enum class Skipped {
  kNewer,  ///< a newer one had arrived, or the reconstruction failed
  kLate,   ///< it was dropped as soon as it was read: LateCycles
};

/// Collects figures about the input and the reconstruction. All functions may be called from any thread.
class Statistics {
 public:
  explicit Statistics(Clock::time_point begin = Clock::now()) : begin_(begin), window_begin_(begin) {}

  /// Adds a batch that was read at `now`.
  void add_batch(const recordings::EventBatch& batch, Clock::time_point now = Clock::now());
  /// Adds a complete cycle; `confidence` states how well its events confirm its times.
  void add_cycle(float confidence);
  /// Adds a cycle that was not reconstructed.
  void add_skipped(Skipped why = Skipped::kNewer);
  /// Adds a light field, or a map, of this size whose picture is complete.
  void add_field(double latency_s, double reconstruct_s, PictureSize size);
  /// Replaces the reader's summary of the data that was left out, and RigCheck::json().
  void set_report(const recordings::DecodeSummary& summary, Json rig);
  /// Adds findings, in JSON, to those of the report.
  void add_findings(const Json& findings);

  /// Returns all figures: totals, latencies, the rates of the last second, and the report of the reader.
  [[nodiscard]] Json json(Clock::time_point now = Clock::now()) const;

 private:
  struct Rates {
    double events_hz = 0, on_share = 0;
    std::map<uint16_t, double> triggers_hz;
  };
  [[nodiscard]] Rates rates_of_window(Clock::time_point now) const;

  static constexpr std::chrono::seconds kWindow{1};
  static constexpr size_t kMostChannels = 64;  ///< limit on trigger channels, because damaged data may contain many

  mutable std::mutex mutex_;
  Clock::time_point begin_, window_begin_;
  uint64_t events_ = 0, cycles_ = 0, skipped_ = 0, late_ = 0, fields_ = 0;
  std::map<PictureSize, uint64_t> fields_of_size_;
  uint64_t window_events_ = 0, window_on_ = 0;
  std::map<uint16_t, uint64_t> window_triggers_, triggers_;
  std::optional<Rates> rates_;
  std::optional<int64_t> first_us_;
  int64_t last_us_ = 0;
  float confidence_ = 1, least_confidence_ = 1;
  RecentQuantiles latency_s_, reconstruct_s_;
  Json report_ = Json::object();
};

}  // namespace e2lf::live
