// SPDX-License-Identifier: MIT
#include "e2lf/files/bundled_files.h"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf {
namespace {

TEST(BundledFiles, AreFoundByNameWithAndWithoutTheirExtension) {
  const auto model = find_file_or_bundled(kBundledModels, "e2lf-n4");
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_TRUE(std::filesystem::is_regular_file(*model));
  EXPECT_EQ(*model, bundled_model());
  EXPECT_EQ(*model, find_file_or_bundled(kBundledCodes, "e2lf-n4.safetensors").value());
  EXPECT_EQ(find_file_or_bundled(kBundledCameras, "paper").value().filename(), "paper.json");
  EXPECT_EQ(*model, bundled_file_named(kBundledModels, "models/e2lf-n4.safetensors"));
  EXPECT_EQ(shown_name(kBundledModels, *model), "e2lf-n4");
}

TEST(BundledFiles, AFileOfThatNameGoesFirst) {
  const TestFolder folder;
  const auto path = folder / "e2lf-n4";
  std::ofstream(path) << "mine";
  EXPECT_EQ(find_file_or_bundled(kBundledModels, path.string()).value(), path);
}

TEST(BundledFiles, TheEnvironmentNamesTheFolderOfModels) {
  const TestFolder folder;
  const auto own = folder / "my_models" / "own.safetensors";
  const auto camera = folder / "cameras" / "own.json";
  for (const auto& file : {own, camera}) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << "mine";
  }
  ::setenv("E2LF_MODELS", (folder / "my_models").c_str(), 1);
  EXPECT_EQ(bundled_file_named(kBundledModels, "own"), own);
  EXPECT_EQ(bundled_file_named(kBundledCameras, "own"), camera);
  EXPECT_EQ(bundled_names(kBundledModels), std::vector<std::string>{"own"});
  EXPECT_TRUE(bundled_file_named(kBundledCameras, "paper"));
  ::unsetenv("E2LF_MODELS");
  EXPECT_FALSE(bundled_file_named(kBundledModels, "own"));
}

TEST(BundledFiles, AnErrorNamesThoseThereAre) {
  const auto unknown = find_file_or_bundled(kBundledCameras, "nobodys");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  for (const std::string& name : bundled_names(kBundledCameras)) {
    EXPECT_NE(unknown.error().message.find(name), std::string::npos) << name;
  }
  EXPECT_FALSE(bundled_file_named(kBundledModels, "../models/e2lf-n4"));
  EXPECT_FALSE(bundled_file("models/nothing.safetensors"));
}

}  // namespace
}  // namespace e2lf
