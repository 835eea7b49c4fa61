// SPDX-License-Identifier: MIT
#include "e2lf/base/threads.h"

#include <atomic>
#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {
namespace {

class Threads : public testing::Test {
 protected:
  void TearDown() override { set_num_threads(0); }
};

TEST_F(Threads, NumberIsWhatWasSetAndZeroMeansAll) {
  set_num_threads(3);
  EXPECT_EQ(num_threads(), 3);
  set_num_threads(0);
  EXPECT_GE(num_threads(), 1);
  EXPECT_THROW(set_num_threads(-1), ContractError);
}

TEST_F(Threads, ParallelForCoversEveryItemOnceInChunksOfTheMinimum) {
  for (const int threads : {1, 2, 5}) {
    set_num_threads(threads);
    for (const size_t count : {0, 1, 7, 63, 1000}) {
      for (const size_t min_chunk : {0, 1, 10, 5000}) {
        std::vector<std::atomic<int>> visits(count);
        parallel_for(count, min_chunk, [&](size_t begin, size_t end) {
          ASSERT_LT(begin, end);
          ASSERT_LE(end, count);
          if (end < count) {
            EXPECT_GE(end - begin, min_chunk);
          }
          for (size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (const auto& visit : visits) ASSERT_EQ(visit, 1);
      }
    }
  }
}

TEST_F(Threads, ParallelForUsesSeveralThreads) {
  set_num_threads(2);
  // Two chunks that wait for each other can only end when they run at the same time.
  std::atomic<int> arrived = 0;
  parallel_for(2, 1, [&](size_t, size_t) {
    ++arrived;
    while (arrived < 2) {
    }
  });
  EXPECT_EQ(arrived, 2);
}

TEST_F(Threads, ParallelForRethrowsAnExceptionOfTheBody) {
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    EXPECT_THROW(parallel_for(100, 1,
                              [](size_t begin, size_t end) {
                                if (begin <= 42 && 42 < end) throw std::runtime_error("42");
                              }),
                 std::runtime_error);
  }
}

TEST_F(Threads, AnExceptionOfTheBodyDoesNotOutliveItsHandler) {
  set_num_threads(2);
  const auto content = std::make_shared<int>(42);
  EXPECT_THROW(parallel_for(100, 1, [&](size_t, size_t) { throw content; }), std::shared_ptr<int>);
  EXPECT_EQ(content.use_count(), 1);
}

}  // namespace
}  // namespace e2lf
