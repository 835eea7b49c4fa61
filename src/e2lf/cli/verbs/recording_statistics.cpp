// SPDX-License-Identifier: MIT
#include "e2lf/cli/verbs/recording_statistics.h"

#include <algorithm>

#include "e2lf/base/text.h"

namespace e2lf::cli {
namespace {

size_t beyond(const recordings::Column<uint16_t>& coordinates, size_t known) {
  if (coordinates.empty()) return known;
  return std::max<size_t>(known, size_t{*std::max_element(coordinates.begin(), coordinates.end())} + 1);
}

}  // namespace

void RecordingStatistics::Edges::add(int64_t t_us) {
  if (count == 0) first_us = t_us;
  last_us = t_us;
  ++count;
}

double RecordingStatistics::Edges::period_us() const {
  return count < 2 ? 0.0 : static_cast<double>(last_us - first_us) / static_cast<double>(count - 1);
}

void RecordingStatistics::add(const recordings::EventBatch& batch) {
  width_ = beyond(batch.events.x, width_);
  height_ = beyond(batch.events.y, height_);
  for (const recordings::Trigger& trigger : batch.triggers) {
    Channel& channel = channels_[trigger.id];
    (trigger.p != 0 ? channel.rising : channel.falling).add(trigger.t);
  }
}

Json RecordingStatistics::triggers_json() const {
  Json json = Json::array();
  for (const auto& [id, channel] : channels_) {
    json.push_back({{"channel", id},
                    {"rising", channel.rising.count},
                    {"falling", channel.falling.count},
                    {"rising_period_us", channel.rising.period_us()},
                    {"falling_period_us", channel.falling.period_us()}});
  }
  return json;
}

std::string RecordingStatistics::triggers_text() const {
  std::string text;
  for (const auto& [id, channel] : channels_) {
    const bool is_rising = channel.rising.count >= channel.falling.count;
    const Edges& edges = is_rising ? channel.rising : channel.falling;
    text += cat("           channel ", id, ": ", channel.rising.count, " rising and ", channel.falling.count,
                " falling edges", edges.count < 2 ? "" : cat(", one every ", edges.period_us(), " us"), "\n");
  }
  return text;
}

}  // namespace e2lf::cli
