// SPDX-License-Identifier: MIT
#include "e2lf/compare/store.h"

#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/sha256.h"

namespace e2lf::compare {
namespace fs = std::filesystem;

fs::path ResultStore::file(const std::string& key, const char* extension) const {
  return folder_ / "results" / (key + extension);
}

std::optional<Json> ResultStore::find(const Job& job) const {
  const auto json = read_json(file(job.key, ".json"));
  if (!json || !json->is_object() || json->value("inputs", Json()) != job.inputs) return std::nullopt;
  Json figures = json->value("figures", Json());
  if (!figures.is_object() || json->value("sha256", Json()) != sha256_of_text(json_line(figures))) return std::nullopt;
  return figures;
}

std::vector<uint8_t> ResultStore::picture(const std::string& key) const {
  return read_file(file(key, ".png")).value_or({});
}

Result<void> ResultStore::keep_picture(const std::string& key, const std::vector<uint8_t>& png) const {
  return png.empty() ? Result<void>() : write_file(file(key, ".png"), png);
}

Result<void> ResultStore::keep(const Plan& plan, const Job& job, const Json& figures,
                               const std::vector<uint8_t>& png) const {
  E2LF_RETURN_IF_ERROR(keep_picture(job.key, png));
  const Json json = {{"written_by", "e2lf"},
                     {"method", plan.methods[job.method].config.name},
                     {"scene", plan.scenes[job.scene].name},
                     {"sensor", plan.sensors[job.sensor].config.name},
                     {"inputs", job.inputs},
                     {"figures", figures},
                     {"sha256", sha256_of_text(json_line(figures))}};
  return write_file(file(job.key, ".json"), json_text(json));
}

Result<size_t> ResultStore::take_over(const Plan& plan, const ResultStore& other,
                                      const std::vector<std::string>& picture_keys) const {
  size_t taken = 0;
  for (const std::string& key : picture_keys) E2LF_RETURN_IF_ERROR(keep_picture(key, other.picture(key)));
  for (const Job& job : plan.jobs) {
    if (find(job)) continue;
    const auto figures = other.find(job);
    if (!figures) continue;
    E2LF_RETURN_IF_ERROR(keep(plan, job, *figures, other.picture(job.key)));
    ++taken;
  }
  return taken;
}

std::string truth_key(const Scene& scene) {
  return sha256_of_text(json_line(scene.identity));
}

}  // namespace e2lf::compare
