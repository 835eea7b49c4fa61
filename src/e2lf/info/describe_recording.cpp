// SPDX-License-Identifier: MIT
// Describes recordings for `e2lf info`; declared in describe.h.
#include <algorithm>

#include "e2lf/info/describe.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::info {
namespace fs = std::filesystem;
namespace {

Json assumptions_json(const recordings::RecordingInfo& info) {
  Json texts = Json::array();
  for (const recordings::Assumption& assumption : info.assumptions) texts.push_back(assumption_text(assumption));
  return texts;
}

Json to_json(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
             const RecordingStatistics& statistics, Json parts) {
  const double duration_s = static_cast<double>(summary.last_t_us - summary.first_t_us) * 1e-6;
  Json json = {{"kind", "recording"},
               {"format", info.format},
               {"width", info.width},
               {"height", info.height},
               {"duration_s", duration_s},
               {"events_per_s", duration_s > 0 ? static_cast<double>(summary.events()) / duration_s : 0.0}};
  Json counts = summary_json(summary);
  const Json left_out = std::move(counts["left_out"]);
  counts.erase("left_out");
  json.update(counts);
  json["trigger_channels"] = statistics.triggers_json();
  json["extents"] = {{"width", statistics.width()}, {"height", statistics.height()}};
  json["assumptions"] = assumptions_json(info);
  json["read_as"] = reading_json(info);
  json["left_out"] = left_out;
  json["parts"] = std::move(parts);
  json["header"] = header_json(info);
  return json;
}

}  // namespace

Result<Description> describe_recording(const fs::path& path, const DescribeOptions& options) {
  recordings::OpenOptions open = options.recording;
  open.counts_reports = true;
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_named_recording(path.string(), open));
  RecordingStatistics statistics;
  recordings::DecodeSummary summary;
  recordings::EventBatch batch;
  Json parts_json = Json::array();
  for (bool more_parts = true; more_parts;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (more) {
      statistics.add(batch);
      if (options.on_batch) options.on_batch(batch);
      if (options.progress) options.progress(summary.events() + reader->summary().events(), 0);
      continue;
    }
    const recordings::DecodeSummary part = reader->summary();
    summary.append(part);
    parts_json.push_back({{"events", part.events()},
                          {"triggers", part.triggers},
                          {"first_t_us", part.first_t_us},
                          {"last_t_us", part.last_t_us}});
    E2LF_ASSIGN_OR_RETURN(more_parts, reader->next_part());
  }
  Description description{to_json(reader->info(), summary, statistics, std::move(parts_json))};
  description.failure = summary.live.failure;
  return description;
}

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

}  // namespace e2lf::info
