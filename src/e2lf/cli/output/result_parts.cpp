// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/result_parts.h"

#include "e2lf/base/text.h"

namespace e2lf::cli {

std::string cycle_name(size_t cycle) {
  return formatted("cycle_%05zu", cycle);
}

Result<std::filesystem::path> ResultParts::begin(const std::string& name) {
  if (is_one_) return folder_.path();
  return folder_.begin_part(name);
}

Result<void> ResultParts::commit(const std::string& name, Json about, const program::RunRecord& run) {
  if (is_one_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit_part(name, std::move(about)));
  if (is_in_place_ || is_strict_) return {};
  E2LF_RETURN_IF_ERROR(folder_.commit(run.json_so_far()));
  is_in_place_ = true;
  return {};
}

Result<void> ResultParts::finish(const program::RunRecord& run) {
  E2LF_ASSIGN_OR_RETURN(Json about, run.json());
  return is_in_place_ ? folder_.update_record(std::move(about)) : folder_.commit(std::move(about));
}

}  // namespace e2lf::cli
