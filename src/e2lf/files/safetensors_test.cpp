// SPDX-License-Identifier: MIT
#include "e2lf/files/safetensors.h"

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<uint8_t>;

Bytes file_of(const std::string& header, size_t data_size, uint64_t length) {
  Bytes bytes;
  for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<uint8_t>(length >> (8 * i)));
  bytes.insert(bytes.end(), header.begin(), header.end());
  bytes.resize(bytes.size() + data_size);
  return bytes;
}
Bytes file_of(const std::string& header, size_t data_size) {
  return file_of(header, data_size, header.size());
}

std::string entry(const std::string& name, const std::string& shape, const std::string& offsets,
                  const std::string& type = "F32") {
  return "\"" + name + "\":{\"dtype\":\"" + type + "\",\"shape\":" + shape + ",\"data_offsets\":" + offsets + "}";
}

Error safetensors_error(const Bytes& bytes) {
  const auto file = decode_safetensors(bytes, "m.safetensors");
  EXPECT_FALSE(file.ok());
  return file.ok() ? Error{} : file.error();
}

Safetensors some_file() {
  Safetensors file;
  file.metadata = {{"e2lf", "{\"name\": \"\xC3\xA9\"}"}};
  file.tensors["mask"] = make_npy<uint8_t>({3}, std::vector<uint8_t>{1, 0, 1});
  file.tensors["weight"] = make_npy<float>({2, 1, 2}, std::vector<float>{1.5F, -2.0F, 0.0F, 4.0F});
  return file;
}

TEST(Safetensors, RoundTripsTensorsAndMetadata) {
  const auto read = decode_safetensors(encode_safetensors(some_file()), "x");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->metadata, some_file().metadata);
  ASSERT_EQ(read->tensors.size(), 2U);
  EXPECT_EQ(read->tensors.at("weight").shape, (std::vector<size_t>{2, 1, 2}));
  EXPECT_THAT(*read->tensors.at("weight").to_float("x"), ElementsAre(1.5F, -2.0F, 0.0F, 4.0F));
  EXPECT_EQ(read->tensors.at("mask").type, "u1");
  EXPECT_THAT(*read->tensors.at("mask").to_float("x"), ElementsAre(1.0F, 0.0F, 1.0F));
}

TEST(Safetensors, WritesAlignedDataWithWideElementsFirst) {
  const Bytes bytes = encode_safetensors(some_file());
  uint64_t length = 0;
  std::memcpy(&length, bytes.data(), 8);
  EXPECT_EQ(length % 8, 0U);
  float first = 0.0F;
  std::memcpy(&first, bytes.data() + 8 + length, 4);
  EXPECT_EQ(first, 1.5F);
}

TEST(Safetensors, ConvertsBfloat16) {
  Bytes bytes = file_of("{" + entry("a", "[2]", "[0,4]", "BF16") + "}", 4);
  bytes[bytes.size() - 3] = 0x3F;  // 0x3F80 = 1
  bytes[bytes.size() - 4] = 0x80;
  bytes[bytes.size() - 1] = 0xC0;  // 0xC000 = -2
  const auto file = decode_safetensors(bytes, "x");
  ASSERT_TRUE(file.ok());
  EXPECT_THAT(*file->tensors.at("a").to_float("x"), ElementsAre(1.0F, -2.0F));
}

TEST(Safetensors, ReportsEveryTruncation) {
  const Bytes whole = encode_safetensors(some_file());
  for (size_t size = 0; size < whole.size(); ++size) {
    const auto file = decode_safetensors(std::span(whole).first(size), "cut.safetensors");
    ASSERT_FALSE(file.ok()) << size;
    EXPECT_EQ(file.error().code, ErrorCode::kTruncated) << size;
    EXPECT_THAT(file.error().location, HasSubstr("cut.safetensors"));
  }
}

TEST(Safetensors, RefusesAHeaderLargerThanTheFile) {
  for (const uint64_t length : {uint64_t{3}, uint64_t{1} << 40, ~uint64_t{0}}) {
    const Error error = safetensors_error(file_of("{}", 0, length));
    EXPECT_EQ(error.code, ErrorCode::kTruncated);
    EXPECT_THAT(error.message, HasSubstr("file"));
    EXPECT_EQ(error.location, "m.safetensors");
  }
}

TEST(Safetensors, NamesTheTensorThatIsCutOff) {
  const Error error = safetensors_error(file_of("{" + entry("a", "[2]", "[0,8]") + "}", 4));
  EXPECT_EQ(error.code, ErrorCode::kTruncated);
  EXPECT_EQ(error.location, "m.safetensors: a");
}

TEST(Safetensors, RefusesOverlapsHolesAndTails) {
  const std::string a = entry("a", "[2]", "[0,8]");
  const Error overlap = safetensors_error(file_of("{" + a + "," + entry("b", "[2]", "[4,12]") + "}", 12));
  EXPECT_EQ(overlap.code, ErrorCode::kFormat);
  EXPECT_THAT(overlap.message, HasSubstr("overlap"));
  EXPECT_EQ(overlap.location, "m.safetensors: b");
  const Error hole = safetensors_error(file_of("{" + a + "," + entry("b", "[2]", "[12,20]") + "}", 20));
  EXPECT_EQ(hole.code, ErrorCode::kFormat);
  EXPECT_THAT(hole.message, HasSubstr("hole"));
  const Error tail = safetensors_error(file_of("{" + a + "}", 12));
  EXPECT_EQ(tail.code, ErrorCode::kFormat);
  EXPECT_THAT(tail.message, HasSubstr("4 bytes"));
}

TEST(Safetensors, RefusesSizesThatDoNotMatchTheShape) {
  for (const auto& [shape, offsets] : std::vector<std::pair<std::string, std::string>>{
           {"[3]", "[0,8]"}, {"[2]", "[8,0]"}, {"[4294967296,4294967296,4]", "[0,8]"}, {"[0]", "[0,8]"}}) {
    const Error error = safetensors_error(file_of("{" + entry("a", shape, offsets) + "}", 8));
    EXPECT_EQ(error.code, ErrorCode::kFormat) << shape;
    EXPECT_THAT(error.location, HasSubstr("m.safetensors: a")) << shape;
  }
}

TEST(Safetensors, RefusesAnUnknownType) {
  const Error error = safetensors_error(file_of("{" + entry("a", "[8]", "[0,8]", "F8_E4M3") + "}", 8));
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_EQ(error.location, "m.safetensors: a");
  EXPECT_THAT(error.message, HasSubstr("F8_E4M3"));
}

TEST(Safetensors, RefusesDamagedHeaders) {
  const std::string a = entry("a", "[2]", "[0,8]");
  for (const std::string& header : std::vector<std::string>{
           "", "{", "[]", "nonsense", "{\"a\":3}", "{\"a\":{}}", "{" + a + "," + a + "}",
           "{" + entry("a", "[-2]", "[0,8]") + "}", "{" + entry("a", "[2.0]", "[0,8]") + "}",
           "{" + entry("a", "2", "[0,8]") + "}", "{" + entry("a", "[2]", "[0]") + "}",
           "{" + entry("a", "[2]", "[0,8.5]") + "}", "{\"a\":{\"dtype\":4,\"shape\":[2],\"data_offsets\":[0,8]}}",
           "{\"__metadata__\":{\"x\":1}," + a + "}", "{\"__metadata__\":[]," + a + "}"}) {
    EXPECT_EQ(safetensors_error(file_of(header, 8)).code, ErrorCode::kFormat) << header;
  }
  const std::string deep = std::string(400'000, '[') + std::string(400'000, ']');
  EXPECT_EQ(safetensors_error(file_of("{\"a\":" + deep + "}", 8)).code, ErrorCode::kFormat);
}

TEST(Safetensors, FindNamesTheNearestTensor) {
  const Safetensors file = some_file();
  ASSERT_TRUE(file.find("weight", "x").ok());
  const Error error = file.find("wieght", "m.safetensors").error();
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_THAT(error.message, HasSubstr("weight"));
  EXPECT_EQ(Safetensors{}.find("a", "x").error().code, ErrorCode::kNotFound);
}

TEST(Safetensors, MakingATensorOfAnotherShapeBreaksTheContract) {
  EXPECT_THROW((void)make_npy<float>({3}, std::vector<float>{1.0F}), ContractError);
}

TEST(Safetensors, ReadsTheReleasedNetwork) {
  E2LF_REQUIRE_DATA("official/RecNet.safetensors");
  const auto file = read_safetensors(test_data("official/RecNet.safetensors"));
  ASSERT_TRUE(file.ok()) << file.error().text();
  EXPECT_EQ(file->tensors.size(), 46U);
  size_t parameters = 0;
  for (const auto& [name, tensor] : file->tensors) parameters += tensor.num_elements();
  EXPECT_EQ(parameters, 948352U);
}

TEST(Safetensors, FilesRoundTrip) {
  const TestFolder folder;
  ASSERT_TRUE(write_safetensors(folder / "m.safetensors", some_file()).ok());
  EXPECT_EQ(read_safetensors(folder / "m.safetensors")->tensors.size(), 2U);
  EXPECT_EQ(read_safetensors(folder / "none.safetensors").error().code, ErrorCode::kNotFound);
}

TEST(Safetensors, SaysThatAJsonFileIsNoModel) {
  const std::string text = "{\n  \"patterns\": []\n}\n";
  const auto read = decode_safetensors({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "codes.json");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kFormat);
  EXPECT_NE(read.error().message.find("JSON"), std::string::npos);
}

}  // namespace
}  // namespace e2lf
