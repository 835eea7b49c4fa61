// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/compare/plan.h"

namespace e2lf::compare {

/// The results in a folder: <folder>/results/<key>.json, with a picture beside it if there is one. Each file appears
/// either whole or not at all.
class ResultStore {
 public:
  explicit ResultStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Returns the figures of a job. Returns nothing if there are none for the same inputs or if the file was changed.
  [[nodiscard]] std::optional<Json> find(const Job& job) const;

  /// Returns the PNG of a result, or of any other key, or nothing if there is none.
  [[nodiscard]] std::vector<uint8_t> picture(const std::string& key) const;

  /// Stores a picture, if there is one, and then the figures. Fails with kIo.
  [[nodiscard]] Result<void> keep(const Plan& plan, const Job& job, const Json& figures,
                                  const std::vector<uint8_t>& png) const;
  [[nodiscard]] Result<void> keep_picture(const std::string& key, const std::vector<uint8_t>& png) const;

  /// Copies the results of the plan that only the other folder has, with their pictures, and those of the true scenes.
  /// Returns the number of results. Fails with kIo.
  [[nodiscard]] Result<size_t> take_over(const Plan& plan, const ResultStore& other) const;

 private:
  [[nodiscard]] std::filesystem::path file(const std::string& key, const char* extension) const;
  std::filesystem::path folder_;
};

/// Returns the key of the picture of a true scene.
[[nodiscard]] std::string truth_key(const ComparedScene& scene);

/// The part of the jobs that one run computes: part `number` of `count`, counted from 1.
struct Shard {
  size_t number = 1, count = 1;
};

/// Returns the numbers of the jobs of a shard whose results must be computed: those that the store lacks, or, with
/// `again`, all. Of jobs with the same result, only the first is listed.
[[nodiscard]] std::vector<size_t> open_jobs(const Plan& plan, const ResultStore& store, const Shard& shard, bool again);

/// Computes the jobs with these numbers one after another, until all are done or a stop is requested, and stores each
/// result at once; those of the first seed with a picture, if the plan has pictures. Returns the number of results.
/// Fails as load_scene(), JobRunner::run() and ResultStore::keep() do.
[[nodiscard]] Result<size_t> run_jobs(const Plan& plan, const std::vector<size_t>& jobs, const ResultStore& store,
                                      const ProgressFn& progress = {});

}  // namespace e2lf::compare
