// SPDX-License-Identifier: MIT
// e2lf accumulate: divides a recording into pattern cycles and accumulates their event images

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/diagnose/event_order.h"
#include "e2lf/files/options.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/event_counters.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct AccumulateArguments {
  fs::path input, output, codes;
  std::vector<fs::path> reports;
  CycleFlags cycles;
  OrientationFlags orientation;
};

/// The data for the plot of a recording, which are collected while it is divided into cycles.
struct CyclePlot {
  recordings::EventRateCounter rate{2000};
  FoundCycles found;

  void add(const cycles::Mark& mark) {
    if (found.marks.size() < kMaxDrawn) found.marks.push_back(mark);
  }
  void add(const cycles::Cycle& cycle) {
    if (found.cycles.size() < kMaxDrawn) found.cycles.push_back(cycle);
  }
};

/// Lets the progress bar and, unless it is null, the plot see what is read.
void observe(cycles::CycleOptions& options, ProgressBar& bar, CyclePlot* plot) {
  options.on_batch = [&, plot, events = size_t{0}](const recordings::EventBatch& batch) mutable {
    events += batch.events.size();
    bar.update(events, 0);
    if (plot != nullptr) plot->rate.add(batch);
  };
  if (plot != nullptr) options.on_mark = [plot](const cycles::Mark& mark) { plot->add(mark); };
}

/// Stores the setup of the recording with its event images. Patterns of the recording that do not match the schedule
/// are left out. Fails if those of the caller do not.
Result<void> keep_setup_of(const fs::path& input, const fs::path& codes, capture::RecordedSetup setup,
                           size_t transitions, capture::EventImageWriter& writer) {
  if (setup.codes && setup.codes->num_patterns != transitions + 1) {
    if (!codes.empty()) {
      return fail(ErrorCode::kInvalidValue, codes, "these are ", setup.codes->num_patterns, " patterns, and the ",
                  transitions, " event images of a cycle lie between ", transitions + 1,
                  "; give those that the camera showed, or their --schedule");
    }
    log_warning(cat(input.string(), " contains ", setup.codes->num_patterns,
                    " patterns, which do not match the schedule with ", transitions,
                    " event images; they are left out"));
    setup.codes.reset();
  }
  writer.keep(setup);
  return {};
}

/// Sums the first cycles, and judges whether they show a scene, and by their parallax the places of the patterns.
class SceneCheck {
 public:
  void add(const capture::EventImages& images) {
    if (cycles_++ == 0)
      sum_ = images;
    else if (cycles_ <= kMostCycles)
      pipeline::add_counts(images, sum_);
  }
  /// Adds to `findings`. Findings about the times or the polarity explain other places, too.
  void judge(const capture::RecordedSetup& setup, diagnose::Findings& findings) const {
    const size_t cycles = std::min(cycles_, kMostCycles);
    for (auto& finding : diagnose::check_event_images(sum_, cycles)) findings.push_back(std::move(finding));
    if (diagnose::has_doubt(findings)) return;
    if (setup.codes) {
      auto other = diagnose::check_order(sum_, cycles, setup);
      if (!other) other = diagnose::check_places(sum_, *setup.codes, setup.camera, setup.views);
      if (other) findings.push_back(*std::move(other));
      return;
    }
    log_info(
        "the patterns are unknown, so their order and orientation cannot be checked; name them with --codes, or give "
        "the "
        "schedule that `e2lf codes render` wrote with --schedule");
  }

 private:
  static constexpr size_t kMostCycles = 8;
  capture::EventImages sum_;
  size_t cycles_ = 0;
};

report::Table cycle_table(const Json& cycles) {
  report::Table table{"The cycles, in order of time.",
                      {{"cycle", true}, {"events", true}, {"begins, us", true}, {"confidence", true}},
                      {}};
  const bool is_live = !cycles.empty() && cycles[0].contains("latency_s");
  if (is_live) table.columns.push_back({"latency, s", true});
  const auto whole = [](const Json& number) { return report::Cell{number.dump(), number}; };
  for (const Json& cycle : cycles) {
    table.rows.push_back({whole(cycle["number"]), whole(cycle["events"]), whole(cycle["begin_us"]),
                          report::number_cell(cycle["confidence"].get<double>(), 3)});
    if (is_live) table.rows.back().push_back(report::number_cell(cycle["latency_s"].get<double>(), 3));
  }
  return table;
}

/// Returns a chart of a member of each cycle over the number of the cycle.
std::string cycle_curve(const Json& cycles, const char* member, const char* label) {
  report::LineChart chart{"cycle", label, {{"", {}, /*is_filled=*/true}}};
  for (const Json& cycle : cycles) {
    chart.lines[0].points.push_back({cycle["number"].get<double>(), cycle[member].get<double>()});
  }
  return report::chart_svg(chart);
}

/// What was read of a recording, for its report.
struct ReadCycles {
  CyclePlot plot;
  Json each = Json::array();
  std::optional<capture::EventImages> first;
};

Result<report::Page> cycles_page(const fs::path& input, const Json& facts, const ReadCycles& read) {
  const auto& [plot, cycles, first] = read;
  report::Page page = verb_page(cat("Pattern cycles in ", input.string()));
  page.facts(facts).heading("Events over time").drawing(report::chart_svg(rate_chart(plot.rate.rate(), plot.found)));
  if (first) {
    page.heading("The first cycle").paragraph("Events of each transition: red is ON, blue is OFF, grey is none.");
    E2LF_RETURN_IF_ERROR(add_pictures({{event_picture(*first), "event images"}}, 1600, page));
  }
  page.heading("Cycles");
  if (cycles.size() > 1) {
    page.drawing(cycle_curve(cycles, "events", "events")).drawing(cycle_curve(cycles, "confidence", "confidence"));
    if (cycles[0].contains("latency_s")) page.drawing(cycle_curve(cycles, "latency_s", "latency, s"));
  }
  page.table(cycle_table(cycles));
  return page;
}

Result<void> write_report(const fs::path& path, const pipeline::CycleInput& input, const ReadCycles& read,
                          ReportOutput& reports) {
  const std::vector<recordings::Loss> losses = recordings::losses(input.summary());
  const Json facts = {{"recording", path.string()},
                      {"source", word_of(input.reader().source(), kCycleSources)},
                      {"found", input.rig().json(input.reader())},
                      {"left_out", losses.empty() ? "nothing" : recordings::loss_text(losses)}};
  E2LF_ASSIGN_OR_RETURN(const report::Page page, cycles_page(path, facts, read));
  return reports.write(page);
}

/// Returns the setup to store with the event images. It is a finding if sources state different patterns.
Result<capture::RecordedSetup> setup_of(const AccumulateArguments& arguments,
                                        const std::optional<capture::Codes>& codes, const cycles::CycleReader& reader,
                                        diagnose::Findings& findings) {
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, pipeline::setup_of_cycles(arguments.input, reader));
  const cycles::Schedule& schedule = reader.schedule();
  auto contradicted = pipeline::contradicted_codes({.codes = codes, .events = setup, .schedule = &schedule});
  if (contradicted) findings.push_back(*std::move(contradicted));
  if (codes) setup.codes = cycles::codes_of_images(*codes, schedule).value_or(*codes);
  setup.views = arguments.orientation.after(setup.views);
  return setup;
}

/// Writes the event images of all cycles.
Result<void> write_cycles(const AccumulateArguments& arguments, const capture::RecordedSetup& setup,
                          pipeline::CycleInput& input, capture::EventImageWriter& writer, SceneCheck& scene,
                          ReadCycles& read) {
  LiveLog live_log;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(std::optional<pipeline::CycleImages> next, input.next());
    if (!next) break;
    const cycles::Cycle& cycle = *next->cycle;
    const capture::EventImages& images = next->images.events;
    if (writer.cycles() == 0) {
      read.first = images;
      E2LF_RETURN_IF_ERROR(keep_setup_of(arguments.input, arguments.codes, setup, images.count, writer));
    }
    scene.add(images);
    E2LF_RETURN_IF_ERROR(writer.add(images));
    read.each.push_back(cycle_json(cycle));
    if (cycle.arrival) {
      const double latency_s = next->behind_s + seconds_since(*cycle.arrival);
      read.each.back()["latency_s"] = latency_s;
      live_log.add(cycle.number, cycle.events, latency_s);
    }
    read.plot.add(cycle);
  }
  hide_progress();
  live_log.finish(input.reader().report());
  return {};
}

Result<void> accumulate(const AccumulateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(arguments.input));
  if (kind != FileKind::kRecording) return other_kind_error(arguments.input, kind, "a recording");
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(arguments.reports, output_rules(verb)));
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, ".npz"));
  RunRecord record(verb);
  ReadCycles read;
  SceneCheck scene;
  // For live input, the log has a line for each cycle instead.
  ProgressBar bar("accumulate", common.quiet || is_live(arguments.input), "events");
  std::optional<capture::Codes> codes;
  if (!arguments.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, pipeline::read_patterns(arguments.codes));
    record.add_input(arguments.codes);
  }
  CycleFlags flags = arguments.cycles;
  observe(flags.events.cycles, bar, reports.is_wanted() ? &read.plot : nullptr);
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInput input, open_cycle_input(arguments.input, flags, verb, {.codes = codes}));
  E2LF_ASSIGN_OR_RETURN(const auto writer, capture::EventImageWriter::create(output.path()));
  diagnose::Findings of_setup;
  E2LF_ASSIGN_OR_RETURN(const capture::RecordedSetup setup, setup_of(arguments, codes, input.reader(), of_setup));
  E2LF_RETURN_IF_ERROR(write_cycles(arguments, setup, input, *writer, scene, read));
  record.end_step("accumulate");
  const cycles::CycleReader& reader = input.reader();
  const recordings::DecodeSummary summary = input.summary();
  warn_of_losses(arguments.input, summary);
  verb.set_failed_input(summary.live.failure);
  // The report is written first, because it shows why no cycle was found.
  if (reports.is_wanted()) E2LF_RETURN_IF_ERROR(write_report(arguments.input, input, read, reports));
  if (writer->cycles() == 0) return no_cycle_error(arguments.input, input.rig(), reader);
  diagnose::Findings findings = input.rig().findings(reader);
  scene.judge(setup, findings);
  findings.insert(findings.end(), of_setup.begin(), of_setup.end());
  diagnose::log_findings(arguments.input.string(), findings);
  E2LF_RETURN_IF_ERROR(writer->finish(json_line(diagnose::to_json(findings))));
  record.resolve("source", word_of(reader.source(), kCycleSources));
  Json json = input.rig().json(reader);
  record.note("cycles", json);
  const Json found = {{"left_out", losses_json(summary)}, {"live", live_json(summary)}, {"each", std::move(read.each)}};
  record.note(found);
  record.note(reading_notes(arguments.input, reader.recording().info()));
  if (setup.views) record.note("views", capture::orientation_name(*setup.views));
  record.add_input(arguments.input);
  E2LF_RETURN_IF_ERROR(commit(output, record));
  json["findings"] = diagnose::to_json(findings);
  json.update(found);
  print_result(
      common, json,
      cat(input.rig().triggers_text(reader.schedule()), "\n", report_text(reader.report()), " in ",
          arguments.output.string(), formatted(", least confidence %.2f\n", double{input.rig().least_confidence()})));
  return {};
}

}  // namespace

int run_accumulate(const std::vector<std::string>& arguments) {
  Verb verb(
      "accumulate",
      "Divide a recording into pattern cycles and sum the events of each into event images. Needs constant memory.",
      "e2lf accumulate recording.raw -o events.npz --source bursts");
  AccumulateArguments accumulation;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", accumulation.input,
                 "recording, - for a pipe, tcp://127.0.0.1:PORT, camera://NAME or replay:FILE")
      ->required();
  app.add_option("-o,--output", accumulation.output, "event images to write (.npz)")->required();
  add_report_option(app, accumulation.reports);
  add_codes_option(
      app, accumulation.codes,
      "the patterns that the camera showed (.json, .npy, .npz, or a model); default: as the recording or the "
      "schedule states");
  add_cycle_options(app, accumulation.cycles);
  add_orientation_options(app, accumulation.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return accumulate(accumulation, verb); });
}

}  // namespace e2lf::cli
