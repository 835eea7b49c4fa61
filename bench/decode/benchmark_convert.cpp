// SPDX-License-Identifier: MIT
#include "bench/decode/benchmark_convert.h"

#include <algorithm>
#include <chrono>

#include "bench/decode/benchmark_streams.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/recordings/convert.h"

namespace e2lf::bench {
namespace {

namespace fs = std::filesystem;
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
