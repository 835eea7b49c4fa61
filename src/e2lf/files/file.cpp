// SPDX-License-Identifier: MIT
#include "e2lf/files/file.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/files/workspace.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::milliseconds kReaderPoll(20);  // the longest delay of a stop while a pipe has no reader

/// Writes all bytes to a descriptor and closes it.
Result<void> write_and_close(int descriptor, const fs::path& path, std::span<const uint8_t> bytes) {
  const Result<void> status = write_all(descriptor, path, bytes);
  if (::close(descriptor) != 0 && status) return fail_to("write", path, errno);
  return status;
}

}  // namespace

Result<void> write_all(int descriptor, const fs::path& path, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<size_t>(written));
    } else if (errno != EINTR) {
      return fail_to("write", path, errno);
    }
  }
  return {};
}

Result<std::vector<uint8_t>> read_head(const fs::path& path, size_t most) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return fail_to("open", path, errno);
  struct stat info {};
  std::vector<uint8_t> bytes;
  if (::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode)) {
    bytes.reserve(std::min(most, static_cast<size_t>(info.st_size) + 1));
  }
  constexpr size_t kChunk = size_t{1} << 20;
  while (bytes.size() < most) {
    const size_t filled = bytes.size();
    bytes.resize(std::min(most, std::max(bytes.capacity(), filled + kChunk)));
    const ssize_t count = ::read(descriptor, bytes.data() + filled, bytes.size() - filled);
    const int error_number = errno;
    bytes.resize(filled + (count > 0 ? static_cast<size_t>(count) : 0));
    if (count == 0) break;
    if (count < 0 && error_number != EINTR) {
      ::close(descriptor);
      return fail_to("read", path, error_number);
    }
  }
  ::close(descriptor);
  return bytes;
}

Result<std::vector<uint8_t>> read_file(const fs::path& path) {
  return read_head(path, std::numeric_limits<size_t>::max());
}

bool is_stream(const fs::path& path) {
  std::error_code error;
  return fs::is_other(fs::status(path, error)) && !error;
}

Result<int> open_stream(const fs::path& path) {
  std::error_code ignored;
  // Opening a named pipe would block in the kernel, and a signal that arrives just before would have no effect.
  const int waiting = fs::is_fifo(path, ignored) ? O_NONBLOCK : 0;
  for (;;) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | waiting);
    if (descriptor >= 0) {
      if (waiting != 0) ::fcntl(descriptor, F_SETFL, 0);  // writes block again
      return descriptor;
    }
    const bool has_no_reader = errno == ENXIO && waiting != 0;
    if (errno != EINTR && !has_no_reader) return fail_to("write", path, errno);
    if (stop_requested()) {
      return fail(ErrorCode::kCancelled, path,
                  "no program read from here before the run was stopped; start the reader first");
    }
    if (has_no_reader) std::this_thread::sleep_for(kReaderPoll);
  }
}

Result<void> write_file(const fs::path& path, std::span<const uint8_t> bytes) {
  if (is_stream(path)) {
    E2LF_ASSIGN_OR_RETURN(const int descriptor, open_stream(path));
    return write_and_close(descriptor, path, bytes);
  }
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  const int descriptor = ::open(file.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return fail_to("write", path, errno);
  // The lock shows that the writer is alive; see remove_dead_parts().
  static_cast<void>(::flock(descriptor, LOCK_EX | LOCK_NB));
  E2LF_RETURN_IF_ERROR(write_and_close(descriptor, path, bytes));
  return file.commit();
}

Result<void> write_file(const fs::path& path, const std::string& text) {
  return write_file(path, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

Result<void> check_output(const fs::path& path, bool overwrite) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return fail(ErrorCode::kExists, path, "the output is a file, and a folder has this name; choose another");
  }
  if (!overwrite && !is_stream(path) && is_there(path)) {
    return Error{ErrorCode::kExists, "the output exists already; replace it or choose another", path.string(),
                 "overwrite"};
  }
  return {};
}

Result<AtomicFile> AtomicFile::create(const fs::path& target) {
  if (is_stream(target)) {
    return fail(ErrorCode::kUnsupported, target,
                "this is a device or a pipe, but the format requires seeking; give a file");
  }
  std::error_code error;
  if (target.has_parent_path()) fs::create_directories(target.parent_path(), error);
  if (error) return fail_to("make the folder", target.parent_path(), error.value());
  static int counter = 0;
  fs::path staging = target.has_filename() ? target : target.parent_path();
  staging += cat(".", ::getpid(), ".", __atomic_add_fetch(&counter, 1, __ATOMIC_RELAXED), ".part");
  return AtomicFile(target, std::move(staging));
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)), staging_(std::exchange(other.staging_, fs::path())) {}

AtomicFile::~AtomicFile() {
  if (!staging_.empty()) ::unlink(staging_.c_str());
}

Result<void> AtomicFile::commit() {
  if (::rename(staging_.c_str(), target_.c_str()) != 0) return fail_to("write", target_, errno);
  staging_.clear();
  return {};
}

}  // namespace e2lf
