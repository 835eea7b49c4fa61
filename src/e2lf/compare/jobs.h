// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/compare/plan.h"
#include "e2lf/compare/store.h"

namespace e2lf::compare {

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
