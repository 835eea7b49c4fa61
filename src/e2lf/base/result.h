// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

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

namespace e2lf {

/// The kinds of errors. They are few and stable, so that callers can branch on them.
enum class ErrorCode {
  kNotFound,           ///< a file, folder, key or view is missing
  kExists,             ///< the output exists and may not be overwritten
  kFormat,             ///< the bytes do not follow the format
  kTruncated,          ///< the data end too early
  kUnsupported,        ///< well-formed, but of a kind that this build does not handle
  kInvalidValue,       ///< NaN, out of range, or an unknown option
  kShape,              ///< sizes that do not fit together
  kIo,                 ///< the system refused to read or write
  kMissingDependency,  ///< this build lacks a library
  kCancelled,          ///< the caller asked to stop
  kInternal,           ///< a library failed in an unexpected way
};

/// Returns the name of a code as used in JSON output, e.g. "not_found".
[[nodiscard]] const char* error_code_name(ErrorCode code);

/// How a program spells the option with this name, such as the flag for "sensor_width", or "" if it has none.
using OptionSpelling = std::function<std::string(const std::string& name)>;

/// Installs the spelling and returns the previous one. Without one, options are spelled as they are named, which are
/// the keywords of Python. It must be called before any threads are started.
OptionSpelling set_option_spelling(OptionSpelling spelling);

/// Returns the spelling of the option in parentheses after a space, to end a message about it, or "" without a name or
/// a spelling.
[[nodiscard]] std::string option_hint(const std::string& name);

/// Describes bad data as a value. `message` reads "<what went wrong>; <what to do>". `location` is a file and a place
/// in it ("views/03_04.png", "model.safetensors: byte 16", "config.json: $.train.batch"), or empty.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::string location;
  std::string option = {};  ///< the name of the option that it is about, e.g. "sensor_width"; empty if there is none

  /// Returns "location: message (option)" without the parts that are empty.
  [[nodiscard]] std::string text() const;
  /// Returns this error about an option.
  [[nodiscard]] Error about(std::string name) &&;
};

/// Holds either a value or an Error. Accessing the one that is not held breaks the contract and throws ContractError.
template <typename T>
class [[nodiscard]] Result {
 public:
  using value_type = T;
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit by design
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] T& value() & {
    require_ok();
    return std::get<0>(state_);
  }
  [[nodiscard]] const T& value() const& {
    require_ok();
    return std::get<0>(state_);
  }
  /// Returns by value, so that `for (auto& item : read().value())` does not iterate over a destroyed temporary.
  [[nodiscard]] T value() && {
    require_ok();
    return std::get<0>(std::move(state_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  [[nodiscard]] const Error& error() const {
    E2LF_REQUIRE(!ok(), "error() of a Result that holds a value");
    return std::get<1>(state_);
  }

  /// Returns the Result of `next`, called with the value, or the error.
  template <typename Next>
  auto and_then(Next&& next) const& -> std::invoke_result_t<Next, const T&> {
    if (!ok()) return error();
    return std::invoke(std::forward<Next>(next), std::get<0>(state_));
  }
  template <typename Next>
  auto and_then(Next&& next) && -> std::invoke_result_t<Next, T&&> {
    if (!ok()) return error();
    return std::invoke(std::forward<Next>(next), std::get<0>(std::move(state_)));
  }

  /// Returns the value, or `fallback` if there is none.
  [[nodiscard]] T value_or(T fallback) const& { return ok() ? std::get<0>(state_) : std::move(fallback); }
  [[nodiscard]] T value_or(T fallback) && { return ok() ? std::get<0>(std::move(state_)) : std::move(fallback); }

 private:
  void require_ok() const {
    if (!ok()) throw ContractError("value() of a Result that holds an error: " + std::get<1>(state_).text());
  }
  std::variant<T, Error> state_;
};

/// Holds either success or an Error. `return {};` means success.
template <>
class [[nodiscard]] Result<void> {
 public:
  using value_type = void;
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit by design

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  void value() const {
    if (!ok()) throw ContractError("value() of a Result that holds an error: " + error_->text());
  }
  [[nodiscard]] const Error& error() const {
    E2LF_REQUIRE(!ok(), "error() of a Result that holds success");
    return *error_;
  }

  /// Returns the Result of `next`, or the error.
  template <typename Next>
  auto and_then(Next&& next) const -> std::invoke_result_t<Next> {
    if (!ok()) return error();
    return std::invoke(std::forward<Next>(next));
  }

 private:
  std::optional<Error> error_;
};

}  // namespace e2lf

#define E2LF_CONCAT_INNER(a, b) a##b
#define E2LF_CONCAT(a, b) E2LF_CONCAT_INNER(a, b)

/// Returns from the enclosing function with the error of a Result<void> expression, if it has one.
#define E2LF_RETURN_IF_ERROR(expr)                                           \
  do {                                                                       \
    if (auto e2lf_status = (expr); !e2lf_status) return e2lf_status.error(); \
  } while (false)

/// Assigns the value of a Result, or returns its error from the enclosing function: `E2LF_ASSIGN_OR_RETURN(auto image,
/// read_png(path));`
#define E2LF_ASSIGN_OR_RETURN(declaration, expr)                                                \
  auto E2LF_CONCAT(e2lf_result_, __LINE__) = (expr);                                            \
  if (!E2LF_CONCAT(e2lf_result_, __LINE__)) return E2LF_CONCAT(e2lf_result_, __LINE__).error(); \
  declaration = *std::move(E2LF_CONCAT(e2lf_result_, __LINE__))
