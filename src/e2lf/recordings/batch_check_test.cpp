// SPDX-License-Identifier: MIT
#include "e2lf/recordings/batch_check.h"

#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

bool is_taken(const EventBatch& batch) {
  BatchCheck check(640, 480, "test");
  return check(batch).ok();
}

TEST(BatchCheck, FindsOneBadValueWhereverItIs) {
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa));
    for (const size_t count : {1, 2, 63, 64, 65, 150}) {
      RandomStream options = {.events = count};
      EventBatch batch = random_stream(options);
      batch.events.x[0] = 639;
      batch.events.y[0] = 479;
      ASSERT_TRUE(is_taken(batch)) << isa << " " << count;
      for (size_t i = 0; i < count; ++i) {
        EventBatch bad = batch;
        bad.events.x[i] = 640;
        ASSERT_FALSE(is_taken(bad)) << isa << " x of " << i;
        bad = batch;
        bad.events.y[i] = 65535;
        ASSERT_FALSE(is_taken(bad)) << isa << " y of " << i;
        bad = batch;
        bad.events.p[i] = 2;
        ASSERT_FALSE(is_taken(bad)) << isa << " p of " << i;
        bad = batch;
        bad.events.t[i] = INT64_MIN;
        ASSERT_EQ(is_taken(bad), i == 0) << isa << " t of " << i;
      }
    }
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST(BatchCheck, TimeMayNotRunBackBetweenBatches) {
  BatchCheck check(0, 0, "test");
  EventBatch batch;
  batch.events.push_back({65535, 65535, 1, 5});
  ASSERT_TRUE(check(batch));
  batch.events.t[0] = 4;
  EXPECT_EQ(check(batch).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::recordings
