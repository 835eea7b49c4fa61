// SPDX-License-Identifier: MIT
// e2lf eval: a reconstruction against the truth
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "e2lf/capture/event_images.h"
#include "e2lf/cli/inputs.h"
#include "e2lf/cli/output.h"
#include "e2lf/cli/report_output.h"
#include "e2lf/cli/run_record.h"
#include "e2lf/cli/scene_input.h"
#include "e2lf/cli/verb.h"
#include "e2lf/compare/pictures.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/json_text.h"
#include "e2lf/report/chart.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct EvalArguments {
  fs::path truth, reconstruction, events, output;
  bool no_clamp = false, csv = false;
  std::vector<fs::path> reports;
};

/// A number of each view in the order of the aperture.
std::string view_grid(const eval::LightFieldMetrics& quality, double eval::Metrics::*metric, int decimals) {
  report::CellGrid grid;
  grid.columns = 0;
  grid.low = INFINITY;
  grid.high = -INFINITY;
  for (const eval::ViewMetrics& view : quality.views) {
    const double value = view.metrics.*metric;
    grid.values.push_back(value);
    if (view.view_y == quality.views.front().view_y) ++grid.columns;
    if (!std::isfinite(value)) continue;
    grid.low = std::min(grid.low, value);
    grid.high = std::max(grid.high, value);
  }
  grid.decimals = decimals;
  grid.cell_px = 46;
  return report::grid_svg(grid);
}

Result<report::Page> eval_page(const eval::EvalRow& row, const lightfield::LightField& truth,
                               const lightfield::LightField& reconstruction) {
  report::Page page = verb_page(cat(row.method, " against ", row.scene));
  const lightfield::Shape& shape = truth.shape();
  page.paragraph(cat(shape.views_y, "x", shape.views_x, " views of ", shape.width, "x", shape.height, " px, ",
                     shape.channels == 1 ? "grey" : "colour"));
  page.table(eval::quality_table({&row, 1}));
  page.heading("Views").paragraph("Each view in the order of the aperture.").begin_row();
  page.drawing(view_grid(row.quality, &eval::Metrics::psnr_db, 1), "PSNR, dB");
  page.drawing(view_grid(row.quality, &eval::Metrics::ssim_uniform7, 3), "SSIM, windows of 7x7");
  page.end_row();
  page.heading("Pictures")
      .paragraph(
          "The upper left view, its middle enlarged; below it the EPI of the middle row, which has straight lines "
          "where "
          "views agree. Beside the reconstruction its error: black is none, white 0.2 and more.");
  E2LF_RETURN_IF_ERROR(add_pictures(
      {{compare::look(truth, nullptr), cat("truth: ", row.scene)}, {compare::look(reconstruction, &truth), row.method}},
      700, page));
  if (row.events) {
    page.heading("Events").facts(eval::to_json(*row.events)).drawing(transition_bars(row.events->events_per_pixel));
  }
  return page;
}

void print_result(const eval::EvalRow& row, size_t channels, const EvalArguments& arguments,
                  const CommonOptions& common) {
  if (common.json) {
    Json json = eval::to_json(row.quality);
    json["channels"] = channels;
    if (row.events) json["events"] = eval::to_json(*row.events);
    std::printf("%s", json_text(json).c_str());
  } else if (arguments.csv) {
    std::printf("%s", report::table_csv(eval::quality_table({&row, 1})).c_str());
  } else if (!common.quiet) {
    std::printf("%s\nPSNR of each view in dB:\n%s", report::table_text(eval::quality_table({&row, 1})).c_str(),
                eval::view_grid_text(row.quality).c_str());
  }
}

Result<void> evaluate(const EvalArguments& arguments, const Verb& verb) {
  const bool quiet = verb.common().quiet;
  OutputRules rules{.inputs = {arguments.truth, arguments.reconstruction, arguments.events},
                    .overwrite = verb.common().overwrite};
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(arguments.reports, rules));
  std::optional<OutputFile> output;
  rules.streams = true;
  if (!arguments.output.empty()) {
    rules.ending = ".json";
    E2LF_ASSIGN_OR_RETURN(output, OutputFile::create(arguments.output, rules));
  }
  lightfield::ReadOptions all = read_options({.views = 0});
  all.range = lightfield::RangePolicy::kKeep;
  all.colour = true;
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField reconstruction,
                        read_with_progress(arguments.reconstruction, all, quiet));
  // Of the truth as many views, and its colours where the reconstruction has some.
  const lightfield::Shape& shape = reconstruction.shape();
  const SceneOptions same{{}, shape.views_y, shape.views_x, shape.channels == 3};
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField truth, load_scene(arguments.truth, same, quiet));
  eval::EvalRow row{arguments.reconstruction.string(), arguments.truth.string(), {}, {}};
  {
    ProgressBar bar("compare", quiet);
    E2LF_ASSIGN_OR_RETURN(row.quality,
                          eval::compare(truth, reconstruction, {.clamp = !arguments.no_clamp}, bar.callback()));
  }
  if (!arguments.events.empty()) {
    E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(arguments.events));
    const capture::EventImages& images = file.cycles.front();
    if (images.width != truth.shape().width || images.height != truth.shape().height) {
      return Error{ErrorCode::kShape,
                   cat("event images of ", images.width, "x", images.height, " px are not of a light field of ",
                       truth.shape().width, "x", truth.shape().height, " px; give those it was made from"),
                   arguments.events.string()};
    }
    row.events = eval::event_statistics(images);
  }
  if (output) {
    E2LF_RETURN_IF_ERROR(write_file(output->path(), json_text(eval::to_json(row))));
    E2LF_RETURN_IF_ERROR(output->commit());
  }
  if (reports.is_wanted()) {
    E2LF_ASSIGN_OR_RETURN(const report::Page page, eval_page(row, truth, reconstruction));
    E2LF_RETURN_IF_ERROR(reports.write(page));
  }
  print_result(row, shape.channels, arguments, verb.common());
  return {};
}

}  // namespace

int run_eval(const std::vector<std::string>& arguments) {
  Verb verb("eval",
            "Compare a reconstructed light field with the true one: PSNR and SSIM of each view and their means.",
            "e2lf eval scene/ out/recon --events events.npz --report quality.html");
  EvalArguments evaluation;
  CLI::App& app = verb.app();
  app.add_option("truth", evaluation.truth, "the true light field")->required();
  app.add_option("reconstruction", evaluation.reconstruction, "the reconstructed light field")->required();
  app.add_option("--events", evaluation.events, "event images: adds event counts, measurement time and data rate");
  app.add_option("-o,--output", evaluation.output, "also write the result to this JSON file");
  add_report_option(app, evaluation.reports);
  app.add_flag("--csv", evaluation.csv, "print comma-separated values");
  app.add_flag("--no-clamp", evaluation.no_clamp, "do not clamp the reconstruction to [0, 1] before measuring");
  return verb.run(arguments, [&] { return evaluate(evaluation, verb); });
}

}  // namespace e2lf::cli
