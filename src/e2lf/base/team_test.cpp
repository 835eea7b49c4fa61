// SPDX-License-Identifier: MIT
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf {
namespace {

/// The members that came; each waits until `least` are there.
std::vector<int> members_of_a_run(size_t threads, int least) {
  std::vector<std::atomic<int>> calls(threads);
  std::atomic<int> arrived = 0;
  run_team(threads, [&](size_t member) {
    ++calls.at(member);
    ++arrived;
    while (arrived < least) std::this_thread::yield();
  });
  return {calls.begin(), calls.end()};
}

TEST(Team, EveryMemberIsCalledOnceWhereAllWaitForAll) {
  for (const int threads : {1, 2, 5, 3}) {
    for (int run = 0; run < 200; ++run) {
      EXPECT_EQ(members_of_a_run(static_cast<size_t>(threads), threads), std::vector<int>(threads, 1)) << threads;
    }
  }
}

TEST(Team, WorkOfACounterIsDoneOnceInManyShortRuns) {
  std::vector<int> done(7);
  for (int run = 1; run <= 20'000; ++run) {
    std::atomic<size_t> next = 0;
    run_team(4, [&](size_t) {
      for (size_t i = next++; i < done.size(); i = next++) ++done[i];
    });
    ASSERT_EQ(done, std::vector<int>(7, run));
  }
}

TEST(Team, HelpersThatSleptComeAgain) {
  for (int run = 0; run < 5; ++run) {
    EXPECT_EQ(members_of_a_run(3, 3), std::vector<int>(3, 1));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(Team, AHelperWithoutACoreIsNotWaitedFor) {
  // Both on one core, and runs too short for the system to change threads in each.
  cpu_set_t all;
  ASSERT_EQ(::sched_getaffinity(0, sizeof all, &all), 0);
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
      if (CPU_ISSET(cpu, &all)) CPU_SET(cpu, &one);
    }
    ASSERT_EQ(::pthread_setaffinity_np(::pthread_self(), sizeof one, &one), 0);
    int helped = 0;
    for (int run = 0; run < 1000; ++run) {
      run_team(2, [&](size_t member) {
        if (member == 1) ++helped;
      });
    }
    EXPECT_LT(helped, 1000);
  }).join();
}

TEST(Team, AnExceptionOfAnyMemberIsRethrownAndTheNextRunIsWhole) {
  for (const size_t thrower : {size_t{0}, size_t{1}}) {
    std::atomic<int> arrived = 0;
    EXPECT_THROW(run_team(2,
                          [&](size_t member) {
                            ++arrived;
                            while (arrived < 2) std::this_thread::yield();
                            if (member == thrower) throw std::runtime_error("a member");
                          }),
                 std::runtime_error);
    EXPECT_EQ(members_of_a_run(2, 2), std::vector<int>(2, 1));
  }
  EXPECT_THROW(run_team(0, [](size_t) {}), ContractError);
}

TEST(Team, WithinAMemberARunIsAlone) {
  std::atomic<int> arrived = 0, inner = 0;
  run_team(2, [&](size_t) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
    run_team(2, [&](size_t member) {
      EXPECT_EQ(member, 0U);
      ++inner;
    });
  });
  EXPECT_EQ(inner, 2);
}

TEST(Team, ThreadsHaveTeamsOfTheirOwn) {
  std::vector<std::thread> callers;
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([] {
      for (int run = 0; run < 100; ++run) EXPECT_EQ(members_of_a_run(3, 3), std::vector<int>(3, 1));
    });
  }
  for (std::thread& caller : callers) caller.join();
}

TEST(Team, AForkedChildHasHelpersOfItsOwn) {
  members_of_a_run(3, 3);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(members_of_a_run(3, 3) == std::vector<int>(3, 1) ? 0 : 1);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace e2lf
