// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "e2lf/base/contract.h"

namespace e2lf {

/// What kind of thing went wrong; few and stable, so that callers can branch on them.
enum class ErrorCode {
  kNotFound,           ///< a file, folder, key or view that should be there is not
  kExists,             ///< the output exists and may not be overwritten
  kFormat,             ///< the bytes are not what the format says
  kTruncated,          ///< the data ends before it should
  kUnsupported,        ///< well formed, but of a kind this build does not handle
  kInvalidValue,       ///< NaN, out of range, an unknown option
  kShape,              ///< sizes that do not fit together
  kIo,                 ///< the system refused to read or write
  kMissingDependency,  ///< this build lacks a library
  kCancelled,          ///< the caller asked to stop
  kInternal,           ///< a library failed in a way we do not understand
};

/// The name of a code as used in JSON output, e.g. "not_found".
[[nodiscard]] const char* error_code_name(ErrorCode code);

/// What a caller can set to mend an error or to say what was assumed. The library states facts; e2lf's verbs add the
/// flag.
enum class Setting {
  kNone,
  kOverwrite,
  kInputFormat,
  kOutputFormat,
  kSensorSize,
  kTimeUnit,
  kColumns,
  kStream,
  kShiftTime,
  kFilterPixels,
  kCodes,
  kWhite,
  kLensletViews,
  kViews,
  kPort,
};

/// Bad data as a value. `message` reads "<what went wrong>; <what to do>"; `location` is a file and place in it
/// ("views/03_04.png", "model.safetensors: byte 16", "config.json: $.train.batch") or empty.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::string location;
  Setting setting = Setting::kNone;  ///< what mends it, where a setting does

  /// "location: message", or just the message where there is no location.
  [[nodiscard]] std::string text() const;
};

/// Either a value or an Error. Reading the one that is not there breaks the contract and throws ContractError.
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
  /// By value, so that `for (auto& item : read().value())` does not walk a destroyed temporary.
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

 private:
  void require_ok() const {
    if (!ok()) throw ContractError("value() of a Result that holds an error: " + std::get<1>(state_).text());
  }
  std::variant<T, Error> state_;
};

/// Success, or an Error: `return {};` is success.
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

 private:
  std::optional<Error> error_;
};

}  // namespace e2lf

#define E2LF_CONCAT_INNER(a, b) a##b
#define E2LF_CONCAT(a, b) E2LF_CONCAT_INNER(a, b)

/// Returns the error of a Result<void> expression from the enclosing function.
#define E2LF_RETURN_IF_ERROR(expr)                                           \
  do {                                                                       \
    if (auto e2lf_status = (expr); !e2lf_status) return e2lf_status.error(); \
  } while (false)

/// `E2LF_ASSIGN_OR_RETURN(auto image, read_png(path));` takes the value or returns the error.
#define E2LF_ASSIGN_OR_RETURN(declaration, expr)                                                \
  auto E2LF_CONCAT(e2lf_result_, __LINE__) = (expr);                                            \
  if (!E2LF_CONCAT(e2lf_result_, __LINE__)) return E2LF_CONCAT(e2lf_result_, __LINE__).error(); \
  declaration = *std::move(E2LF_CONCAT(e2lf_result_, __LINE__))
