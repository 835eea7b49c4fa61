// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/next_step.h"

#include <cstdio>

namespace e2lf::cli {

std::string shell_word(const std::string& word) {
  const bool is_plain = word.find_first_not_of(
                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                            "_@%+=:,./-") == std::string::npos;
  if (is_plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

void print_next_step(const std::string& command, const CommonOptions& common) {
  if (common.json || common.quiet) return;
  std::printf("next: %s\n", command.c_str());
}

}  // namespace e2lf::cli
