// SPDX-License-Identifier: MIT
#include "e2lf/base/contract.h"

namespace e2lf {

void fail_contract(const char* condition, const char* file, int line, const std::string& message) {
  std::string text = std::string(file) + ":" + std::to_string(line) + ": precondition failed: " + condition;
  if (!message.empty()) text += " (" + message + ")";
  throw ContractError(text);
}

}  // namespace e2lf
