// SPDX-License-Identifier: MIT
#include "e2lf/live/statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/recordings/event.h"

namespace e2lf::live {
namespace {

double seconds_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

Json by_channel(const auto& values) {
  Json json = Json::object();
  for (const auto& [channel, value] : values) json[std::to_string(channel)] = value;
  return json;
}

}  // namespace

void RecentQuantiles::add(double value) {
  if (values_.size() < kKept) {
    values_.push_back(value);
  } else {
    values_[std::exchange(next_, (next_ + 1) % kKept)] = value;
  }
}

double RecentQuantiles::at(double q) const {
  if (values_.empty()) return 0;
  std::vector<double> sorted = values_;
  const auto rank = static_cast<size_t>(std::ceil(q * static_cast<double>(sorted.size())));
  const size_t place = std::clamp<size_t>(rank, 1, sorted.size()) - 1;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<ptrdiff_t>(place), sorted.end());
  return sorted[place];
}

void Statistics::add_batch(const recordings::EventBatch& batch, Clock::time_point now) {
  const uint64_t on = recordings::count_on(batch.events.p);
  const std::lock_guard lock(mutex_);
  if (now - window_begin_ >= kWindow) {
    rates_ = rates_of_window(now);
    window_begin_ = now;
    window_events_ = window_on_ = 0;
    window_triggers_.clear();
  }
  events_ += batch.events.size();
  window_events_ += batch.events.size();
  window_on_ += on;
  for (const recordings::Trigger& trigger : batch.triggers) {
    if (trigger.p == 0) continue;  // a pulse has two edges, of which one is counted
    if (triggers_.size() == kMostChannels && !triggers_.contains(trigger.id)) continue;
    ++triggers_[trigger.id];
    ++window_triggers_[trigger.id];
  }
  if (batch.events.empty()) return;
  if (!first_us_) first_us_ = batch.events.t.front();
  last_us_ = std::max(last_us_, batch.events.t.back());
}

void Statistics::add_cycle(float confidence) {
  const std::lock_guard lock(mutex_);
  ++cycles_;
  confidence_ = confidence;
  least_confidence_ = std::min(least_confidence_, confidence);
}

void Statistics::add_skipped(Skipped why) {
  const std::lock_guard lock(mutex_);
  ++skipped_;
  if (why == Skipped::kLate) ++late_;
}

void Statistics::add_field(double latency_s, double reconstruct_s, PictureSize size) {
  const std::lock_guard lock(mutex_);
  ++fields_;
  ++fields_of_size_[size];
  latency_s_.add(latency_s);
  reconstruct_s_.add(reconstruct_s);
}

void Statistics::set_report(const recordings::DecodeSummary& summary, Json rig) {
  Json left_out = Json::object();
  for (const recordings::Loss& loss : recordings::losses(summary)) left_out[loss.reason] = loss.count;
  Json json = {{"dropped_cycles", rig["dropped"]}, {"silenced_pixels", rig["silenced_pixels"]},
               {"found", rig["triggers"]},         {"event_delay_us", rig["event_delay_us"]},
               {"findings", rig["findings"]},      {"left_out", std::move(left_out)},
               {"pauses", summary.live.pauses},    {"may_have_lost_events", summary.live.loses_events}};
  if (summary.sensor_events_in > 0) {
    json["sensor_dropped_share"] =
        1 - static_cast<double>(summary.sensor_events_sent) / static_cast<double>(summary.sensor_events_in);
  }
  const std::lock_guard lock(mutex_);
  report_ = std::move(json);
}

void Statistics::add_findings(const Json& findings) {
  const std::lock_guard lock(mutex_);
  for (const Json& finding : findings) report_["findings"].push_back(finding);
}

Statistics::Rates Statistics::rates_of_window(Clock::time_point now) const {
  const double s = std::max(1e-3, seconds_between(window_begin_, now));
  Rates rates;
  rates.events_hz = static_cast<double>(window_events_) / s;
  rates.on_share = window_events_ == 0 ? 0 : static_cast<double>(window_on_) / static_cast<double>(window_events_);
  for (const auto& [channel, all] : triggers_) {
    const auto found = window_triggers_.find(channel);
    rates.triggers_hz[channel] = found == window_triggers_.end() ? 0 : static_cast<double>(found->second) / s;
  }
  return rates;
}

Json Statistics::json(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  // If nothing arrives, no batch ends the window.
  const bool is_old = !rates_ || now - window_begin_ >= 2 * kWindow;
  const Rates rates = is_old ? rates_of_window(now) : *rates_;
  Json sizes = Json::object();
  for (const auto& [size, count] : fields_of_size_) sizes[size_name(size)] = count;
  Json json = {{"seconds", seconds_between(begin_, now)},
               {"recorded_s", 1e-6 * static_cast<double>(last_us_ - first_us_.value_or(0))},
               {"events", events_},
               {"cycles", cycles_},
               {"fields", fields_},
               {"fields_of_size", std::move(sizes)},
               {"skipped_cycles", skipped_},
               {"late_cycles", late_},
               {"latency_s", {{"median", latency_s_.at(0.5)}, {"p90", latency_s_.at(0.9)}}},
               {"reconstruct_s", {{"median", reconstruct_s_.at(0.5)}, {"p90", reconstruct_s_.at(0.9)}}},
               {"events_per_s", rates.events_hz},
               {"on_share", rates.on_share},
               {"triggers", by_channel(triggers_)},
               {"triggers_per_s", by_channel(rates.triggers_hz)},
               {"confidence", confidence_},
               {"least_confidence", least_confidence_}};
  json.update(report_);
  return json;
}

}  // namespace e2lf::live
