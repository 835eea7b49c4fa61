// SPDX-License-Identifier: MIT
#include "e2lf/base/progress.h"

#include <atomic>
#include <csignal>

namespace e2lf {
namespace {

std::atomic<int> g_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "the handler of a signal sets it");

void on_signal(int signal) {
  g_signal = signal;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

bool stop_requested() {
  return g_signal != 0;
}

int stop_signal() {
  return g_signal;
}

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;  // without SA_RESTART, so that a blocked read returns
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

void request_stop(int signal) {
  g_signal = signal;
}

}  // namespace e2lf
