// SPDX-License-Identifier: MIT
// e2lf info: description of a file or folder
#include <cstdio>

#include "e2lf/cli/flags/option_values.h"
#include "e2lf/cli/output/report_output.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/describe.h"
#include "e2lf/cli/verbs/rate_plot.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/event_rate.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct InfoArguments {
  fs::path path;
  fs::path plot;  ///< chart of the event rate; empty = none
  std::vector<fs::path> reports;
  DescribeOptions options;
};

void print(const Description& found, const CommonOptions& common) {
  std::printf("%s", common.json ? json_text(found.json).c_str() : found.text.c_str());
}

Result<void> write_report(const Description& found, const InfoArguments& arguments, const std::string& rate_svg,
                          ReportOutput& reports) {
  if (!reports.is_wanted()) return {};
  report::Page page = verb_page(arguments.path.string());
  page.code(found.text);
  if (!rate_svg.empty()) page.heading("Events over time").drawing(rate_svg);
  if (found.show) E2LF_RETURN_IF_ERROR(found.show(page));
  page.heading("All that is known").table(report::facts_table(found.json));
  return reports.write(page);
}

Result<void> print_recording(InfoArguments& arguments, ReportOutput& reports, const Verb& verb) {
  const CommonOptions& common = verb.common();
  constexpr size_t kPlotBins = 2000;
  recordings::EventRateCounter rate(kPlotBins);
  E2LF_ASSIGN_OR_RETURN(ChartOutput chart,
                        ChartOutput::open(arguments.plot, {.inputs = {arguments.path}, .overwrite = common.overwrite}));
  if (chart.is_wanted() || reports.is_wanted()) {
    arguments.options.on_batch = [&rate](const recordings::EventBatch& batch) { rate.add(batch); };
  }
  ProgressBar bar("read", common.quiet, "events");
  arguments.options.progress = bar.callback();
  E2LF_ASSIGN_OR_RETURN(const Description found, describe_recording(arguments.path, arguments.options));
  hide_progress();
  verb.note_failed_input(found.failure);
  print(found, common);
  const std::string svg = report::chart_svg(rate_chart(rate.rate()));
  if (chart.is_wanted()) E2LF_RETURN_IF_ERROR(chart.write(svg));
  return write_report(found, arguments, svg, reports);
}

Result<void> print_info(InfoArguments& arguments, const Verb& verb) {
  arguments.path = thing_named(arguments.path);
  const fs::path& path = arguments.path;
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField && kind != FileKind::kCycles) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options(kLightFieldOptions, kind_text(kind)));
  }
  E2LF_ASSIGN_OR_RETURN(
      ReportOutput reports,
      ReportOutput::open(arguments.reports, {.inputs = {path}, .overwrite = verb.common().overwrite}));
  if (kind == FileKind::kRecording) return print_recording(arguments, reports, verb);
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kRecordingOptions, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(const Description found, describe(kind, path, arguments.options));
  if (!arguments.plot.empty()) {
    return Error{ErrorCode::kInvalidValue,
                 "this is not a recording, so there is no event rate to plot; leave --plot out", path.string()};
  }
  print(found, verb.common());
  return write_report(found, arguments, {}, reports);
}

}  // namespace

int run_info(const std::vector<std::string>& arguments) {
  Verb verb("info", "Describe a file or folder: a recording, event images, a light field, a model or settings.",
            "e2lf info recording.raw --plot rate.svg");
  InfoArguments info;
  verb.app()
      .add_option("path,-i,--input", info.path, "file or folder, or a bundled model")
      ->required()
      ->type_name(kThingType);
  add_chart_option(verb.app(), info.plot, "recordings: write a chart of the event rate over time (.svg, .png)");
  add_report_option(verb.app(), info.reports);
  add_recording_options(verb.app(), info.options.recording, kRecordingOptions);
  add_light_field_options(verb.app(), info.options.light_field, /*has_views=*/true);
  verb.stop_gently();
  return verb.run(arguments, [&] { return print_info(info, verb); });
}

}  // namespace e2lf::cli
