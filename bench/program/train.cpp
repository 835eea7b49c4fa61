// SPDX-License-Identifier: MIT
// e2lf-bench train: measures training in a program of its own.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "bench/program/parts.h"
#include "e2lf/base/text.h"
#include "e2lf/program/options.h"

namespace e2lf::bench {
using namespace program;
namespace {

report::Cell text_of(const Json& row, const char* name) {
  return report::text_cell(row[name].get<std::string>());
}

BenchReport training_report(const Json& json) {
  report::Table table{"Ratios to the first row of the same job.",
                      {{"job"}, {"what"}, {"precision"}, {"samples/s", true}, {"ratio", true}},
                      {}};
  for (const Json& row : json["rows"]) {
    table.rows.push_back({text_of(row, "job"), text_of(row, "name"), text_of(row, "precision"),
                          number_of(row, "samples_per_s", 2), number_of(row, "ratio", 2)});
  }
  return {"Speed of training",
          cat("training: samples of 64x64x8x8, batch ", json["batch"].get<uint64_t>(),
              "; synthesis: light fields of 96x96x8x8; ", json["threads"].get<int>(), " threads"),
          {std::move(table)}};
}

/// Runs the program that measures training, which needs torch, and reads the JSON that it prints.
Result<Json> run_training_program(const std::vector<std::string>& arguments, int threads) {
  std::error_code status;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", status);
  const std::string program = (self.parent_path() / "e2lf-bench-train").string();
  if (!std::filesystem::exists(program, status)) {
    return Error{ErrorCode::kMissingDependency,
                 "the program was not built; `./run bench train` builds it with libtorch", program};
  }
  if (threads > 0) ::setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  std::string command = program::shell_word(program);
  for (const std::string& argument : arguments) command += cat(" ", program::shell_word(argument));
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr)
    return Error{ErrorCode::kIo, cat("cannot start the program (", std::strerror(errno), ")"), program};
  std::string text;
  for (int letter; (letter = std::fgetc(pipe)) != EOF;) text += static_cast<char>(letter);
  if (::pclose(pipe) != 0) return Error{ErrorCode::kInternal, "the program failed; see its message above", program};
  return parse_json(text, program);
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train", "Measure training and the synthesis of its data against plain libtorch, in the same run.",
            "e2lf-bench train --batch 8 --json");
  uint64_t batch = 4, steps = 5;
  verb.app().add_option("--batch", batch, "samples of 64x64x8x8 for each step")->check(whole_number(1));
  verb.app().add_option("--steps", steps, "measured for each loop; figures are medians")->check(whole_number(1));
  const auto measure_all = [&]() -> Result<Json> {
    E2LF_ASSIGN_OR_RETURN(const Json json,
                          run_training_program({std::to_string(batch), std::to_string(steps)}, verb.common().threads));
    return json;
  };
  return run_bench(verb, arguments, measure_all, training_report);
}

}  // namespace e2lf::bench
