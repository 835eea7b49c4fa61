// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/print.h"

#include <cstdarg>

#include "e2lf/base/text.h"

namespace e2lf::cli {

std::string formatted(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return text;
}

std::string counted(size_t count, const char* what) {
  return cat(count, " ", what, count == 1 ? "" : "s");
}

void print_result(const CommonOptions& common, const Json& json, const std::string& text, std::FILE* to) {
  if (!common.json && common.quiet) return;
  std::fputs(common.json ? json_text(json).c_str() : text.c_str(), to);
}

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
