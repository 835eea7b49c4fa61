// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::bench {

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
