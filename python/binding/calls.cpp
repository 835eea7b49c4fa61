// SPDX-License-Identifier: MIT
#include "python/binding/calls.h"

#include <chrono>
#include <csignal>
#include <mutex>
#include <string>

#include "e2lf/base/stop.h"

namespace e2lf::python {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kLeastPause = std::chrono::milliseconds(100);

/// The signal handler that Python had installed, and the number of waits that have replaced it.
struct sigaction g_before {};
std::mutex g_mutex;
int g_waits = 0;

void on_interrupt(int signal, siginfo_t* info, void* context) {
  request_stop(signal);
  if ((g_before.sa_flags & SA_SIGINFO) != 0) return g_before.sa_sigaction(signal, info, context);
  if (g_before.sa_handler != SIG_DFL && g_before.sa_handler != SIG_IGN) g_before.sa_handler(signal);
}

}  // namespace

ProgressFn progress_of(const ProgressArgument& progress) {
  return [progress, last = Clock::now() - kLeastPause](size_t done, size_t total) mutable {
    const auto now = Clock::now();
    if (now - last < kLeastPause && done != total) return;
    last = now;
    const py::gil_scoped_acquire acquire;
    check_signals();
    if (progress) (*progress)(done, total);
  };
}

OneAtATime::Use::Use(OneAtATime& object, const char* what) : object_(object) {
  if (!object.is_used_.exchange(true)) return;
  throw std::runtime_error(std::string("this ") + what + " is at work in another call; open one for each thread");
}

StopOnInterrupt::StopOnInterrupt(bool is_live) : is_installed_(is_live) {
  if (!is_live) return;
  const std::lock_guard lock(g_mutex);
  if (g_waits++ > 0) return;
  struct sigaction action {};
  action.sa_sigaction = on_interrupt;
  action.sa_flags = SA_SIGINFO;  // without SA_RESTART, so that a blocking read returns
  ::sigaction(SIGINT, &action, &g_before);
}

StopOnInterrupt::~StopOnInterrupt() {
  if (!is_installed_) return;
  const std::lock_guard lock(g_mutex);
  if (--g_waits > 0) return;
  ::sigaction(SIGINT, &g_before, nullptr);
  request_stop(0);
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace e2lf::python
