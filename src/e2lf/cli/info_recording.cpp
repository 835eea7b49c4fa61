// SPDX-License-Identifier: MIT
#include "e2lf/cli/info_recording.h"

#include <algorithm>
#include <cstdio>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/output.h"
#include "e2lf/cli/rate_plot.h"
#include "e2lf/events/tcp_source.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr size_t kPlotBins = 2000;

Json to_json(const events::RecordingInfo& info, const events::DecodeSummary& summary) {
  Json json = {{"kind", "recording"},
               {"format", info.format},
               {"width", info.width},
               {"height", info.height},
               {"events", summary.events()},
               {"events_on", summary.events_on},
               {"events_off", summary.events_off},
               {"triggers", summary.triggers},
               {"first_t_us", summary.first_t_us},
               {"last_t_us", summary.last_t_us},
               {"events_before_time", summary.events_before_time},
               {"dropped_words", summary.dropped_words},
               {"time_loops", summary.time_loops},
               {"gaps", summary.num_gaps}};
  Json violations = Json::object();
  for (size_t i = 0; i < events::kNumViolations; ++i) {
    const events::ViolationCount& violation = summary.violations[i];
    if (violation.count > 0) {
      violations[events::violation_name(static_cast<events::Violation>(i))] = {{"count", violation.count},
                                                                               {"first_byte", violation.first_byte}};
    }
  }
  json["violations"] = std::move(violations);
  Json header = Json::object();
  for (const auto& [key, value] : info.header) header[key] = value;
  json["header"] = std::move(header);
  return json;
}

void print_text(const events::RecordingInfo& info, const events::DecodeSummary& summary) {
  const double duration_s = static_cast<double>(summary.last_t_us - summary.first_t_us) * 1e-6;
  std::printf("recording: %s, sensor %zux%zu px\n", info.format.c_str(), info.width, info.height);
  std::printf("events:    %llu (%llu ON, %llu OFF)\n", static_cast<unsigned long long>(summary.events()),
              static_cast<unsigned long long>(summary.events_on), static_cast<unsigned long long>(summary.events_off));
  std::printf("triggers:  %llu\n", static_cast<unsigned long long>(summary.triggers));
  std::printf("time:      %lld .. %lld us (%.6f s), %.3f M events/s\n", static_cast<long long>(summary.first_t_us),
              static_cast<long long>(summary.last_t_us), duration_s,
              duration_s > 0 ? static_cast<double>(summary.events()) * 1e-6 / duration_s : 0.0);
  if (summary.num_violations() == 0) {
    std::printf("damage:    none\n");
  }
  for (size_t i = 0; i < events::kNumViolations; ++i) {
    const events::ViolationCount& violation = summary.violations[i];
    if (violation.count == 0) continue;
    std::printf("damage:    %s: %llu, first at byte %llu\n", events::violation_name(static_cast<events::Violation>(i)),
                static_cast<unsigned long long>(violation.count),
                static_cast<unsigned long long>(violation.first_byte));
  }
  if (summary.num_gaps > 0) {
    std::printf("gaps:      %llu stretches of time are incomplete\n",
                static_cast<unsigned long long>(summary.num_gaps));
  }
  for (const auto& [key, value] : info.header) std::printf("header:    %s = %s\n", key.c_str(), value.c_str());
}

}  // namespace

Result<void> print_recording_info(const fs::path& path, const RecordingInfoOptions& options,
                                  const CommonOptions& common) {
  std::optional<OutputFile> picture;
  if (!options.plot.empty()) {
    E2LF_ASSIGN_OR_RETURN(
        picture, OutputFile::create(options.plot, {.inputs = {path}, .overwrite = common.overwrite, .streams = true}));
  }
  events::OpenOptions open;
  open.format = options.format;
  open.policy = events::DecodePolicy::kSkip;  // the summary tells what was damaged
  open.from_us = options.from_us;
  open.to_us = options.to_us;
  open.threads = 0;
  E2LF_ASSIGN_OR_RETURN(const auto reader, events::open_named_recording(path.string(), open));
  events::EventRateCounter rate(kPlotBins);
  events::EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) break;
    if (!options.plot.empty()) rate.add(batch);
  }
  if (common.json) {
    std::printf("%s\n", to_json(reader->info(), reader->summary()).dump(2).c_str());
  } else {
    print_text(reader->info(), reader->summary());
  }
  if (!picture) return {};
  E2LF_RETURN_IF_ERROR(write_file(picture->path(), rate_plot_svg(rate.rate())));
  return picture->commit();
}

}  // namespace e2lf::cli
