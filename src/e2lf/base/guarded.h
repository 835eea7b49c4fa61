// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <thread>
#include <type_traits>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf {

/// Calls `work`, which returns void or a Result, and returns its result. An exception, such as a ContractError or a
/// lack of memory, becomes an Error of kInternal.
template <typename Work>
auto guarded(Work&& work) {
  using Returned = std::invoke_result_t<Work>;
  using Guarded = std::conditional_t<std::is_void_v<Returned>, Result<void>, Returned>;
  try {
    if constexpr (std::is_void_v<Returned>) {
      std::forward<Work>(work)();
      return Guarded();
    } else {
      return Guarded(std::forward<Work>(work)());
    }
  } catch (const std::exception& error) {
    return Guarded(fail(ErrorCode::kInternal, "", "internal error: ", error.what(),
                        "; please report it with the command you ran"));
  } catch (...) {
    return Guarded(fail(ErrorCode::kInternal, "", "internal error of an unknown kind",
                        "; please report it with the command you ran"));
  }
}

/// Starts a thread that calls guarded(work), then `on_error` with the error if there is one, and then `at_end` in every
/// case. An exception in `on_error` or `at_end` ends the process.
template <typename Work, typename OnError, typename AtEnd>
[[nodiscard]] std::thread guarded_thread(Work work, OnError on_error, AtEnd at_end) {
  return std::thread([work = std::move(work), on_error = std::move(on_error), at_end = std::move(at_end)]() mutable {
    if (const auto done = guarded(work); !done) on_error(done.error());
    at_end();
  });
}

}  // namespace e2lf
