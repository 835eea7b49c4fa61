// SPDX-License-Identifier: MIT
// e2lf info: description of a file or folder
#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/options.h"
#include "e2lf/info/describe.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/event_counters.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct InfoArguments {
  fs::path path;
  std::vector<fs::path> reports;
  RecordingFlags recording;
  LightFieldFlags light_field;
};

void print(const Description& found, const CommonOptions& common) {
  std::printf("%s", (common.json ? json_text(found.json) : found.text()).c_str());
}

Result<void> print_recording(const InfoArguments& arguments, ReportOutput& reports, const Verb& verb) {
  const CommonOptions& common = verb.common();
  constexpr size_t kPlotBins = 2000;
  recordings::EventRateCounter rate(kPlotBins);
  DescribeOptions options;
  E2LF_ASSIGN_OR_RETURN(options.recording, open_options(arguments.path, arguments.recording, true));
  if (reports.is_wanted()) {
    options.on_batch = [&rate](const recordings::EventBatch& batch) { rate.add(batch); };
  }
  ProgressBar bar("read", common.quiet, "events");
  options.progress = bar.callback();
  E2LF_ASSIGN_OR_RETURN(const Description found, describe_recording(arguments.path, options));
  hide_progress();
  verb.set_failed_input(found.failure);
  print(found, common);
  if (!reports.is_wanted()) return {};
  report::Page page = verb_page(arguments.path.string());
  page.heading("Events over time").drawing(report::chart_svg(rate_chart(rate.rate())));
  page.heading("All that is known").table(report::facts_table(found.json));
  return reports.write(page);
}

Result<void> print_info(InfoArguments& arguments, const Verb& verb) {
  arguments.path = file_or_bundled_model(arguments.path);
  const fs::path& path = arguments.path;
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField && kind != FileKind::kCycles) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options({kLightFieldOptions}, kind_text(kind)));
  }
  if (kind == FileKind::kRecording) {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(arguments.reports, output_rules(verb)));
    return print_recording(arguments, reports, verb);
  }
  if (!arguments.reports.empty()) {
    return fail(ErrorCode::kUnsupported, "--report", "reports are made of recordings; `e2lf view` shows ",
                kind_text(kind));
  }
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kOptionsOfRecordings, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(const Description found,
                        describe(kind, path, {.light_field = unchanged_options(arguments.light_field)}));
  print(found, verb.common());
  return {};
}

}  // namespace

int run_info(const std::vector<std::string>& arguments) {
  Verb verb("info", "Describe a file or folder: a recording, event images, a light field, a model or settings.",
            "e2lf info recording.raw --report rate.svg");
  InfoArguments info;
  CLI::App& app = verb.app();
  app.add_option("path,-i,--input", info.path, "file or folder, or a bundled model")->required()->type_name(kThingType);
  add_report_option(app, info.reports);
  add_recording_options(app, info.recording);
  add_light_field_options(app, info.light_field, /*has_views=*/true);
  verb.stop_gently();
  return verb.run(arguments, [&] { return print_info(info, verb); });
}

}  // namespace e2lf::cli
