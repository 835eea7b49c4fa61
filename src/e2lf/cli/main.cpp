// SPDX-License-Identifier: MIT
// The program e2lf.
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "e2lf/base/isa.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/declared_verbs.h"
#include "e2lf/cli/features.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/version.h"
#include "e2lf/files/file.h"
#include "e2lf/formats/formats.h"

namespace {

using namespace e2lf::cli;  // the list of verbs

int run_completion(const std::vector<std::string>& arguments);

const std::vector<VerbEntry>& verbs() {
  static const std::vector<VerbEntry> list = {
      {"demo", "simulate a scene, reconstruct its light field, measure it", run_demo},
      {"info", "describe a file or folder", run_info},
      {"convert", "convert between event formats, or between light-field formats", run_convert},
      {"accumulate", "recording -> event images per pattern cycle", run_accumulate},
      {"simulate", "light field -> event images or a recording", run_simulate},
      {"reconstruct", "event images or a recording -> light field", run_reconstruct},
      {"record", "live camera, pipe or socket -> recording, byte for byte", run_record},
      {"camera", "list and check live cameras", run_camera},
      {"video", "recording -> grey frames", run_video},
      {"calibrate", "event images of static scenes -> constants of a camera", run_calibrate},
      {"eval", "compare a reconstruction with the ground truth", run_eval},
      {"compare", "compare methods over scenes, sensors and seeds", run_compare},
      {"equivalence", "measure how well events determine intensities", run_equivalence},
      {"depth", "light field -> disparity map", run_depth},
      {"refocus", "light field -> refocused images with a wide aperture", run_refocus},
      {"epi", "light field -> epipolar plane image", run_epi},
      {"animate", "light field -> film with a moving viewpoint or focus, or a quilt", run_animate},
      {"view", "show light fields, events, recordings and models in a browser", run_view},
      {"live", "show light fields while the camera records", run_live},
      {"pack", "light fields and photographs -> one file for training", run_pack},
      {"train", "learn aperture patterns and a network jointly", run_train},
      {"resume", "continue a training run", run_resume},
      {"codes", "show and render aperture patterns", run_codes},
      {"model", "describe, import, store and export model files", run_model},
      {"completion", "print the completion script for a shell", run_completion},
  };
  return list;
}

/// Prints the version, the features of this build, and the instruction set that the kernels use on this processor.
int print_version() {
  std::printf("e2lf %s\n%sinstructions: %s\n", kVersion, kFeatures, e2lf::current_isa().c_str());
  return 0;
}

int fail(const std::string& verb, const e2lf::Error& error, int code) {
  std::fprintf(stderr, "e2lf: %s: %s\n", verb.c_str(), error.text().c_str());
  return code;
}

int print_completion(const std::string& shell, const std::string& example, const std::vector<std::string>& arguments) {
  Verb verb("completion " + shell, e2lf::cat("Print the script for the completion of e2lf in ", shell, "."), example);
  return verb.run(arguments, [&]() -> e2lf::Result<void> {
    E2LF_ASSIGN_OR_RETURN(const std::string script, completion_script(shell, declared_verbs(verbs())));
    std::fputs(script.c_str(), stdout);
    return {};
  });
}

int run_completion(const std::vector<std::string>& arguments) {
  if (!arguments.empty() && !arguments.front().starts_with("-")) {
    const auto script = completion_script(arguments.front(), {});
    if (!script) return fail("completion", script.error(), 2);  // the error names the shells
  }
  return run_subverb(
      "completion",
      {{"bash", "print the script for bash",
        [](const auto& rest) { return print_completion("bash", "source <(e2lf completion bash)", rest); }},
       {"zsh", "print the script for zsh: _e2lf in a folder of $fpath",
        [](const auto& rest) { return print_completion("zsh", "e2lf completion zsh >_e2lf", rest); }},
       {"fish", "print the script for fish",
        [](const auto& rest) { return print_completion("fish", "e2lf completion fish | source", rest); }}},
      arguments);
}

/// Implements e2lf shell-texts FOLDER for the build: writes manual pages (man1/) and completion scripts (bash/, zsh/,
/// fish/).
int write_texts(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2) {
    std::fprintf(stderr, "usage: e2lf shell-texts FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  const std::vector<DeclaredVerb> declared = declared_verbs(verbs());
  std::map<std::filesystem::path, std::string> texts;
  for (const DeclaredVerb& verb : declared) texts["man1/" + manual_name(verb) + ".1"] = manual_page(verb, declared);
  texts["bash/e2lf"] = *completion_script("bash", declared);
  texts["zsh/_e2lf"] = *completion_script("zsh", declared);
  texts["fish/e2lf.fish"] = *completion_script("fish", declared);
  for (const auto& [name, text] : texts) {
    const auto written = e2lf::write_file(folder / name, text);
    if (!written) return fail("shell-texts", written.error(), 1);
  }
  return 0;
}

int run(const std::vector<std::string>& arguments) {
  const std::string first = arguments.empty() ? "" : arguments.front();
  if (first == "--version" || first == "version") return print_version();
  // Not in the list of verbs, because only the build uses it.
  if (first == "shell-texts") return write_texts(arguments);
  return run_subverb("", verbs(), arguments);
}

}  // namespace

int main(int argc, char** argv) {
  e2lf::formats::add_formats();
  return run_program("e2lf", argc, argv, run);
}
