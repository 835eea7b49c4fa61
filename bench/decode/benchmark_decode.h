// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"

namespace e2lf::bench {

struct DecodeBenchmarkOptions {
  /// A RAW recording, or a folder of them, which are repeated to make streams. If it is empty, all streams are
  /// synthesised.
  std::filesystem::path input = {};
  uint64_t events = 50'000'000;  ///< approximate number in each stream
  double seconds = 1.0;          ///< for each measurement, which consists of at least two runs
  bool with_reference = true;    ///< measures the scalar reference as well
};

struct DecodeBenchmarkRow {
  std::string shape;   ///< "evt3 dense"
  std::string source;  ///< the source of the stream
  uint64_t events = 0;
  double bytes_per_event = 0;
  /// Millions of events per second decoded to columns in batches of the default size, for the fastest run. A single
  /// thread is measured by its processor time.
  double one_thread = 0, all_threads = 0;
  /// The same for one thread that skips all events, as between the patterns that count in a live source: millions of
  /// events per second that were passed over. 0 = the encoding cannot leave them out.
  double skipping = 0;
  double reference = 0;  ///< the scalar reference on one thread, in the same run; 0 = not measured
};

/// Measures decoding from memory for each stream shape. In a folder, "evt3 dense" and "evt3 sparse" use the EVT3
/// recordings with the fewest and the most bytes per event, and "evt2" an EVT2 one; missing shapes are synthesised. A
/// single file gives one row. Fails as reading the files does, and with kNotFound for a folder without RAW files.
[[nodiscard]] Result<std::vector<DecodeBenchmarkRow>> benchmark_decoding(const DecodeBenchmarkOptions& options,
                                                                         const ProgressFn& progress = {});

struct ConvertBenchmarkOptions {
  std::filesystem::path folder;      ///< in which files are written and removed again
  std::filesystem::path input = {};  ///< RAW recording to repeat; empty = a synthesised stream, "evt3 dense"
  uint64_t events = 20'000'000;      ///< approximate number
  int runs = 2;                      ///< of each conversion; the fastest one counts
};

struct ConvertBenchmarkRow {
  std::string format;
  uint64_t events = 0;
  double mevents_per_s = 0;  ///< from a RAW file to a finished file, with all threads
};

/// Measures the conversion of a RAW file to CSV and to Metavision HDF5. Fails as the conversion does.
[[nodiscard]] Result<std::vector<ConvertBenchmarkRow>> benchmark_conversion(const ConvertBenchmarkOptions& options);

}  // namespace e2lf::bench
