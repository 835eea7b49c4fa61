// SPDX-License-Identifier: MIT
#include "e2lf/base/result.h"

#include "e2lf/base/choice.h"

namespace e2lf {

const char* error_code_name(ErrorCode code) {
  using enum ErrorCode;
  constexpr Choice<ErrorCode> kNames[] = {{"not_found", kNotFound},
                                          {"exists", kExists},
                                          {"format", kFormat},
                                          {"truncated", kTruncated},
                                          {"unsupported", kUnsupported},
                                          {"invalid_value", kInvalidValue},
                                          {"shape", kShape},
                                          {"io", kIo},
                                          {"missing_dependency", kMissingDependency},
                                          {"cancelled", kCancelled},
                                          {"internal", kInternal}};
  return word_of(code, kNames);
}

namespace {

OptionSpelling& option_spelling() {
  static OptionSpelling spelling;
  return spelling;
}

}  // namespace

OptionSpelling set_option_spelling(OptionSpelling spelling) {
  return std::exchange(option_spelling(), std::move(spelling));
}

std::string option_hint(const std::string& name) {
  const OptionSpelling& spelling = option_spelling();
  const std::string text = name.empty() || !spelling ? name : spelling(name);
  return text.empty() ? text : " (" + text + ")";
}

std::string Error::text() const {
  return (location.empty() ? message : location + ": " + message) + option_hint(option);
}

Error Error::about(std::string name) && {
  option = std::move(name);
  return std::move(*this);
}

void fail_contract(const char* condition, const char* file, int line, const std::string& message) {
  std::string text = std::string(file) + ":" + std::to_string(line) + ": precondition failed: " + condition;
  if (!message.empty()) text += " (" + message + ")";
  throw ContractError(text);
}

}  // namespace e2lf
