// SPDX-License-Identifier: MIT
#include "e2lf/program/option_values.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/text.h"

namespace e2lf::program {
namespace {

template <typename T>
bool is_number(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// 010 would be read as octal.
void strip_zeros(std::string& digits) {
  const size_t begin = digits.starts_with('-');
  const size_t first = std::min(digits.find_first_not_of('0', begin), digits.size() - 1);
  if (first > begin) digits.erase(begin, first - begin);
}

std::string check_unsigned(std::string& text) {
  if (!is_number<uint64_t>(text)) return cat("\"", text, "\" is not a whole number from 0 to ", UINT64_MAX);
  strip_zeros(text);
  return {};
}

std::string check_signed(std::string& text) {
  if (!is_number<int64_t>(text)) return cat("\"", text, "\" is not a whole number of 64 bits");
  strip_zeros(text);
  return {};
}

std::string check_float(std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_whole_text = !text.empty() && *end == '\0';
  return is_whole_text && std::isfinite(value) ? std::string() : cat("\"", text, "\" is not a number");
}

CLI::Validator quiet_validator(std::string (*check)(std::string&)) {
  return {check, ""};
}

}  // namespace

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    // The name of the type is followed by those of its other checks. A transformation runs before the checks.
    if (type.starts_with("UINT")) option->transform(quiet_validator(check_unsigned));
    if (type.starts_with("INT")) option->transform(quiet_validator(check_signed));
    if (type.starts_with("FLOAT")) option->transform(quiet_validator(check_float));
  }
}

CLI::Validator whole_number(int64_t least, int64_t most) {
  const std::string range = most == INT64_MAX ? cat("at least ", least) : cat(least, " to ", most);
  const auto check = [=](std::string& text) {
    int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_inside = error == std::errc() && value >= least && value <= most;
    return is_inside ? std::string() : cat(text, " is out of range; give ", range);
  };
  return {check, range};
}

CLI::Validator positive_number() {
  const auto check = [](std::string& text) {
    return std::strtod(text.c_str(), nullptr) > 0 ? std::string()
                                                  : cat(text, " is not above 0; give a positive number");
  };
  return {check, "above 0"};
}

CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& value,
                        const std::vector<std::string>& choices, const std::string& help) {
  return app.add_option(name, value, help)->check(CLI::IsMember(choices))->capture_default_str();
}

}  // namespace e2lf::program
