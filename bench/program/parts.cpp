// SPDX-License-Identifier: MIT
#include "bench/program/parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <dlfcn.h>

#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/program/outputs.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::bench {
using namespace program;
using lightfield::LightField;

void add_size_options(Verb& verb, size_t& width, size_t& height) {
  const CLI::Range pixels(size_t{1}, size_t{16384});
  verb.app().add_option("--width", width, "of the image in pixels")->check(pixels)->capture_default_str();
  verb.app().add_option("--height", height, "of the image in pixels")->check(pixels)->capture_default_str();
}

int run_bench(Verb& verb, const std::vector<std::string>& arguments, const std::function<Result<Json>()>& measure,
              const std::function<BenchReport(const Json&)>& describe,
              const std::function<std::vector<std::filesystem::path>()>& inputs) {
  std::vector<std::filesystem::path> names;
  add_report_option(verb.app(), names);
  return verb.run(arguments, [&]() -> Result<void> {
    const auto given = inputs ? inputs() : std::vector<std::filesystem::path>();
    E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(names, output_rules(verb, given)));
    E2LF_ASSIGN_OR_RETURN(const Json json, measure());
    hide_progress();
    const BenchReport found = describe(json);
    if (reports.is_wanted()) {
      report::Page page = verb_page(found.title);
      page.paragraph(found.about);
      for (const report::Table& table : found.tables) page.table(table);
      if (!found.note.empty()) page.paragraph(found.note);
      page.heading("All figures").facts(json);
      E2LF_RETURN_IF_ERROR(reports.write(page));
    }
    if (verb.common().json) {
      std::printf("%s", json_text(json).c_str());
      return {};
    }
    if (verb.common().quiet && reports.is_wanted()) return {};
    std::printf("%s\n", found.about.c_str());
    for (const report::Table& table : found.tables) std::printf("\n%s", report::table_text(table).c_str());
    if (!found.note.empty()) std::printf("\n%s\n", found.note.c_str());
    return {};
  });
}

report::Cell number_of(const Json& row, const char* name, int decimals, double factor) {
  if (!row.contains(name)) return {};
  const Json& value = row[name].is_object() ? row[name]["median"] : row[name];
  return report::number_cell(factor * value.get<double>(), decimals);
}

Timing timing_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  return {seconds[seconds.size() / 2], seconds.front(), seconds.back()};
}

Json to_json(const Timing& timing) {
  return {{"median", timing.median}, {"min", timing.min}, {"max", timing.max}};
}

model::Weights random_weights(const model::Network& network) {
  model::Weights weights;
  uint64_t stream = 0;
  for (const model::WeightShape& shape : model::weight_shapes(network)) {
    size_t size = 1;
    for (const size_t extent : shape.shape) size *= extent;
    const CounterRng rng(1, ++stream);
    const float scale = std::sqrt(6.0F * static_cast<float>(shape.shape[0]) / static_cast<float>(size));
    std::vector<float>& values = weights[shape.name];
    for (size_t i = 0; i < size; ++i) values.push_back((2.0F * rng.uniform(i) - 1.0F) * scale);
  }
  return weights;
}

void* find_in_peer(const char* module, const char* function, std::string& absent) {
  const std::string path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / module;
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    absent = cat("not in this build (", ::dlerror(), ")");
    return nullptr;
  }
  void* const found = ::dlsym(library, function);
  if (found == nullptr) absent = cat(path, " is not the peer's module");
  return found;
}

std::vector<float> noise_input(const model::Network& network, size_t height, size_t width) {
  const CounterRng rng(2, 0);
  std::vector<float> input(network.input_channels * height * width);
  for (size_t i = 0; i < input.size(); ++i) input[i] = static_cast<float>(rng.below(i, 17)) / 8.0F - 1.0F;
  return input;
}

Result<LightField> in_view(const LightField& scene, size_t size, size_t motion_px, size_t most_px) {
  const size_t margin = most_px + 1;
  const lightfield::Shape& shape = scene.shape();
  if (shape.width < margin + 16) {
    return Error{ErrorCode::kShape, cat("the views are narrower than ", margin + 16, " px; use larger ones"), ""};
  }
  const size_t height = std::min(size, shape.height);
  const size_t width = std::min(size, shape.width - margin);
  const size_t x = (shape.width - margin - width) / 2 + motion_px;
  return lightfield::crop(scene, {(shape.height - height) / 2, x, height, width});
}

Result<double> best_psnr_db(const LightField& field, const std::vector<LightField>& scenes) {
  double best = 0;
  for (const LightField& scene : scenes) {
    LightField fitted = field;
    const float gain = eval::best_gain(scene, field);
    for (float& value : fitted.data()) value *= gain;
    E2LF_ASSIGN_OR_RETURN(const auto metrics, eval::compare(scene, fitted));
    best = std::max(best, metrics.mean.psnr_db);
  }
  return best;
}

}  // namespace e2lf::bench
