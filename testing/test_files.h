// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <unistd.h>

/// Helpers for the tests of every module: a folder of their own, and the available data.
namespace e2lf {

/// An empty folder for one test, which is removed with its content at the end.
class TestFolder {
 public:
  TestFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = "e2lf." + std::to_string(::getpid()) + "." + test->test_suite_name() + "." + test->name();
    // The names of parametrised tests contain slashes.
    std::replace(name.begin(), name.end(), '/', '.');
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline size_t count_entries(const std::filesystem::path& folder) {
  return static_cast<size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

/// Returns the content of a file, or "<unreadable>".
inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return file ? std::string(std::istreambuf_iterator<char>(file), {}) : "<unreadable>";
}

/// Returns the path of a file or folder below E2LF_DATA, or an empty path if it does not exist.
inline std::filesystem::path test_data(const std::string& name) {
  const char* root = std::getenv("E2LF_DATA");
  if (root == nullptr) return {};
  const auto path = std::filesystem::path(root) / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

}  // namespace e2lf

/// Skips the test with an explanation if `name` does not exist below E2LF_DATA.
#define E2LF_REQUIRE_DATA(name) \
  if (::e2lf::test_data(name).empty()) GTEST_SKIP() << "no " << (name) << " below E2LF_DATA"
