// SPDX-License-Identifier: MIT
#include "e2lf/info/recording_report.h"

#include <algorithm>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::info {
namespace fs = std::filesystem;

namespace {

std::string dropped_text(const cycles::CycleReport& report) {
  std::string text;
  for (size_t i = 0; i < cycles::kNumCycleFaults; ++i) {
    if (report.dropped[i] == 0) continue;
    text += cat(", ", report.dropped[i], " dropped (", cycles::kCycleFaults[i].word, ")");
  }
  return text;
}

}  // namespace

std::string report_text(const cycles::CycleReport& report) {
  std::string text = cat(counted(report.complete, "complete cycle"), dropped_text(report));
  if (report.hot_pixels > 0) text += cat(", ", report.hot_pixels, " hot pixels replaced");
  return text;
}

Error no_cycle_error(const fs::path& input, const diagnose::RigCheck& rig, const cycles::CycleReader& reader) {
  const diagnose::Finding finding = rig.no_cycle_finding(reader);
  return fail(ErrorCode::kInvalidValue, input, diagnose::text_of(finding), " (", rig.triggers_text(reader.schedule()),
              dropped_text(reader.report()),
              "). `e2lf accumulate ... --report cycles.svg` shows the event rate and the triggers");
}

Json cycle_json(const cycles::Cycle& cycle) {
  return {{"number", cycle.number},
          {"begin_us", cycle.begin_us},
          {"end_us", cycle.slices.empty() ? cycle.begin_us : cycle.slices.back().end_us},
          {"events", cycle.events},
          {"confidence", cycle.confidence}};
}

void LiveLog::add(uint64_t cycle, uint64_t events, double latency_s) {
  ++cycles_;
  events_ += events;
  sum_s_ += latency_s;
  most_s_ = std::max(most_s_, latency_s);
  log_info(cat("cycle ", cycle, ": ", events, " events, latency ", formatted("%.1f ms", 1e3 * latency_s)));
}

void LiveLog::finish(const cycles::CycleReport& report) const {
  if (cycles_ == 0) return;
  log_info(cat(
      "live input ended: ", report_text(report), "; ", events_, " events; latency ",
      formatted("%.1f ms on average, %.1f ms at most", 1e3 * sum_s_ / static_cast<double>(cycles_), 1e3 * most_s_)));
}

void log_assumptions(const recordings::RecordingReader& reader) {
  for (const recordings::Assumption& assumption : reader.info().assumptions) {
    log_info(cat(reader.name(), ": ", assumption_text(assumption)));
  }
}

std::string assumption_text(const recordings::Assumption& assumption) {
  return assumption.text + option_hint(assumption.option);
}

Json reading_json(const recordings::RecordingInfo& info) {
  if (!info.table) return nullptr;
  return {{"columns", info.table->columns}, {"time_unit", info.table->time_unit}, {"polarity", info.table->polarity}};
}

Json header_json(const recordings::RecordingInfo& info) {
  Json header = Json::object();
  for (const auto& [key, value] : info.header) header[key] = value;
  return header;
}

Json reading_notes(const fs::path& input, const recordings::RecordingInfo& info) {
  Json notes = {{"read_as", reading_json(info)}};
  if (recordings::is_live_recording(input.string())) notes["header"] = header_json(info);
  return notes;
}

Json sensor_json(const recordings::DecodeSummary& summary) {
  if (recordings::sensor_text(summary).empty()) return nullptr;
  return {{"events_in", summary.sensor_events_in}, {"events_sent", summary.sensor_events_sent}};
}

Json losses_json(const recordings::DecodeSummary& summary) {
  Json json = Json::array();
  for (const recordings::Loss& loss : recordings::losses(summary)) {
    json.push_back({{"reason", loss.reason}, {"count", loss.count}, {"first_byte", loss.first_byte}});
  }
  return json;
}

Json live_json(const recordings::DecodeSummary& summary) {
  const recordings::LiveBacklog& live = summary.live;
  if (live == recordings::LiveBacklog()) return nullptr;
  Json gaps = Json::array();
  for (const recordings::LiveGap& gap : live.gaps) {
    gaps.push_back({{"byte", gap.byte}, {"dropped_bytes", gap.dropped_bytes}, {"lost_buffers", gap.lost_buffers}});
  }
  return {{"most_behind_s", static_cast<double>(live.most_behind_us) * 1e-6},
          {"pauses", live.pauses},
          {"may_have_lost_events", live.loses_events},
          {"dropped_bytes", live.dropped_bytes},
          {"lost_buffers", live.lost_buffers},
          {"num_gaps", live.num_gaps},
          {"gaps", gaps},
          {"failure", live.failure}};
}

void warn_of_losses(const fs::path& input, const recordings::DecodeSummary& summary) {
  if (const std::string live = recordings::live_text(summary); !live.empty()) {
    (summary.live.num_gaps > 0 ? log_warning : log_info)(cat(input.string(), ": ", live));
  }
  if (const std::string restarts = recordings::restart_text(summary); !restarts.empty()) {
    const bool is_moved = summary.restarts.front().shift_us != 0;
    log_warning(
        cat(input.string(), ": ", restarts, is_moved ? " (split keeps the parts separate, refuse fails there)" : ""));
  }
  const std::vector<recordings::Loss> losses = recordings::losses(summary);
  if (losses.empty()) return;
  const bool is_outside = summary.of(recordings::Violation::kOutOfRange).count > 0;
  const char* const advice =
      is_outside ? "; if the sensor is larger than the size that the file states or that was given, correct the size"
                 : "";
  log_warning(cat(input.string(), ": left out ", recordings::loss_text(losses), advice));
}

Json restarts_json(const recordings::DecodeSummary& summary) {
  Json json = Json::array();
  for (const recordings::Restart& restart : summary.restarts) {
    json.push_back({{"byte", restart.byte},
                    {"before_us", restart.before_us},
                    {"after_us", restart.after_us},
                    {"shift_us", restart.shift_us}});
  }
  return json;
}

std::string sorted_text(const recordings::DecodeSummary& summary) {
  return summary.out_of_order == 0 ? "" : cat(", ", summary.out_of_order, " of them sorted to their place");
}

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

}  // namespace e2lf::info
