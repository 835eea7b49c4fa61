// SPDX-License-Identifier: MIT
#include "e2lf/files/bundled_files.h"

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
