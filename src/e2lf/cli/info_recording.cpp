// SPDX-License-Identifier: MIT
#include "e2lf/cli/info_recording.h"

#include <algorithm>
#include <cstdio>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/output.h"
#include "e2lf/cli/rate_plot.h"
#include "e2lf/cli/recording_statistics.h"
#include "e2lf/files/json_text.h"
#include "e2lf/recordings/open/open_named_recording.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr size_t kPlotBins = 2000;

Json assumptions_json(const recordings::RecordingInfo& info) {
  Json texts = Json::array();
  for (const recordings::Assumption& assumption : info.assumptions) texts.push_back(assumption_text(assumption));
  return texts;
}

Json to_json(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
             const RecordingStatistics& statistics) {
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
               {"dropped_words", summary.dropped_words},
               {"time_loops", summary.time_loops},
               {"gaps", summary.num_gaps},
               {"sorted", summary.out_of_order},
               {"trigger_channels", statistics.triggers_json()},
               {"extents", {{"width", statistics.width()}, {"height", statistics.height()}}},
               {"assumptions", assumptions_json(info)},
               {"left_out", losses_json(summary)}};
  Json header = Json::object();
  for (const auto& [key, value] : info.header) header[key] = value;
  json["header"] = std::move(header);
  return json;
}

std::string size_text(const recordings::RecordingInfo& info, const RecordingStatistics& statistics) {
  if (info.width != 0) return cat(info.width, "x", info.height, " px");
  if (statistics.width() == 0) return "of unknown size";
  return cat("of unknown size; its events reach ", statistics.width(), "x", statistics.height(), " px");
}

void print_text(const recordings::RecordingInfo& info, const recordings::DecodeSummary& summary,
                const RecordingStatistics& statistics) {
  const double duration_s = static_cast<double>(summary.last_t_us - summary.first_t_us) * 1e-6;
  std::printf("recording: %s, sensor %s\n", info.format.c_str(), size_text(info, statistics).c_str());
  std::printf("events:    %llu (%llu ON, %llu OFF)\n", static_cast<unsigned long long>(summary.events()),
              static_cast<unsigned long long>(summary.events_on), static_cast<unsigned long long>(summary.events_off));
  std::printf("triggers:  %llu\n%s", static_cast<unsigned long long>(summary.triggers),
              statistics.triggers_text().c_str());
  std::printf("time:      %lld .. %lld us (%.6f s), %.3f M events/s\n", static_cast<long long>(summary.first_t_us),
              static_cast<long long>(summary.last_t_us), duration_s,
              duration_s > 0 ? static_cast<double>(summary.events()) * 1e-6 / duration_s : 0.0);
  if (summary.out_of_order > 0) {
    std::printf("sorted:    %llu events were out of order\n", static_cast<unsigned long long>(summary.out_of_order));
  }
  const std::vector<recordings::Loss> losses = recordings::losses(summary);
  std::printf("left out:  %s\n", losses.empty() ? "nothing" : recordings::loss_text(losses).c_str());
  if (summary.num_gaps > 0) {
    std::printf("gaps:      %llu stretches of time are incomplete\n",
                static_cast<unsigned long long>(summary.num_gaps));
  }
  for (const recordings::Assumption& assumption : info.assumptions) {
    std::printf("assumed:   %s\n", assumption_text(assumption).c_str());
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
  E2LF_ASSIGN_OR_RETURN(const recordings::OpenOptions open, open_options(path, options.flags));
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_named_recording(path.string(), open));
  recordings::EventRateCounter rate(kPlotBins);
  RecordingStatistics statistics;
  ProgressBar bar("read", common.quiet, "events");
  recordings::EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) break;
    statistics.add(batch);
    if (!options.plot.empty()) rate.add(batch);
    bar.update(reader->summary().events(), 0);
  }
  hide_progress();
  if (common.json) {
    std::printf("%s", json_text(to_json(reader->info(), reader->summary(), statistics)).c_str());
  } else {
    print_text(reader->info(), reader->summary(), statistics);
  }
  if (!picture) return {};
  E2LF_RETURN_IF_ERROR(write_file(picture->path(), rate_plot_svg(rate.rate())));
  return picture->commit();
}

}  // namespace e2lf::cli
