// SPDX-License-Identifier: MIT
// e2lf bench decode
#include "e2lf/cli/bench_decode.h"

#include <cstdio>

#include "bench/decode/benchmark_convert.h"
#include "bench/decode/benchmark_decode.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/threads.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/json_text.h"

namespace e2lf::cli {
namespace {

using bench::DecodeBenchmarkRow;

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

Result<std::vector<bench::ConvertBenchmarkRow>> measure_conversion(const std::filesystem::path& folder,
                                                                   const bench::DecodeBenchmarkOptions& decode) {
  bench::ConvertBenchmarkOptions options;
  options.folder = folder;
  options.events = decode.events;
  std::error_code status;
  if (std::filesystem::is_regular_file(decode.input, status)) options.input = decode.input;
  return bench::benchmark_conversion(options);
}

void print_line(const char* what, double rate, double reference) {
  std::printf("  %-24s %9.0f", what, rate);
  std::printf(reference > 0 ? " %6.1fx\n" : "       -\n", rate / reference);
}

void print_table(const std::vector<DecodeBenchmarkRow>& rows) {
  std::printf(
      "decoding from memory, M events/s; %d threads, %s; ratios to the scalar reference in this run; one thread by its "
      "processor time\n",
      num_threads(), current_isa().c_str());
  std::printf("\n%-26s %9s %7s\n", "", "columns", "ratio");
  for (const DecodeBenchmarkRow& row : rows) {
    std::printf("%s: %s, %.1f M events, %.2f bytes per event\n", row.shape.c_str(), row.source.c_str(),
                static_cast<double>(row.events) * 1e-6, row.bytes_per_event);
    print_line("one thread", row.one_thread, row.reference);
    print_line("all threads", row.all_threads, row.reference);
    if (row.reference > 0) print_line("scalar reference", row.reference, 0);
  }
  std::printf("\nother decoders on one thread, as measured on ANOTHER machine (Zen 4):\n%-42s", "");
  for (const char* shape : kShapes) std::printf(" %11s", shape);
  std::printf("\n");
  for (const PublishedRates& published : kPublished) {
    std::printf("%-42s", published.decoder);
    for (const int rate : published.rates) std::printf(rate == 0 ? "           -" : " %11d", rate);
    std::printf("\n");
  }
}

}  // namespace

int run_bench_decode(const std::vector<std::string>& arguments) {
  Verb verb("bench decode",
            "Measure the decoding of RAW recordings from memory, to columns, against the "
            "scalar reference in the same run.",
            "e2lf bench decode RECORDINGS_DIR --json");
  bench::DecodeBenchmarkOptions options;
  bool without_reference = false;
  std::filesystem::path convert_folder;
  verb.app().add_option("input,-i,--input", options.input,
                        "RAW recording or folder of them, repeated to the wanted length; default: synthesised streams");
  verb.app().add_option("--events", options.events, "length of each stream")->capture_default_str();
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  verb.app().add_flag("--no-reference", without_reference, "leave the scalar reference out");
  verb.app().add_option("--convert", convert_folder,
                        "measure the conversion of a dense EVT3 file, or the given one, in this folder too");
  return verb.run(arguments, [&]() -> Result<void> {
    options.with_reference = !without_reference;
    ProgressBar bar("bench", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const auto rows, bench::benchmark_decoding(options, bar.callback()));
    hide_progress();
    std::vector<bench::ConvertBenchmarkRow> conversions;
    if (!convert_folder.empty()) {
      E2LF_ASSIGN_OR_RETURN(conversions, measure_conversion(convert_folder, options));
    }
    if (verb.common().json) {
      Json json = to_json(rows);
      for (const auto& row : conversions) json["convert"][row.format] = row.mevents_per_s;
      std::printf("%s", json_text(json).c_str());
      return {};
    }
    print_table(rows);
    for (const auto& row : conversions) {
      std::printf("RAW file to %-4s in %s: %.0f M events/s\n", row.format.c_str(), convert_folder.c_str(),
                  row.mevents_per_s);
    }
    return {};
  });
}

}  // namespace e2lf::cli
