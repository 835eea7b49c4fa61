// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace e2lf {

/// Thrown when a caller breaks a documented precondition, which is a bug in the program and not in its data.
class ContractError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void fail_contract(const char* condition, const char* file, int line, const std::string& message);

}  // namespace e2lf

/// Throws ContractError with file, line and condition when a precondition does not hold. Active in every build.
#define E2LF_REQUIRE(condition, message)                                                                \
  do {                                                                                                  \
    if (!(condition)) ::e2lf::fail_contract(#condition, __FILE_NAME__, __LINE__, std::string(message)); \
  } while (false)

/// Checks the same in inner loops. It is compiled only with E2LF_ASSERTIONS (the dev and asan presets).
#ifdef E2LF_ASSERTIONS
#define E2LF_ASSERT(condition) E2LF_REQUIRE(condition, "")
#else
#define E2LF_ASSERT(condition) \
  do {                         \
  } while (false)
#endif
