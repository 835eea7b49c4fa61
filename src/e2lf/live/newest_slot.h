// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>

namespace e2lf::live {

/// Passes values from one thread to another without a queue: it holds the newest one alone. Values are exchanged, so
/// that their memory is used again and again.
template <typename T>
class NewestSlot {
 public:
  /// Puts `value` into the slot and leaves in its place what lay there before. Returns true if that was never taken.
  bool put(T& value) {
    bool was_full = false;
    {
      const std::lock_guard lock(mutex_);
      std::swap(value, value_);
      was_full = std::exchange(is_full_, true);
    }
    changed_.notify_one();
    return was_full;
  }

  /// Waits for a value and exchanges it for `value`. Returns false once the slot is closed and empty.
  [[nodiscard]] bool take(T& value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_full_ || is_closed_; });
    if (!is_full_) return false;
    std::swap(value, value_);
    is_full_ = false;
    return true;
  }

  /// Declares that nothing more will come. What lies in the slot can still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  T value_{};
  bool is_full_ = false, is_closed_ = false;
};

}  // namespace e2lf::live
