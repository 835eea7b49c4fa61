// SPDX-License-Identifier: MIT
#include "e2lf/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf {
namespace {

using testing::StartsWith;

TEST(Text, JoinsAndDescribesShapes) {
  EXPECT_EQ(cat("view ", 3, " of ", 1.5), "view 3 of 1.5");
  EXPECT_EQ(join({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(join({"a", "b"}, "/"), "a/b");
  EXPECT_EQ(join({}), "");
  EXPECT_EQ(shape_text({3, 720, 1280}), "[3, 720, 1280]");
  EXPECT_EQ(shape_text({}), "[]");
}

TEST(Text, JoinKeepsEmptyParts) {
  EXPECT_EQ(join({"", "b", ""}), ", b, ");
}

TEST(Suggestion, IsTheWordThatATypingMistakeMissed) {
  const std::vector<std::string> words = {"batch", "steps", "rate"};
  EXPECT_EQ(suggestion("bacth", words), "did you mean \"batch\"?");
  EXPECT_EQ(suggestion("step", words), "did you mean \"steps\"?");
  EXPECT_EQ(suggestion("--step", {"--steps"}, ""), "did you mean --steps?");
  EXPECT_EQ(suggestion("recon", {"demo", "reconstruct", "resume"}), "did you mean \"reconstruct\"?");
}

TEST(Suggestion, NamesAllWhereNoneIsNear) {
  EXPECT_EQ(suggestion("learning_rate", {"batch", "steps"}), "known are batch, steps");
  EXPECT_EQ(suggestion("", {"batch", "steps"}), "known are batch, steps");
  EXPECT_EQ(suggestion("x", {}), "there are none");
  const std::string many = suggestion("learning", std::vector<std::string>(20, "steps"));
  EXPECT_TRUE(many.ends_with("steps, ...")) << many;
}

}  // namespace
}  // namespace e2lf
