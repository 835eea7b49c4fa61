// SPDX-License-Identifier: MIT
// e2lf-bench decode
#include <cmath>

#include "bench/decode/benchmark_decode.h"
#include "bench/program/report.h"
#include "bench/program/verbs.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/verb.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

/// Measured on one thread of a Zen 4 class server CPU, from memory, on streams of these shapes; 0 = does not read it.
struct PublishedRates {
  const char* decoder;
  int rates[5];  ///< of kShapes
};
constexpr const char* kShapes[] = {"evt3 dense", "evt3 sparse", "evt3 vector", "evt2", "evt2.1"};
constexpr PublishedRates kPublished[] = {
    {"OpenEB 5.1.1, a callback for every event", {144, 50, 246, 293, 305}},
    {"OpenEB 5.1.1, built for the native CPU", {166, 52, 318, 442, 543}},
    {"OpenEB 5.1.1, into a vector of structs", {152, 52, 266, 322, 335}},
    {"evutils C core, native, columns", {186, 61, 598, 483, 863}},
    {"event_camera_codecs", {166, 78, 132, 0, 0}},
    {"expelliarmus", {87, 0, 129, 340, 0}},
};

Json rate_json(double rate, double reference) {
  Json json = {{"columns", rate}};
  if (reference > 0) json["columns_ratio"] = rate / reference;
  return json;
}

Json to_json(const std::vector<DecodeBenchmarkRow>& rows) {
  Json json = {{"unit", "million events per second"}, {"threads", num_threads()}, {"isa", current_isa()}};
  for (const DecodeBenchmarkRow& row : rows) {
    Json entry = {{"shape", row.shape},
                  {"source", row.source},
                  {"events", row.events},
                  {"bytes_per_event", row.bytes_per_event},
                  {"one_thread", rate_json(row.one_thread, row.reference)},
                  {"all_threads", rate_json(row.all_threads, row.reference)}};
    if (row.skipping > 0) {
      entry["skipping"] = {{"events", row.skipping}, {"ratio_to_one_thread", row.skipping / row.one_thread}};
    }
    if (row.reference > 0) entry["reference"] = rate_json(row.reference, 0);
    json["streams"].push_back(std::move(entry));
  }
  for (const PublishedRates& published : kPublished) {
    Json entry = {{"decoder", published.decoder}};
    for (size_t i = 0; i < std::size(kShapes); ++i) {
      if (published.rates[i] != 0) entry[kShapes[i]] = published.rates[i];
    }
    json["published_on_another_machine"].push_back(std::move(entry));
  }
  return json;
}

Result<std::vector<ConvertBenchmarkRow>> measure_conversion(const std::filesystem::path& folder,
                                                            const DecodeBenchmarkOptions& decode) {
  ConvertBenchmarkOptions options;
  options.folder = folder;
  options.events = decode.events;
  std::error_code status;
  if (std::filesystem::is_regular_file(decode.input, status)) options.input = decode.input;
  return benchmark_conversion(options);
}

BenchReport decode_report(const std::vector<DecodeBenchmarkRow>& rows,
                          const std::vector<ConvertBenchmarkRow>& conversions, const std::string& folder) {
  report::Table table{"Millions of events per second, to columns, and the ratio to the scalar reference.",
                      {{"stream"},
                       {"source"},
                       {"M events", true},
                       {"bytes/event", true},
                       {"one thread", true},
                       {"ratio", true, false, "one thread ratio"},
                       {"all threads", true},
                       {"ratio", true, false, "all threads ratio"},
                       {"skipping", true},
                       {"ratio", true, false, "skipping to one thread"},
                       {"reference", true}},
                      {}};
  for (const DecodeBenchmarkRow& row : rows) {
    const auto known = [&](double value) { return row.reference > 0 ? std::optional(value) : std::nullopt; };
    const auto skipped = [&](double value) { return row.skipping > 0 ? std::optional(value) : std::nullopt; };
    table.rows.push_back(
        {report::text_cell(row.shape), report::text_cell(row.source),
         report::number_cell(static_cast<double>(row.events) * 1e-6, 1), report::number_cell(row.bytes_per_event, 2),
         report::number_cell(row.one_thread, 0), report::number_cell(known(row.one_thread / row.reference), 1),
         report::number_cell(row.all_threads, 0), report::number_cell(known(row.all_threads / row.reference), 1),
         report::number_cell(skipped(row.skipping), 0), report::number_cell(skipped(row.skipping / row.one_thread), 1),
         report::number_cell(known(row.reference), 0)});
  }
  report::Table published{"Other decoders on one thread, as measured on another machine (Zen 4), M events/s.",
                          {{"others, on ANOTHER machine (Zen 4)"}},
                          {}};
  for (const char* shape : kShapes) published.columns.push_back({shape, true});
  for (const PublishedRates& other : kPublished) {
    published.rows.push_back({report::text_cell(other.decoder)});
    for (const int rate : other.rates) {
      published.rows.back().push_back(rate == 0 ? report::Cell() : report::number_cell(rate, 0));
    }
  }
  BenchReport found{"Speed of decoding",
                    cat("decoding from memory, M events/s; ", num_threads(), " threads, ", current_isa(),
                        "; ratios to the scalar reference in this run; one thread by its processor time"),
                    {std::move(table), std::move(published)}};
  for (const auto& row : conversions) {
    found.note += cat(found.note.empty() ? "" : "\n", "RAW file to ", row.format, " in ", folder, ": ",
                      std::lround(row.mevents_per_s), " M events/s");
  }
  return found;
}

}  // namespace

int run_decode(const std::vector<std::string>& arguments) {
  Verb verb("decode",
            "Measure the decoding of RAW recordings from memory, to columns, against the "
            "scalar reference in the same run.",
            "e2lf-bench decode RECORDINGS_DIR --json");
  DecodeBenchmarkOptions options;
  bool without_reference = false;
  std::filesystem::path convert_folder;
  std::vector<std::filesystem::path> report_names;
  add_report_option(verb.app(), report_names);
  verb.app().add_option("input,-i,--input", options.input,
                        "RAW recording or folder of them, repeated to the wanted length; default: synthesised streams");
  verb.app().add_option("--events", options.events, "length of each stream")->capture_default_str();
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  verb.app().add_flag("--no-reference", without_reference, "leave the scalar reference out");
  verb.app().add_option("--convert", convert_folder,
                        "measure the conversion of a dense EVT3 file, or the given one, in this folder too");
  return verb.run(arguments, [&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(report_names, output_rules(verb, {options.input})));
    options.with_reference = !without_reference;
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const auto rows, benchmark_decoding(options, bar.callback()));
    hide_progress();
    std::vector<ConvertBenchmarkRow> conversions;
    if (!convert_folder.empty()) {
      E2LF_ASSIGN_OR_RETURN(conversions, measure_conversion(convert_folder, options));
    }
    Json json = to_json(rows);
    for (const auto& row : conversions) json["convert"][row.format] = row.mevents_per_s;
    return finish(verb, json, decode_report(rows, conversions, convert_folder.string()), reports);
  });
}

}  // namespace e2lf::bench
