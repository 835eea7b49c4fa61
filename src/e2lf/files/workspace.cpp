// SPDX-License-Identifier: MIT
#include "e2lf/files/workspace.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

constexpr char kLock[] = "e2lf.lock";
constexpr char kLive[] = "e2lf.live";  ///< marks a workspace whose content cannot be created again
constexpr size_t kLongestStem = 200;   ///< in bytes; file systems allow 255 for a name

fs::path folder_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

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
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (!is_workspace_name(entry->path().filename().string(), stem)) continue;
    if (fs::is_directory(entry->symlink_status(ignored))) found.push_back(entry->path());
  }
  for (const fs::path& workspace : found) {
    const Descriptor lock = open_lock(workspace, 0);
    if (!lock.is_open()) continue;  // a folder of that name that is not a workspace
    if (!lock.locks(LOCK_EX | LOCK_NB)) {
      return fail(ErrorCode::kExists, target, "another run is writing this output (in ", workspace.filename().string(),
                  "); wait for it or choose another output");
    }
    if (fs::exists(workspace / kLive, error)) {
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

void remove_dead_parts(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    const std::string name = entry->path().filename().string();
    const std::string target = entry->path().stem().stem().stem().string();
    const bool is_part = !target.empty() && is_workspace_name(name, target + ".");
    if (is_part && fs::is_regular_file(entry->symlink_status(ignored))) found.push_back(entry->path());
  }
  for (const fs::path& part : found) {
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

}  // namespace e2lf
