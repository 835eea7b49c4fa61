// SPDX-License-Identifier: MIT
#include "e2lf/base/memory.h"

#include <gtest/gtest.h>
#include <limits>

namespace e2lf {
namespace {

TEST(Memory, SomeIsAvailableAndNotMoreThanAnyMachineHas) {
  EXPECT_GT(available_memory_bytes(), uint64_t{1} << 20);
  EXPECT_LT(available_memory_bytes(), uint64_t{1} << 50);
}

TEST(Memory, AsksForNoMoreThanThereIs) {
  EXPECT_TRUE(require_memory(1, "use less", "a.npz"));
  const auto refused = require_memory(std::numeric_limits<uint64_t>::max() / 16, "use less", "a.npz");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(refused.error().location, "a.npz");
  EXPECT_NE(refused.error().message.find("use less"), std::string::npos);
  EXPECT_NE(refused.error().message.find(" GiB"), std::string::npos);
}

}  // namespace
}  // namespace e2lf
