// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/live_log.h"

#include <algorithm>
#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/cycle_options.h"

namespace e2lf::cli {
namespace {

std::string ms_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f ms", 1e3 * seconds);
  return text;
}

}  // namespace

void LiveLog::add(uint64_t cycle, uint64_t events, double latency_s) {
  ++cycles_;
  events_ += events;
  sum_s_ += latency_s;
  most_s_ = std::max(most_s_, latency_s);
  log_info(cat("cycle ", cycle, ": ", events, " events, latency ", ms_text(latency_s)));
}

void LiveLog::finish(const cycles::CycleReport& report) const {
  if (cycles_ == 0) return;
  log_info(cat("live input ended: ", report_text(report), "; ", events_, " events; latency ",
               ms_text(sum_s_ / static_cast<double>(cycles_)), " on average, ", ms_text(most_s_), " at most"));
}

}  // namespace e2lf::cli
