// SPDX-License-Identifier: MIT
// e2lf-bench decode: measures decoding from memory against the scalar reference.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

#include "bench/decode/benchmark_streams.h"
#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/convert.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
namespace {

namespace fs = std::filesystem;

struct DecodeBench {
  /// A RAW recording, or a folder of them, which are repeated to make streams. If it is empty, all streams are
  /// synthesised.
  fs::path input = {};
  uint64_t events = 50'000'000;  ///< approximate number in each stream
  double seconds = 1.0;          ///< for each measurement, which consists of at least two runs
  bool with_reference = true;    ///< measures the scalar reference as well
};

/// Returns processor time for the work of one thread, which excludes time used by other programs, and wall-clock time
/// for several threads.
double clock_s(int threads) {
  timespec now{};
  ::clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Result<std::unique_ptr<recordings::RecordingReader>> open_stream(const BenchmarkStream& stream, int threads) {
  recordings::OpenOptions options;
  options.policy = recordings::DecodePolicy::kSkip;
  options.threads = threads;
  return recordings::open_recording(
      recordings::make_memory_source(std::span<const uint8_t>(stream.bytes), stream.source), options);
}

Result<recordings::DecodeSummary> decode_to_columns(const BenchmarkStream& stream, int threads, bool skips = false) {
  E2LF_ASSIGN_OR_RETURN(const auto reader, open_stream(stream, threads));
  if (skips) reader->skip_events(-recordings::kTimeLimitUs, recordings::kTimeLimitUs);
  recordings::EventBatch batch;
  for (bool more = true; more;) {
    E2LF_ASSIGN_OR_RETURN(more, reader->read(batch));
  }
  return reader->summary();
}

/// Returns millions of events per second of the fastest run. All runs must give the same number of events, or nearly
/// none if they skip.
Result<double> measure(const DecodeBench& options, const BenchmarkStream& stream, uint64_t events, int threads,
                       bool skips = false) {
  double best_s = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int run = 0; run < 2 || seconds_since(begin) < options.seconds; ++run) {
    const double start_s = clock_s(threads);
    E2LF_ASSIGN_OR_RETURN(const recordings::DecodeSummary summary, decode_to_columns(stream, threads, skips));
    const double run_s = clock_s(threads) - start_s;
    if (skips && summary.events() > events / 2) return 0.0;
    if (!skips && summary.events() != events) {
      return Error{ErrorCode::kInvalidValue, cat("a run gave ", summary.events(), " events instead of ", events), ""};
    }
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
  }
  return static_cast<double>(events) * 1e-6 / best_s;
}

/// Runs `work` with the scalar kernels.
template <typename Work>
auto with_scalar_kernels(const Work& work) -> decltype(work()) {
  const std::string isa = current_isa();
  E2LF_RETURN_IF_ERROR(set_max_isa("scalar"));
  auto result = work();
  E2LF_RETURN_IF_ERROR(set_max_isa(isa));
  return result;
}

/// Measures a stream: millions of events per second that are decoded to columns in batches of the default size, in the
/// fastest run, or passed over by one thread that skips all events, as between the patterns that count in a live
/// source. A single thread is measured by its processor time.
Result<Json> measure_stream(const DecodeBench& options, const BenchmarkStream& stream) {
  const auto decode_once = [&] { return decode_to_columns(stream, 1); };
  E2LF_ASSIGN_OR_RETURN(const recordings::DecodeSummary known, with_scalar_kernels(decode_once));
  const uint64_t events = known.events();
  E2LF_ASSIGN_OR_RETURN(const double one_thread, measure(options, stream, events, 1));
  E2LF_ASSIGN_OR_RETURN(const double all_threads, measure(options, stream, events, 0));
  E2LF_ASSIGN_OR_RETURN(const double skipping, measure(options, stream, events, 1, true));
  Json row = {{"shape", stream.shape},
              {"source", stream.source},
              {"events", events},
              {"bytes_per_event",
               static_cast<double>(stream.bytes.size()) / static_cast<double>(std::max<uint64_t>(events, 1))},
              {"one_thread", {{"columns", one_thread}}},
              {"all_threads", {{"columns", all_threads}}}};
  if (skipping > 0) row["skipping"] = {{"events", skipping}, {"ratio_to_one_thread", skipping / one_thread}};
  if (options.with_reference) {
    const auto measure_reference = [&] { return measure(options, stream, events, 1); };
    E2LF_ASSIGN_OR_RETURN(const double reference, with_scalar_kernels(measure_reference));
    row["reference"]["columns"] = reference;
    row["one_thread"]["columns_ratio"] = one_thread / reference;
    row["all_threads"]["columns_ratio"] = all_threads / reference;
  }
  return row;
}

struct Found {
  fs::path path;
  double bytes_per_event = 0;
};

/// Returns the recordings of a folder by encoding, in ascending order of bytes per event.
Result<std::map<std::string, std::vector<Found>>> find_recordings(const fs::path& folder) {
  std::map<std::string, std::vector<Found>> found;
  std::error_code status;
  for (fs::directory_iterator entry(folder, status), end; !status && entry != end; entry.increment(status)) {
    if (entry->path().extension() != ".raw") continue;
    const auto once = repeat_recording(entry->path(), 1);
    if (!once) continue;
    E2LF_ASSIGN_OR_RETURN(const recordings::DecodeSummary summary, decode_to_columns(*once, 1));
    if (summary.events() == 0) continue;
    const double bytes_per_event = static_cast<double>(once->bytes.size()) / static_cast<double>(summary.events());
    found[once->shape].push_back({entry->path(), bytes_per_event});
  }
  if (status)
    return Error{ErrorCode::kIo, cat("cannot list the folder (", status.message(), "); check the path"),
                 folder.string()};
  if (found.empty()) {
    return Error{ErrorCode::kNotFound, "no RAW recording in the folder; omit it to measure synthesised streams",
                 folder.string()};
  }
  for (auto& [format, files] : found) {
    std::sort(files.begin(), files.end(), [](const Found& a, const Found& b) {
      return a.bytes_per_event != b.bytes_per_event ? a.bytes_per_event < b.bytes_per_event : a.path < b.path;
    });
  }
  return found;
}

/// Returns the recording with this shape, or an empty path if there is none.
fs::path recording_of(StreamShape shape, const std::map<std::string, std::vector<Found>>& found) {
  const auto files = found.find(shape == StreamShape::kEvt2 ? "evt2" : "evt3");
  if (files == found.end() || shape == StreamShape::kEvt3Vector || shape == StreamShape::kEvt21) return {};
  constexpr double kManyBytes = 5;
  const Found& densest = files->second.front();
  const Found& sparsest = files->second.back();
  if (shape == StreamShape::kEvt3Sparse) return sparsest.bytes_per_event > kManyBytes ? sparsest.path : fs::path();
  return densest.bytes_per_event < kManyBytes ? densest.path : fs::path();
}

/// Measures decoding for each stream shape. In a folder, "evt3 dense" and "evt3 sparse" use the EVT3
/// recordings with the fewest and the most bytes per event, and "evt2" an EVT2 one; missing shapes are synthesised. A
/// single file gives one row. Fails as reading the files does, and with kNotFound for a folder without RAW files.
Result<Json> measure_all(const DecodeBench& options, const ProgressFn& progress) {
  std::error_code status;
  Json rows = Json::array();
  if (fs::is_regular_file(options.input, status)) {
    E2LF_ASSIGN_OR_RETURN(const BenchmarkStream stream, repeat_recording(options.input, options.events));
    E2LF_ASSIGN_OR_RETURN(rows.emplace_back(), measure_stream(options, stream));
    return rows;
  }
  std::map<std::string, std::vector<Found>> found;
  if (!options.input.empty()) {
    E2LF_ASSIGN_OR_RETURN(found, find_recordings(options.input));
  }
  for (const StreamShape shape : kStreamShapes) {
    const fs::path path = recording_of(shape, found);
    BenchmarkStream stream;
    if (path.empty()) {
      stream = synthesise_stream(shape, options.events);
    } else {
      E2LF_ASSIGN_OR_RETURN(stream, repeat_recording(path, options.events));
      stream.shape = shape_name(shape);
    }
    E2LF_ASSIGN_OR_RETURN(rows.emplace_back(), measure_stream(options, stream));
    progress(rows.size(), std::size(kStreamShapes));
  }
  return rows;
}

/// Returns the speed, in millions of events per second, at which a RAW file becomes a finished file, with all threads:
/// the fastest of two conversions.
Result<double> measure_conversion(const fs::path& recording, const fs::path& output) {
  constexpr int kRuns = 2;
  double best_s = 0, events = 0;
  for (int run = 0; run < kRuns; ++run) {
    recordings::ConvertReport report;
    const auto convert = [&]() -> Result<void> {
      recordings::OpenOptions open;
      open.threads = 0;
      E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_recording(recording, open));
      E2LF_ASSIGN_OR_RETURN(report, recordings::convert_recording(*reader, output));
      return {};
    };
    E2LF_ASSIGN_OR_RETURN(const double run_s, seconds_of(convert));
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
    events = static_cast<double>(report.events);
    fs::remove(output);
    if (!report.trigger_file.empty()) fs::remove(output.parent_path() / report.trigger_file);
  }
  return events * 1e-6 / best_s;
}

/// Measures the conversion of a RAW file, the given one or a synthesised stream, to CSV and to Metavision HDF5. The
/// files are written in a folder and removed again.
Result<Json> measure_conversions(const fs::path& in, const DecodeBench& options) {
  std::error_code status;
  BenchmarkStream stream;
  if (fs::is_regular_file(options.input, status)) {
    E2LF_ASSIGN_OR_RETURN(stream, repeat_recording(options.input, options.events));
  } else {
    stream = synthesise_stream(StreamShape::kEvt3Dense, options.events);
  }
  E2LF_ASSIGN_OR_RETURN(const ResultFolder folder, ResultFolder::create(in / "e2lf_bench_convert", false));
  const fs::path recording = folder.path() / "recording.raw";
  E2LF_RETURN_IF_ERROR(write_file(recording, stream.bytes));
  Json rates;
  for (const char* format : {"csv", "hdf5"}) {
    E2LF_ASSIGN_OR_RETURN(rates[format], measure_conversion(recording, folder.path() / cat("out.", format)));
  }
  return rates;
}

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

Json published_json() {
  Json json;
  for (const PublishedRates& published : kPublished) {
    Json entry = {{"decoder", published.decoder}};
    for (size_t i = 0; i < std::size(kShapes); ++i) {
      if (published.rates[i] != 0) entry[kShapes[i]] = published.rates[i];
    }
    json.push_back(std::move(entry));
  }
  return json;
}

BenchReport decode_report(const Json& json, const std::string& folder) {
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
  for (const Json& row : json["streams"]) {
    const Json &one = row["one_thread"], &all = row["all_threads"], skipping = row.value("skipping", Json::object());
    table.rows.push_back(
        {report::text_cell(row["shape"].get<std::string>()), report::text_cell(row["source"].get<std::string>()),
         number_of(row, "events", 1, 1e-6), number_of(row, "bytes_per_event", 2), number_of(one, "columns", 0),
         number_of(one, "columns_ratio", 1), number_of(all, "columns", 0), number_of(all, "columns_ratio", 1),
         number_of(skipping, "events", 0), number_of(skipping, "ratio_to_one_thread", 1),
         number_of(row.value("reference", Json::object()), "columns", 0)});
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
  const Json conversions = json.value("convert", Json::object());
  for (const auto& [format, rate] : conversions.items()) {
    found.note += cat(found.note.empty() ? "" : "\n", "RAW file to ", format, " in ", folder, ": ",
                      std::lround(rate.get<double>()), " M events/s");
  }
  return found;
}

}  // namespace

int run_decode(const std::vector<std::string>& arguments) {
  Verb verb("decode",
            "Measure the decoding of RAW recordings from memory, to columns, against the "
            "scalar reference in the same run.",
            "e2lf-bench decode RECORDINGS_DIR --json");
  DecodeBench options;
  bool without_reference = false;
  fs::path convert_folder;
  verb.app().add_option("input,-i,--input", options.input,
                        "RAW recording or folder of them, repeated to the wanted length; default: synthesised streams");
  verb.app().add_option("--events", options.events, "length of each stream")->capture_default_str();
  verb.app().add_option("--seconds", options.seconds, "time for each measurement")->capture_default_str();
  verb.app().add_flag("--no-reference", without_reference, "leave the scalar reference out");
  verb.app().add_option("--convert", convert_folder,
                        "measure the conversion of a dense EVT3 file, or the given one, in this folder too");
  const auto work = [&]() -> Result<Json> {
    options.with_reference = !without_reference;
    ProgressBar bar("bench", verb.common().quiet);
    Json json = {{"unit", "million events per second"}, {"threads", num_threads()}, {"isa", current_isa()}};
    E2LF_ASSIGN_OR_RETURN(json["streams"], measure_all(options, bar.callback()));
    json["published_on_another_machine"] = published_json();
    if (!convert_folder.empty()) {
      E2LF_ASSIGN_OR_RETURN(json["convert"], measure_conversions(convert_folder, options));
    }
    return json;
  };
  const auto describe = [&](const Json& json) { return decode_report(json, convert_folder.string()); };
  return run_bench(verb, arguments, work, describe, [&] { return std::vector{options.input}; });
}

}  // namespace e2lf::bench
