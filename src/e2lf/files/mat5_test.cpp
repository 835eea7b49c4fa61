// SPDX-License-Identifier: MIT
#include "e2lf/files/mat5.h"

#include <gtest/gtest.h>

namespace e2lf {
namespace {

TEST(MatFile, TellsFilesThatEndEarly) {
  const std::string text = "MATLAB 5.0 MAT-file";
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  std::vector<std::string> others;
  EXPECT_EQ(find_mat_array(bytes, "LF", 1000, "a.mat", others).error().code, ErrorCode::kTruncated);
  EXPECT_EQ(find_mat_array({}, "LF", 1000, "none.mat", others).error().code, ErrorCode::kTruncated);
}

}  // namespace
}  // namespace e2lf
