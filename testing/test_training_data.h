// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <unistd.h>
#include <vector>

#include "e2lf/files/safetensors.h"
#include "e2lf/learn/run/config.h"

namespace e2lf::learn {

/// A folder for one test with a small packed file: the scenes "first" (values 0..99) and "second" (100..199) with 8x8
/// views of 32x32 px, and one texture.
class TestData {
 public:
  TestData() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("e2lf_learn_") + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    Safetensors file;
    for (const uint8_t base : {0, 100}) {
      std::vector<uint8_t> views(64 * 32 * 32);
      for (size_t i = 0; i < views.size(); ++i) views[i] = static_cast<uint8_t>(base + (i * 7 + i / 1024) % 100);
      file.tensors[base == 0 ? "lightfield/first" : "lightfield/second"] = make_npy<uint8_t>({8, 8, 32, 32}, views);
    }
    file.tensors["texture/set/a"] = make_npy<uint8_t>({64, 80}, std::vector<uint8_t>(64 * 80, 90));
    EXPECT_TRUE(write_safetensors(path(), file));
  }
  TestData(const TestData&) = delete;
  TestData& operator=(const TestData&) = delete;
  ~TestData() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "packed.safetensors"; }

  /// Returns the configuration of a run of a few seconds on this data.
  [[nodiscard]] Config config() const {
    Config config;
    config.data.file = path().string();
    config.data.validation = {"first"};
    config.data.synthesiser.size = 32;
    config.data.pool = 4;
    config.network = {{.widths = {8, 8}, .blocks = {1, 1}, .head_width = 4}, "unet"};
    config.patterns.begin_step = 2;
    config.patterns.learn_steps = 5;
    config.train.patch = 16;
    config.train.batch = 2;
    config.train.steps = 8;
    config.train.warmup_steps = 2;
    config.train.log_steps = 1;
    config.train.evaluate_steps = 4;
    config.train.checkpoint_steps = 4;
    return config;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace e2lf::learn
