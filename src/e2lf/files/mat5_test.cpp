// SPDX-License-Identifier: MIT
#include "e2lf/files/mat5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/base/contract.h"
#include "e2lf/files/file.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

template <typename T>
std::span<const uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)};
}

TEST(MatFile, HasTheBytesOfTheFormat) {
  const std::vector<int16_t> values = {1, -2, 3};
  const MatVariable variable{"ev", MatClass::kInt16, {1, 3}, bytes_of(values)};
  const auto file = encode_mat(std::span(&variable, 1), "a.mat");
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(std::string(file->begin(), file->begin() + 19), "MATLAB 5.0 MAT-file");
  EXPECT_EQ((*file)[124], 0x00);
  EXPECT_EQ((*file)[125], 0x01);
  EXPECT_EQ((*file)[126], 'I');
  const std::vector<uint8_t> matrix(file->begin() + 128, file->end());
  EXPECT_THAT(matrix, ElementsAre(14, 0, 0, 0, 64, 0, 0, 0,                              // matrix of 64 bytes
                                  6, 0, 0, 0, 8, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0,       // class int16
                                  5, 0, 0, 0, 8, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0,        // 1 x 3
                                  1, 0, 0, 0, 2, 0, 0, 0, 'e', 'v', 0, 0, 0, 0, 0, 0,    // its name
                                  3, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0xFE, 0xFF, 3, 0, 0, 0)  // int16
  );
}

TEST(MatFile, GivesBackWhatWasWritten) {
  const std::vector<float> first = {0.5F, -1.0F, 2.0F, 3.5F};
  const std::vector<uint8_t> second = {7, 8, 9};
  const std::vector<MatVariable> variables = {{"first", MatClass::kSingle, {2, 2}, bytes_of(first)},
                                              {"second", MatClass::kUint8, {3, 1, 1}, bytes_of(second)}};
  const std::vector<uint8_t> file = encode_mat(variables, "a.mat").value();
  const auto array = find_mat_array(file, "first", 1 << 20, "a.mat");
  ASSERT_TRUE(array.ok());
  EXPECT_THAT(array->extents, ElementsAre(2, 2));
  EXPECT_EQ(array->array_class, static_cast<uint8_t>(MatClass::kSingle));
  EXPECT_THAT(array->data, ElementsAreArray(bytes_of(first)));
  EXPECT_THAT(find_mat_array(file, "second", 1 << 20, "a.mat")->data, ElementsAre(7, 8, 9));

  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a.mat", file).ok());
  EXPECT_THAT(mat_variables(folder / "a.mat").value(), ElementsAre("first", "second"));
}

TEST(MatFile, WritesOnlyArraysThatTheDataFill) {
  const std::vector<float> values = {1, 2, 3, 4};
  const MatVariable wrong{"a", MatClass::kSingle, {3, 1}, bytes_of(values)};
  EXPECT_THROW((void)encode_mat(std::span(&wrong, 1), ""), ContractError);
}

TEST(MatFile, TellsFilesThatEndEarly) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a.mat", std::string("MATLAB 5.0 MAT-file")).ok());
  EXPECT_EQ(mat_variables(folder / "a.mat").error().code, ErrorCode::kTruncated);
  EXPECT_EQ(mat_variables(folder / "none.mat").error().code, ErrorCode::kTruncated);
}

}  // namespace
}  // namespace e2lf
