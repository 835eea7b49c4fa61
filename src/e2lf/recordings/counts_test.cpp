// SPDX-License-Identifier: MIT
// The kernel that counts ON events, on every instruction set against a plain loop.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "e2lf/base/isa.h"
#include "e2lf/recordings/event.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kLengths[] = {0, 1, 15, 16, 63, 64, 65, 127, 128, 129, 1000, 100'003};

class Counts : public ::testing::Test {
 protected:
  void TearDown() override { set_max_isa("").value(); }
};

TEST_F(Counts, OnEventsAreCountedWhateverTheLength) {
  std::mt19937 random(1);
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa));
    for (const size_t length : kLengths) {
      std::vector<uint8_t> p(length);
      for (uint8_t& value : p) value = static_cast<uint8_t>(random() & 1);
      EXPECT_EQ(count_on(p), static_cast<uint64_t>(std::count(p.begin(), p.end(), 1))) << isa << " " << length;
      std::fill(p.begin(), p.end(), uint8_t{1});
      EXPECT_EQ(count_on(p), length) << isa;
    }
  }
}

}  // namespace
}  // namespace e2lf::recordings
