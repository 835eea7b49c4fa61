// SPDX-License-Identifier: MIT
#include "e2lf/files/mat5.h"

#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

TEST(MatFile, TellsFilesThatEndEarly) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a.mat", std::string("MATLAB 5.0 MAT-file")).ok());
  EXPECT_EQ(mat_variables(folder / "a.mat").error().code, ErrorCode::kTruncated);
  EXPECT_EQ(mat_variables(folder / "none.mat").error().code, ErrorCode::kTruncated);
}

}  // namespace
}  // namespace e2lf
