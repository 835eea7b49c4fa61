// SPDX-License-Identifier: MIT
#include "bench/decode/benchmark_decode.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <map>

#include "bench/decode/benchmark_streams.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/recordings/convert.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

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
Result<double> measure(const DecodeBenchmarkOptions& options, const BenchmarkStream& stream, uint64_t events,
                       int threads, bool skips = false) {
  double best_s = 0;
  const auto begin = Clock::now();
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

Result<DecodeBenchmarkRow> measure_stream(const DecodeBenchmarkOptions& options, const BenchmarkStream& stream) {
  DecodeBenchmarkRow row;
  row.shape = stream.shape;
  row.source = stream.source;
  const auto decode_once = [&] { return decode_to_columns(stream, 1); };
  E2LF_ASSIGN_OR_RETURN(const recordings::DecodeSummary known, with_scalar_kernels(decode_once));
  row.events = known.events();
  row.bytes_per_event =
      static_cast<double>(stream.bytes.size()) / static_cast<double>(std::max<uint64_t>(row.events, 1));
  E2LF_ASSIGN_OR_RETURN(row.one_thread, measure(options, stream, row.events, 1));
  E2LF_ASSIGN_OR_RETURN(row.all_threads, measure(options, stream, row.events, 0));
  E2LF_ASSIGN_OR_RETURN(row.skipping, measure(options, stream, row.events, 1, true));
  if (options.with_reference) {
    const auto reference = [&] { return measure(options, stream, row.events, 1); };
    E2LF_ASSIGN_OR_RETURN(row.reference, with_scalar_kernels(reference));
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

}  // namespace

Result<std::vector<DecodeBenchmarkRow>> benchmark_decoding(const DecodeBenchmarkOptions& options,
                                                           const ProgressFn& progress) {
  std::error_code status;
  std::vector<DecodeBenchmarkRow> rows;
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
    if (progress) progress(rows.size(), std::size(kStreamShapes));
  }
  return rows;
}

namespace {

using Clock = std::chrono::steady_clock;

Result<ConvertBenchmarkRow> measure(const fs::path& recording, const fs::path& output, int runs) {
  ConvertBenchmarkRow row;
  row.format = output.extension().string().substr(1);
  double best_s = 0;
  for (int run = 0; run < std::max(runs, 1); ++run) {
    const auto begin = Clock::now();
    recordings::OpenOptions open;
    open.threads = 0;
    E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_recording(recording, open));
    E2LF_ASSIGN_OR_RETURN(const recordings::ConvertReport report, recordings::convert_recording(*reader, output));
    const double run_s = std::chrono::duration<double>(Clock::now() - begin).count();
    best_s = run == 0 ? run_s : std::min(best_s, run_s);
    row.events = report.events;
    fs::remove(output);
    if (!report.trigger_file.empty()) fs::remove(output.parent_path() / report.trigger_file);
  }
  row.mevents_per_s = static_cast<double>(row.events) * 1e-6 / best_s;
  return row;
}

}  // namespace

Result<std::vector<ConvertBenchmarkRow>> benchmark_conversion(const ConvertBenchmarkOptions& options) {
  BenchmarkStream stream;
  if (options.input.empty()) {
    stream = synthesise_stream(StreamShape::kEvt3Dense, options.events);
  } else {
    E2LF_ASSIGN_OR_RETURN(stream, repeat_recording(options.input, options.events));
  }
  E2LF_ASSIGN_OR_RETURN(const ResultFolder folder, ResultFolder::create(options.folder / "e2lf_bench_convert", false));
  const fs::path recording = folder.path() / "recording.raw";
  E2LF_RETURN_IF_ERROR(write_file(recording, stream.bytes));
  std::vector<ConvertBenchmarkRow> rows;
  for (const char* name : {"out.csv", "out.hdf5"}) {
    E2LF_ASSIGN_OR_RETURN(rows.emplace_back(), measure(recording, folder.path() / name, options.runs));
  }
  return rows;
}

}  // namespace e2lf::bench
