// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/compare/plan.h"

namespace e2lf::compare {

/// The results of a folder: <folder>/results/<key>.json, and a picture beside it where there is one. Each appears
/// whole.
class ResultStore {
 public:
  explicit ResultStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The figures of a job; nothing where there are none that were made of the same, or where the
  /// file was changed.
  [[nodiscard]] std::optional<Json> find(const Job& job) const;

  /// The PNG beside a result, or of a key of its own; empty where there is none.
  [[nodiscard]] std::vector<uint8_t> picture(const std::string& key) const;

  /// Keeps a picture, where there is one, and then the figures. Fails with kIo.
  [[nodiscard]] Result<void> keep(const Plan& plan, const Job& job, const Json& figures,
                                  const std::vector<uint8_t>& png) const;
  [[nodiscard]] Result<void> keep_picture(const std::string& key, const std::vector<uint8_t>& png) const;

  /// Copies the results of the plan that another folder has and this one has not, with their pictures, and those of
  /// `picture_keys`. Returns how many results. Fails with kIo.
  [[nodiscard]] Result<size_t> take_over(const Plan& plan, const ResultStore& other,
                                         const std::vector<std::string>& picture_keys) const;

 private:
  [[nodiscard]] std::filesystem::path file(const std::string& key, const char* extension) const;
  std::filesystem::path folder_;
};

/// The key of the picture of a true scene.
[[nodiscard]] std::string truth_key(const Scene& scene);

}  // namespace e2lf::compare
