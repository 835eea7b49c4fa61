// SPDX-License-Identifier: MIT
// e2lf codes: show; render (codes_render.cpp); play (codes_play.cpp)
#include <cstdio>

#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {
namespace {

Json codes_json(const capture::Codes& codes) {
  Json json;
  json["num_patterns"] = codes.num_patterns;
  json["views"] = {codes.views_y, codes.views_x};
  json["black_first"] = capture::is_black_first(codes);
  json["binary"] = capture::is_binary(codes);
  json["light_efficiency"] = capture::light_efficiency(codes);
  return json;
}

void print_codes(const capture::Codes& codes) {
  std::printf("%zu patterns of %zux%zu, %s, %s\n%s\nlight efficiency:", codes.num_patterns, codes.views_y,
              codes.views_x, capture::is_black_first(codes) ? "black first" : "NOT black first",
              capture::is_binary(codes) ? "binary" : "not binary", capture::codes_text(codes).c_str());
  for (const float efficiency : capture::light_efficiency(codes)) {
    std::printf(" %.1f %%", 100.0 * static_cast<double>(efficiency));
  }
  std::printf("\n");
}

int run_codes_show(const std::vector<std::string>& arguments) {
  Verb verb("codes show", "Show the aperture patterns of a model or a file of codes.", "e2lf codes show -m e2lf-n4");
  CodesSource source;
  std::filesystem::path output;
  add_codes_options(verb.app(), source);
  verb.app().add_option("-o,--output", output, "also write the patterns to this file (.json, .npy, .npz), for --codes");
  return verb.run(arguments, [&]() -> Result<void> {
    RunRecord record("codes show");
    E2LF_ASSIGN_OR_RETURN(const pipeline::KnownCodes known, load_codes(source, record));
    if (!output.empty()) {
      E2LF_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(output, {.inputs = {source.model, source.codes},
                                                                         .overwrite = verb.common().overwrite}));
      E2LF_RETURN_IF_ERROR(capture::write_codes(file.path(), known.codes));
      E2LF_RETURN_IF_ERROR(file.commit());
    }
    if (verb.common().json) {
      std::printf("%s", json_text(codes_json(known.codes)).c_str());
    } else {
      print_codes(known.codes);
    }
    return {};
  });
}

}  // namespace

int run_codes(const std::vector<std::string>& arguments) {
  return run_subverb("codes",
                     {{"show", "print patterns, black-first check and light efficiency", run_codes_show},
                      {"render", "make the images and the schedule for an aperture display", run_codes_render},
                      {"play", "show the patterns on a display of this computer", run_codes_play}},
                     arguments);
}

}  // namespace e2lf::cli
