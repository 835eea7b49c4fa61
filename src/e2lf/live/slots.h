// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>

/// How the threads of a session pass on what they made.
namespace e2lf::live {

/// Passes values from one thread to another without a queue: the slot holds only the newest value. Values are swapped
/// rather than copied, so that their memory is reused.
template <typename T>
class NewestSlot {
 public:
  /// Swaps `value` with the content of the slot. Returns true if the previous content had not been taken.
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

  /// Waits for a value and swaps it into `value`. Returns false once the slot is closed and empty.
  [[nodiscard]] bool take(T& value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_full_ || is_closed_; });
    if (!is_full_) return false;
    std::swap(value, value_);
    is_full_ = false;
    return true;
  }

  /// Declares that no further values will follow. A value in the slot can still be taken.
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

/// Holds the newest result of a thread, for which others wait.
template <typename T>
class Published {
 public:
  using Value = std::shared_ptr<const T>;

  void put(Value value) {
    {
      const std::lock_guard lock(mutex_);
      newest_ = std::move(value);
    }
    changed_.notify_all();
  }

  /// Returns the newest value, or null if there is none.
  [[nodiscard]] Value newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

  /// Waits up to `patience`, or until close(), for a value that is wanted. Returns null if the newest one is not.
  template <typename IsWanted>
  [[nodiscard]] Value wait(std::chrono::milliseconds patience, const IsWanted& is_wanted) const {
    std::unique_lock lock(mutex_);
    const auto has_wanted = [&] { return newest_ && is_wanted(*newest_); };
    changed_.wait_for(lock, patience, [&] { return is_closed_ || has_wanted(); });
    return has_wanted() ? newest_ : nullptr;
  }

  /// Ends all waiting, now and later.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  Value newest_;
  bool is_closed_ = false;
};

}  // namespace e2lf::live
