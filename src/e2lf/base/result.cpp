// SPDX-License-Identifier: MIT
#include "e2lf/base/result.h"

namespace e2lf {

const char* error_code_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kExists:
      return "exists";
    case ErrorCode::kFormat:
      return "format";
    case ErrorCode::kTruncated:
      return "truncated";
    case ErrorCode::kUnsupported:
      return "unsupported";
    case ErrorCode::kInvalidValue:
      return "invalid_value";
    case ErrorCode::kShape:
      return "shape";
    case ErrorCode::kIo:
      return "io";
    case ErrorCode::kMissingDependency:
      return "missing_dependency";
    case ErrorCode::kCancelled:
      return "cancelled";
    case ErrorCode::kInternal:
      return "internal";
  }
  return "internal";
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
