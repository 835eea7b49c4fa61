// SPDX-License-Identifier: MIT
#include "e2lf/eval/best_gain.h"

#include <gtest/gtest.h>
#include <vector>

namespace e2lf::eval {
namespace {

using lightfield::LightField;

TEST(BestGain, UndoesAFactor) {
  const LightField truth({1, 1, 1, 3}, std::vector{0.25F, 0.5F, 1.0F});
  const LightField half({1, 1, 1, 3}, std::vector{0.125F, 0.25F, 0.5F});
  EXPECT_FLOAT_EQ(best_gain(truth, half), 2.0F);
}

TEST(BestGain, IsTheProjection) {
  const LightField truth({1, 1, 1, 2}, std::vector{1.0F, 0.0F});
  const LightField field({1, 1, 1, 2}, std::vector{1.0F, 1.0F});
  EXPECT_FLOAT_EQ(best_gain(truth, field), 0.5F);
}

TEST(BestGain, OfBlackIsZero) {
  const LightField truth({1, 1, 1, 2}, std::vector{1.0F, 0.5F});
  EXPECT_EQ(best_gain(truth, LightField({1, 1, 1, 2})), 0.0F);
}

}  // namespace
}  // namespace e2lf::eval
