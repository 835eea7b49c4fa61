// SPDX-License-Identifier: MIT
// e2lf equivalence: validity of the paper's findings on event images for several thresholds and noise levels
#include "e2lf/recon/equivalence.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/file.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/light_field_flags.h"
#include "e2lf/program/run_record.h"
#include "e2lf/report/chart.h"
#include "e2lf/report/page.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct EquivalenceArguments {
  fs::path input, output;
  CodesSource codes;
  std::vector<float> taus = {0.05F, 0.1F, 0.15F, 0.2F, 0.3F, 0.4F, 0.5F};
  std::vector<float> noises = {0.0F, 0.5F, 1.0F};
  std::vector<size_t> order;
  LightFieldFlags light_field;
};

/// One setting and its results.
struct Row {
  std::string event_model;
  float tau = 0, noise = 0;  ///< noise as a fraction of that of the model or the paper
  recon::Equivalence found;
};

/// Returns the other order of the patterns, counted from 0. By default, black, which is first in most sequences, moves
/// to the end.
Result<std::vector<size_t>> order_of(const EquivalenceArguments& arguments, size_t num_patterns) {
  std::vector<size_t> order;
  for (size_t n = 1; n <= num_patterns; ++n) order.push_back(n % num_patterns);
  if (arguments.order.empty()) return order;
  std::vector<size_t> other;
  for (const size_t n : arguments.order) other.push_back(n - 1);
  if (std::ranges::is_permutation(other, order)) return other;
  return fail(ErrorCode::kInvalidValue, "--order", "an order contains each of 1 to ", num_patterns,
              " once; e.g. 2,3,4,1");
}

Result<std::vector<Row>> measure(const EquivalenceArguments& arguments, const pipeline::KnownCodes& known,
                                 const std::vector<size_t>& order, const lightfield::LightField& scene,
                                 const CommonOptions& common) {
  ProgressBar bar("measure", common.quiet);
  std::vector<Row> rows;
  const size_t total = 2 * arguments.noises.size() * arguments.taus.size();
  for (const auto model : {sensor::EventModel::kReferenceAware, sensor::EventModel::kQuantised}) {
    for (const float noise : arguments.noises) {
      for (const float tau : arguments.taus) {
        bar.update(rows.size(), total);
        sensor::EventModelOptions options{.model = model, .constants = known.constants, .seed = common.seed};
        options.constants.tau = tau;
        options.constants.sigma_w *= noise;
        // Scaled with the threshold, because with the same value, small thresholds would nearly vanish.
        options.constants.sigma_z *= noise * tau / known.constants.tau;
        Row row{sensor::event_model_name(model), tau, noise, {}};
        E2LF_ASSIGN_OR_RETURN(row.found, recon::measure_equivalence(known.codes, order, scene, options));
        rows.push_back(std::move(row));
      }
    }
  }
  return rows;
}

report::Table table_of(const std::vector<Row>& rows) {
  report::Table table;
  table.columns = {{"event model"},       {"noise", true},     {"tau", true},
                   {"Eq. 7 error", true}, {"centred", true},   {"Eq. 11 error", true},
                   {"repeated", true},    {"events/px", true}, {"events/px, other order", true}};
  for (const Row& row : rows) {
    table.rows.push_back(
        {report::text_cell(row.event_model), report::number_cell(row.noise, 2), report::number_cell(row.tau, 2),
         report::number_cell(row.found.intensity_error, 3), report::number_cell(row.found.centred_error, 3),
         report::number_cell(row.found.permuted_error, 3), report::number_cell(row.found.repeated_error, 3),
         report::number_cell(row.found.events_per_pixel, 3),
         report::number_cell(row.found.permuted_events_per_pixel, 3)});
  }
  return table;
}

/// Draws a line over tau for each event model and noise level.
std::string chart(const std::vector<Row>& rows, const std::string& y_label, double recon::Equivalence::*figure) {
  report::LineChart chart{"contrast threshold tau", y_label, {}};
  for (const Row& row : rows) {
    const std::string name = cat(row.event_model, ", noise x ", row.noise);
    if (chart.lines.empty() || chart.lines.back().name != name) chart.lines.push_back({name, {}});
    chart.lines.back().points.push_back({row.tau, row.found.*figure});
  }
  return report::chart_svg(chart);
}

std::string page_of(const EquivalenceArguments& arguments, const std::vector<Row>& rows) {
  report::Page page("Events for intensities, and other orders of patterns");
  page.paragraph(cat("Scene: ", arguments.input.string(),
                     ". Noise is a fraction of that of the sensor: 1 is the stated noise, 0 is none."));
  page.heading("Equivalence (Eq. 7)")
      .paragraph(
          "Coded intensities that were computed from event counts after black, compared with the true ones: RMS error "
          "relative to their RMS.")
      .drawing(chart(rows, "relative error", &recon::Equivalence::intensity_error));
  page.heading("Permutation invariance (Eq. 11)")
      .paragraph(
          "Event images of the patterns in another order that were computed from those of the first order, compared "
          "with simulated ones: RMS difference in events. The column \"repeated\" contains the same difference between "
          "two recordings of the other order, which differ only in their noise.")
      .drawing(chart(rows, "events", &recon::Equivalence::permuted_error));
  page.heading("Figures").table(table_of(rows));
  return page.html();
}

Result<void> run(const EquivalenceArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(
      ResultFolder output,
      open_output_folder(arguments.output, verb, {arguments.input, arguments.codes.model, arguments.codes.codes}));
  RunRecord record("equivalence", {arguments.input});
  E2LF_ASSIGN_OR_RETURN(const pipeline::KnownCodes known, load_codes(arguments.codes, record));
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> order, order_of(arguments, known.codes.num_patterns));
  const SceneOptions options{arguments.light_field, known.codes.views_y, known.codes.views_x};
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField scene, load_scene(arguments.input, options, common.quiet));
  record.end_step("read");
  E2LF_ASSIGN_OR_RETURN(const std::vector<Row> rows, measure(arguments, known, order, scene, common));
  hide_progress();
  record.end_step("measure");
  const report::Table table = table_of(rows);
  E2LF_RETURN_IF_ERROR(write_file(output.path() / "table.csv", report::table_csv(table)));
  E2LF_RETURN_IF_ERROR(write_file(output.path() / "index.html", page_of(arguments, rows)));
  E2LF_RETURN_IF_ERROR(commit(output, record, verb));
  print_result(common, report::table_json(table),
               cat(report::table_text(table), "\nin ", arguments.output.string(), ": index.html, table.csv\n"));
  return {};
}

}  // namespace

int run_equivalence(const std::vector<std::string>& arguments) {
  Verb verb("equivalence",
            "Measure how well event images determine intensity images (Eq. 7) and the event images of the patterns in "
            "another order (Eq. 11), for several thresholds and noise levels.",
            "e2lf equivalence out/demo/scene -o out/equivalence");
  EquivalenceArguments equivalence;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", equivalence.input, "light field")->required();
  app.add_option("-o,--output", equivalence.output, "folder to write")->required();
  add_codes_options(app, equivalence.codes);
  app.add_option("--taus", equivalence.taus, "contrast thresholds")->delimiter(',')->check(CLI::Range(0.001, 10.0));
  app.add_option("--noises", equivalence.noises,
                 "noise levels as fractions: 1 is the noise of the model, or of the paper")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 10.0));
  app.add_option("--order", equivalence.order, "the other order of the patterns; default for four: 2,3,4,1")
      ->delimiter(',');
  add_light_field_options(app, equivalence.light_field, /*has_views=*/false);
  return verb.run(arguments, [&] { return run(equivalence, verb); });
}

}  // namespace e2lf::cli
