// SPDX-License-Identifier: MIT
#include "e2lf/files/file.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"

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
  if (is_folder(path)) {
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

namespace {

constexpr char kLock[] = "e2lf.lock";
constexpr char kLive[] = "e2lf.live";  ///< marks a workspace whose content cannot be created again
constexpr size_t kLongestStem = 200;   ///< in bytes; file systems allow 255 for a name

/// Returns the common beginning of the names of all workspaces of a target.
std::string stem_of(const fs::path& target) {
  return target.filename().string().substr(0, kLongestStem) + ".";
}

bool is_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Returns true if a name is `stem` followed by PID.N.part.
bool is_workspace_name(const std::string& name, const std::string& stem) {
  constexpr std::string_view kEnd = ".part";
  if (name.size() <= stem.size() + kEnd.size() || !name.starts_with(stem) || !name.ends_with(kEnd)) return false;
  const std::string numbers = name.substr(stem.size(), name.size() - stem.size() - kEnd.size());
  const size_t dot = numbers.find('.');
  return dot != std::string::npos && is_digits(numbers.substr(0, dot)) && is_digits(numbers.substr(dot + 1));
}

/// Closes a descriptor at the end of a scope, which also releases its lock.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] bool locks(int how) const { return number_ >= 0 && ::flock(number_, how) == 0; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

Descriptor open_lock(const fs::path& workspace, int flags) {
  return Descriptor(::open((workspace / kLock).c_str(), flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666));
}

/// Removes the abandoned workspaces of a target, but for those of live input. Fails if one is in use.
Result<void> clear_dead(const fs::path& target) {
  const std::string stem = stem_of(target);
  std::error_code error;
  for (const fs::path& workspace : paths_in(folder_of(target))) {
    if (!is_workspace_name(workspace.filename().string(), stem)) continue;
    if (!fs::is_directory(fs::symlink_status(workspace, error))) continue;
    const Descriptor lock = open_lock(workspace, 0);
    if (!lock.is_open()) continue;  // a folder of that name that is not a workspace
    if (!lock.locks(LOCK_EX | LOCK_NB)) {
      const std::string name = workspace.filename().string();
      // This run itself holds the lock.
      if (without_workspaces(name) != name) {
        return fail(ErrorCode::kInvalidValue, target, "two outputs have this name; give each its own");
      }
      return fail(ErrorCode::kExists, target, "another run is writing this output (in ", name,
                  "); wait for it or choose another output");
    }
    if (is_present(workspace / kLive)) {
      log_warning(
          cat(workspace.string(),
              ": an interrupted run left its data of a live input here; move them, e.g. to recovered.npz, and read ",
              "what is complete, or remove them"));
      continue;
    }
    fs::remove_all(workspace, error);
    log_warning(cat(workspace.string(), ": removed; it was left by an interrupted run"));
  }
  return {};
}

}  // namespace

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

bool is_present(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::vector<fs::path> paths_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    paths.push_back(entry->path());
  }
  std::ranges::sort(paths);
  return paths;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void remove_dead_parts(const fs::path& folder) {
  std::error_code error;
  for (const fs::path& part : paths_in(folder)) {
    const std::string target = part.stem().stem().stem().string();
    if (target.empty() || !is_workspace_name(part.filename().string(), target + ".")) continue;
    if (!fs::is_regular_file(fs::symlink_status(part, error))) continue;
    const Descriptor lock(::open(part.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (!lock.is_open() || !lock.locks(LOCK_EX | LOCK_NB)) continue;
    fs::remove(part, error);
    log_warning(cat(part.string(), ": removed; it was left by an interrupted run"));
  }
}

std::string without_workspaces(std::string text) {
  constexpr std::string_view kEnd = ".part";
  const std::string own = cat(".", ::getpid(), ".");
  for (size_t at = 0; (at = text.find(own, at)) != std::string::npos;) {
    size_t end = text.find_first_not_of("0123456789", at + own.size());
    if (end == std::string::npos || text.compare(end, kEnd.size(), kEnd) != 0) {
      at += own.size();
      continue;
    }
    end += kEnd.size();
    size_t begin = at;
    if (end < text.size() && text[end] == '/') {
      begin = text.rfind('/', at) + 1;  // 0 if there is none
      ++end;
    }
    text.erase(begin, end - begin);
    at = begin;
  }
  return text;
}

Result<Workspace> Workspace::create(const fs::path& target, bool is_live) {
  static int counter = 0;
  std::error_code error;
  const fs::path folder = folder_of(target);
  fs::create_directories(folder, error);
  if (error) return fail_to("make the folder", folder, error.value());
  // Only one process at a time looks for other workspaces and makes its own. Where folders cannot be locked, two
  // processes that start at the same moment may both continue; the one that ends later then finds that the output
  // exists.
  const Descriptor turn(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  static_cast<void>(turn.locks(LOCK_EX));
  E2LF_RETURN_IF_ERROR(clear_dead(target));
  const int number = __atomic_add_fetch(&counter, 1, __ATOMIC_RELAXED);
  const fs::path path = folder / cat(stem_of(target), ::getpid(), ".", number, ".part");
  fs::create_directory(path, error);
  if (error) return fail_to("write here", target, error.value());
  Descriptor lock = open_lock(path, O_CREAT);
  if (!lock.is_open()) {
    const int error_number = errno;
    fs::remove(path, error);
    return fail_to("write here", target, error_number);
  }
  static_cast<void>(lock.locks(LOCK_EX | LOCK_NB));
  if (is_live) E2LF_RETURN_IF_ERROR(write_file(path / kLive, std::string("live\n")));
  return Workspace(path, lock.release());
}

Workspace::Workspace(Workspace&& other) noexcept
    : path_(std::exchange(other.path_, fs::path())), lock_(std::exchange(other.lock_, -1)) {}

Workspace& Workspace::operator=(Workspace&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(lock_, other.lock_);
  return *this;
}

Workspace::~Workspace() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Removes the digits at the front, and returns them without leading zeros.
std::string_view take_digits(std::string_view& text) {
  const size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

/// Removes a minus at the front that is the sign of a number, and returns whether there was one.
bool take_minus(std::string_view& text, char previous) {
  const bool is_word =
      is_digit(previous) || (previous >= 'a' && previous <= 'z') || (previous >= 'A' && previous <= 'Z');
  if (is_word || text.size() < 2 || text[0] != '-' || !is_digit(text[1])) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

bool is_before_in_number_order(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string first = a.filename().string(), second = b.filename().string();
  std::string_view x = first, y = second;
  char previous = 0;  // the last character that both names share
  while (!x.empty() && !y.empty()) {
    const bool is_x_negative = take_minus(x, previous), is_y_negative = take_minus(y, previous);
    if (is_digit(x[0]) && is_digit(y[0])) {
      if (is_x_negative != is_y_negative) return is_x_negative;
      const std::string_view m = take_digits(x), n = take_digits(y);
      if (m != n) return (m.size() != n.size() ? m.size() < n.size() : m < n) != is_x_negative;
      previous = '0';
      continue;
    }
    if (is_x_negative || is_y_negative) return is_x_negative;
    if (x[0] != y[0]) return x[0] < y[0];
    previous = x[0];
    x.remove_prefix(1);
    y.remove_prefix(1);
  }
  if (x.empty() != y.empty()) return x.empty();
  return first < second;  // 01 and 1 are different names
}

}  // namespace e2lf
