// SPDX-License-Identifier: MIT
// Describes recordings for `e2lf info`; declared in describe.h.
#include <algorithm>

#include "e2lf/base/printable.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/output/print.h"
#include "e2lf/cli/verbs/describe.h"
#include "e2lf/recordings/open/open_named_recording.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

Json assumptions_json(const recordings::RecordingInfo& info) {
  Json texts = Json::array();
  for (const recordings::Assumption& assumption : info.assumptions) texts.push_back(assumption_text(assumption));
  return texts;
}

Json to_json(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
             const RecordingStatistics& statistics, Json parts) {
  Json json = {{"kind", "recording"}, {"format", info.format}, {"width", info.width}, {"height", info.height}};
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

std::string size_text(const recordings::RecordingInfo& info, const RecordingStatistics& statistics) {
  if (info.width != 0) return cat(info.width, "x", info.height, " px");
  if (statistics.width() == 0) return "of unknown size";
  return cat("of unknown size; its events reach ", statistics.width(), "x", statistics.height(), " px");
}

std::string time_text(const recordings::DecodeSummary& summary) {
  const double duration_s = static_cast<double>(summary.last_t_us - summary.first_t_us) * 1e-6;
  const double rate = duration_s > 0 ? static_cast<double>(summary.events()) * 1e-6 / duration_s : 0.0;
  return cat(summary.first_t_us, " .. ", summary.last_t_us,
             formatted(" us (%.6f s), %.3f M events/s", duration_s, rate));
}

std::string to_text(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
                    const RecordingStatistics& statistics) {
  const std::vector<recordings::Loss> losses = recordings::losses(summary);
  std::string text = cat("recording: ", info.format, ", sensor ", size_text(info, statistics), "\n",             //
                         "events:    ", summary.events(), " (", summary.events_on, " ON, ", summary.events_off,  //
                         " OFF)\n",                                                                              //
                         "triggers:  ", summary.triggers, "\n", statistics.triggers_text(),                      //
                         "time:      ", time_text(summary), "\n");
  if (const std::string restarts = recordings::restart_text(summary); !restarts.empty()) {
    text += cat("restarts:  ", restarts, "\n");
  }
  if (const std::string sensor = recordings::sensor_text(summary); !sensor.empty()) {
    text += cat("sensor:    ", sensor, "\n");
  }
  if (summary.out_of_order > 0) text += cat("sorted:    ", summary.out_of_order, " events were out of order\n");
  text += cat("left out:  ", losses.empty() ? "nothing" : recordings::loss_text(losses), "\n");
  if (summary.num_gaps > 0) text += cat("gaps:      ", summary.num_gaps, " time intervals are incomplete\n");
  if (info.table) {
    text +=
        cat("read as:   ", info.table->columns, "; times in ", info.table->time_unit, "; ", info.table->polarity, "\n");
  }
  for (const recordings::Assumption& assumption : info.assumptions) {
    text += cat("assumed:   ", assumption_text(assumption), "\n");
  }
  for (const auto& [key, value] : info.header) text += cat("header:    ", key, " = ", value, "\n");
  return text;
}

/// Describes one part of a recording whose clock starts again.
std::string part_text(size_t number, const recordings::DecodeSummary& part) {
  return cat("part ", number, ":    ", part.events(), " events, ", part.triggers, " triggers, ", time_text(part), "\n");
}

}  // namespace

Json summary_json(const recordings::DecodeSummary& summary) {
  return {{"events", summary.events()},
          {"events_on", summary.events_on},
          {"events_off", summary.events_off},
          {"triggers", summary.triggers},
          {"first_t_us", summary.first_t_us},
          {"last_t_us", summary.last_t_us},
          {"dropped_words", summary.dropped_words},
          {"time_loops", summary.time_loops},
          {"gaps", summary.num_gaps},
          {"sorted", summary.out_of_order},
          {"restarts", restarts_json(summary)},
          {"sensor_events_in", summary.sensor_events_in},
          {"sensor_events_sent", summary.sensor_events_sent},
          {"left_out", losses_json(summary)}};
}

Result<Description> describe_recording(const fs::path& path, const DescribeOptions& options) {
  E2LF_ASSIGN_OR_RETURN(recordings::OpenOptions open, open_options(path, options.recording, true));
  open.counts_reports = true;
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_named_recording(path.string(), open));
  RecordingStatistics statistics;
  recordings::DecodeSummary summary;
  recordings::EventBatch batch;
  std::string parts;
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
    parts += part_text(parts_json.size() + 1, part);
    parts_json.push_back({{"events", part.events()},
                          {"triggers", part.triggers},
                          {"first_t_us", part.first_t_us},
                          {"last_t_us", part.last_t_us}});
    E2LF_ASSIGN_OR_RETURN(more_parts, reader->next_part());
  }
  if (parts_json.size() == 1) parts.clear();
  return Description{printable(to_text(reader->info(), summary, statistics) + parts),
                     to_json(reader->info(), summary, statistics, std::move(parts_json)),
                     {},
                     summary.live.failure};
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
