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

std::string Error::text() const {
  return location.empty() ? message : location + ": " + message;
}

void fail_contract(const char* condition, const char* file, int line, const std::string& message) {
  std::string text = std::string(file) + ":" + std::to_string(line) + ": precondition failed: " + condition;
  if (!message.empty()) text += " (" + message + ")";
  throw ContractError(text);
}

}  // namespace e2lf
