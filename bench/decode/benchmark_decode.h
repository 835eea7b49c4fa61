// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"

namespace e2lf::bench {

struct DecodeBenchmarkOptions {
  /// A RAW recording, or a folder of them: streams are made by repeating these. Empty: all streams are synthesised.
  std::filesystem::path input = {};
  uint64_t events = 50'000'000;  ///< of each stream, about
  double seconds = 1.0;          ///< for each measurement, which runs at least twice
  bool with_reference = true;    ///< measure the scalar reference too
};

struct DecodeBenchmarkRow {
  std::string shape;   ///< "evt3 dense"
  std::string source;  ///< what the stream was made of
  uint64_t events = 0;
  double bytes_per_event = 0;
  /// Millions of events per second to columns, in batches of the default size: the fastest run. One thread is measured
  /// by its processor time.
  double one_thread = 0, all_threads = 0;
  double reference = 0;  ///< the scalar reference on one thread, in the same run; 0 = not measured
};

/// Measures decoding from memory, shape by shape. A folder gives "evt3 dense" and "evt3 sparse" from its EVT3
/// recordings with the fewest and the most bytes per event, and "evt2" from an EVT2 one; what it does not have is
/// synthesised. One file gives one row. Fails as reading the files does, and with kNotFound for a folder without RAW
/// files.
[[nodiscard]] Result<std::vector<DecodeBenchmarkRow>> benchmark_decoding(const DecodeBenchmarkOptions& options,
                                                                         const ProgressFn& progress = {});

}  // namespace e2lf::bench
