// SPDX-License-Identifier: MIT
#include "e2lf/base/threads.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"

#ifdef _OPENMP
#include <omp.h>
#else
#include <cstdlib>
#include <sched.h>
#endif

namespace e2lf {

#ifndef _OPENMP
namespace {

// Builds without OpenMP, such as the wheel for other distributions, count as it does.

int omp_get_num_procs() {
  cpu_set_t cpus;
  if (::sched_getaffinity(0, sizeof(cpus), &cpus) != 0) return 1;
  return CPU_COUNT(&cpus);
}

std::atomic<int>& threads_in_use() {
  static std::atomic<int> threads = [] {
    const char* const wanted = std::getenv("OMP_NUM_THREADS");
    const int number = wanted == nullptr ? 0 : std::atoi(wanted);
    return number > 0 ? number : omp_get_num_procs();
  }();
  return threads;
}

int omp_get_max_threads() {
  return threads_in_use();
}

void omp_set_num_threads(int threads) {
  threads_in_use() = threads;
}

}  // namespace
#endif

int num_threads() {
  return omp_get_max_threads();
}

void set_num_threads(int threads) {
  E2LF_REQUIRE(threads >= 0, "the number of threads cannot be negative");
  omp_set_num_threads(threads == 0 ? omp_get_num_procs() : threads);
}

void parallel_for(size_t count, size_t min_chunk, const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  min_chunk = std::max<size_t>(min_chunk, 1);
  const size_t threads = std::clamp<size_t>(count / min_chunk, 1, static_cast<size_t>(num_threads()));
  if (threads == 1) return body(0, count);
  // Each thread gets several chunks, so that one slow chunk does not delay the rest.
  const size_t chunk = std::max(min_chunk, (count + threads * 4 - 1) / (threads * 4));
  const size_t chunks = (count + chunk - 1) / chunk;
  std::atomic<size_t> next = 0;
  run_team(threads, [&](size_t /*member*/) {
    for (size_t i = next++; i < chunks; i = next++) body(i * chunk, std::min(count, (i + 1) * chunk));
  });
}

namespace {

// The number of polls before a thread sleeps. They take about 30 us on a free core, which is longer than the pause
// between two rounds of the engine. Each poll yields the core to any thread that wants it.
constexpr int kSpins = 100;

// The state that the threads share, packed into one number: the number of the run, whether helpers may still begin, and
// how many of them take part.
constexpr uint32_t kMembers = 0xFF, kOpen = 0x100, kRun = 0x200, kEnd = 0;
constexpr size_t kMostHelpers = kMembers;

thread_local bool g_is_member = false;

/// Waits until the state differs from `seen`.
void wait_for_change(const std::atomic<uint32_t>& state, uint32_t seen) {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (state.load(std::memory_order_acquire) != seen) return;
    std::this_thread::yield();
  }
  state.wait(seen, std::memory_order_acquire);
}

/// The helpers of one thread.
class Team {
 public:
  Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() {
    if (!is_of_this_process()) {
      static_cast<void>(helpers_.release());  // these threads belong to the process that this one was forked from
      return;
    }
    state_ = kEnd;
    state_.notify_all();
    for (std::thread& helper : *helpers_) helper.join();
  }

  [[nodiscard]] bool is_of_this_process() const { return owner_ == ::getpid(); }

  void run(size_t threads, const std::function<void(size_t)>& body) {
    body_ = &body;
    failure_ = nullptr;
    wanted_ = std::min(threads - 1, kMostHelpers);
    add_helpers();
    const uint32_t run = ((state_ & ~(kMembers | kOpen)) + kRun) | kOpen;
    state_.store(run == kOpen ? run + kRun : run, std::memory_order_release);  // never kEnd
    state_.notify_all();
    call(0);
    for (uint32_t now = state_.fetch_and(~kOpen, std::memory_order_acq_rel) & ~kOpen; (now & kMembers) != 0;
         now = state_.load(std::memory_order_acquire)) {
      wait_for_change(state_, now);
    }
    // An exception may belong to an interpreter, which ends before this thread and its team.
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  /// Starts the missing helpers, or fewer if the system cannot provide as many threads.
  void add_helpers() {
    try {
      while (helpers_->size() < wanted_) {
        helpers_->emplace_back([this, member = helpers_->size() + 1] { help(member); });
      }
    } catch (const std::system_error&) {
    }
  }

  void help(size_t member) {
    g_is_member = true;
    uint32_t done = kRun;  // the last run that this helper took part in, or one before it was started
    for (uint32_t now = state_.load(std::memory_order_acquire); now != kEnd;
         now = state_.load(std::memory_order_acquire)) {
      const uint32_t run = now & ~(kMembers | kOpen);
      if ((now & kOpen) == 0 || run == done || member > wanted_) {
        wait_for_change(state_, now);
      } else if (state_.compare_exchange_weak(now, now + 1, std::memory_order_acq_rel)) {
        call(member);
        done = run;
        const uint32_t left = state_.fetch_sub(1, std::memory_order_acq_rel) - 1;
        if ((left & (kMembers | kOpen)) == 0) state_.notify_all();
      }
    }
  }

  void call(size_t member) {
    const bool was_member = std::exchange(g_is_member, true);
    try {
      (*body_)(member);
    } catch (...) {
      const std::lock_guard lock(failing_);
      failure_ = std::current_exception();
    }
    g_is_member = was_member;
  }

  pid_t owner_ = ::getpid();
  std::atomic<uint32_t> state_ = kRun;  // closed; kEnd is set only by the destructor
  std::atomic<size_t> wanted_ = 0;      // changes only while no helper may begin
  const std::function<void(size_t)>* body_ = nullptr;
  std::mutex failing_;
  std::exception_ptr failure_;
  std::unique_ptr<std::vector<std::thread>> helpers_ = std::make_unique<std::vector<std::thread>>();
};

}  // namespace

void run_team(size_t threads, const std::function<void(size_t)>& body) {
  E2LF_REQUIRE(threads > 0, "a team has at least one thread");
  if (threads == 1 || g_is_member) return body(0);
  thread_local std::unique_ptr<Team> team;
  if (team == nullptr || !team->is_of_this_process()) team = std::make_unique<Team>();
  team->run(threads, body);
}

}  // namespace e2lf
