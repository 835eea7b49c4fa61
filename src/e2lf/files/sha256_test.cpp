// SPDX-License-Identifier: MIT
#include "e2lf/files/sha256.h"

#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

// FIPS 180-2, appendix B.1.
TEST(Sha256, IsThatOfTheStandard) {
  const std::string expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(sha256_of_text("abc"), expected);
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a", std::string("abc")));
  EXPECT_EQ(sha256_of(folder / "a").value(), expected);
}

TEST(Sha256, OfAFolderDependsOnTheFilesInItsSubfolders) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "in/a", std::string("abc")));
  ASSERT_TRUE(write_file(folder / "in/deeper/b", std::string("def")));
  const std::string before = sha256_of(folder / "in").value();
  EXPECT_EQ(before, sha256_of_text(sha256_of_text("abc") + "  a\n" + sha256_of_text("def") + "  deeper/b\n"));
  ASSERT_TRUE(write_file(folder / "in/deeper/b", std::string("deg")));
  EXPECT_NE(sha256_of(folder / "in").value(), before);
}

}  // namespace
}  // namespace e2lf
