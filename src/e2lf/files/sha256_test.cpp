// SPDX-License-Identifier: MIT
#include "e2lf/files/sha256.h"

#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

// The examples of FIPS 180-2, appendix B, and of the Secure Hash Standard Validation System (SHA256ShortMsg).
TEST(Sha256, IsThatOfTheStandard) {
  const std::vector<std::pair<std::string, std::string>> examples = {
      {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
      {"abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrst"
       "u",
       "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"},
      {std::string(1000000, 'a'), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"}};
  const TestFolder folder;
  for (const auto& [text, expected] : examples) {
    EXPECT_EQ(sha256_of_text(text), expected) << text.size();
    ASSERT_TRUE(write_file(folder / "a", text));
    EXPECT_EQ(sha256_of(folder / "a").value(), expected) << text.size();
  }
}

TEST(Sha256, IsTheSameWithTheInstructionsOfTheProcessor) {
  if (!sha256::has_sha_instructions()) GTEST_SKIP() << "this processor has none";
  std::vector<uint8_t> bytes(5 * sha256::kBlockBytes);
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(i * i + 3 * i);
  sha256::HashState scalar = sha256::kInitial, fast = sha256::kInitial;
  sha256::add_blocks_scalar(scalar, bytes.data(), 5);
  sha256::add_blocks_with_sha_instructions(fast, bytes.data(), 5);
  EXPECT_EQ(scalar, fast);
}

// The file is read in parts of a mebibyte.
TEST(Sha256, OfAFileLargerThanItsBufferIsThatOfItsBytes) {
  const TestFolder folder;
  const std::string text(3 * (size_t{1} << 20) + 77, 'b');
  ASSERT_TRUE(write_file(folder / "a", text));
  EXPECT_EQ(sha256_of(folder / "a").value(), sha256_of_text(text));
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
