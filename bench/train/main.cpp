// SPDX-License-Identifier: MIT
// e2lf-bench-train BATCH STEPS: the program that `e2lf-bench train` starts, so that only it needs torch. Prints JSON.
#include <ATen/Parallel.h>
#include <cstdio>
#include <cstdlib>

#include "bench/train/benchmark.h"
#include "e2lf/files/options.h"
#include "e2lf/learn/run/torch_setup.h"
#include "e2lf/terminal/progress_bar.h"

int main(int argc, char** argv) {
  const uint64_t batch = argc == 3 ? std::strtoull(argv[1], nullptr, 10) : 0;
  const uint64_t steps = argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 0;
  if (batch == 0 || steps == 0) {
    std::fputs("usage: e2lf-bench-train BATCH STEPS\n", stderr);
    return 2;
  }
  e2lf::ProgressBar bar("bench", false);
  const auto json = e2lf::learn::guarded("e2lf-bench-train", [&]() -> e2lf::Result<e2lf::Json> {
    E2LF_ASSIGN_OR_RETURN(const auto rows,
                          e2lf::learn::benchmark_training({.batch = batch, .steps = steps}, bar.callback()));
    e2lf::Json result = {{"batch", batch}, {"threads", at::get_num_threads()}, {"rows", e2lf::Json::array()}};
    for (const e2lf::learn::BenchmarkRow& row : rows) {
      result["rows"].push_back({{"job", row.job},
                                {"name", row.name},
                                {"precision", row.precision},
                                {"samples_per_s", row.samples_per_s},
                                {"ratio", row.ratio}});
    }
    return result;
  });
  e2lf::hide_progress();
  if (!json) {
    std::fprintf(stderr, "e2lf-bench-train: %s\n", json.error().text().c_str());
    return 1;
  }
  std::printf("%s", e2lf::json_text(*json).c_str());
  return 0;
}
