// SPDX-License-Identifier: MIT
#include "e2lf/compare/external.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::compare {
namespace fs = std::filesystem;
namespace {

/// A folder for the files that are exchanged with the program; removed at the end.
class ExchangeFolder {
 public:
  ExchangeFolder() : path_((fs::temp_directory_path() / "e2lf-external-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ExchangeFolder(const ExchangeFolder&) = delete;
  ExchangeFolder& operator=(const ExchangeFolder&) = delete;
  ~ExchangeFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }

  [[nodiscard]] bool exists() const { return !path_.empty(); }
  [[nodiscard]] fs::path file(const char* name) const { return fs::path(path_) / name; }

 private:
  std::string path_;
};

Result<pid_t> start(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);  // stdout holds the results of e2lf
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, arguments.front(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return child;
  return fail(ErrorCode::kNotFound, words.front(), "the program cannot be started (", std::strerror(error),
              "); correct the command");
}

Result<void> wait_for(pid_t child, const std::string& program) {
  constexpr auto kPoll = std::chrono::milliseconds(10);
  constexpr int kPatience = 500;  // polls from the request to stop until the program is killed
  int status = 0, polls = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (stop_requested()) ::kill(child, ++polls > kPatience ? SIGKILL : SIGTERM);
    std::this_thread::sleep_for(kPoll);
  }
  if (stop_requested()) return fail(ErrorCode::kCancelled, program, "the program was stopped");
  if (WIFSIGNALED(status)) {
    return fail(ErrorCode::kUnsupported, program, "the program was ended by signal ", WTERMSIG(status),
                "; run it alone with the events of one scene");
  }
  if (WEXITSTATUS(status) == 0) return {};
  return fail(ErrorCode::kUnsupported, program, "the program ended with exit code ", WEXITSTATUS(status),
              "; its messages are above");
}

}  // namespace

Result<lightfield::LightField> run_external(const std::vector<std::string>& command,
                                            const capture::EventImageFile& events) {
  const ExchangeFolder folder;
  if (!folder.exists())
    return fail(ErrorCode::kIo, fs::temp_directory_path(),
                "cannot create a folder there; set TMPDIR to one that can be written");
  const fs::path input = folder.file("events.npz"), output = folder.file("light_field.npy");
  E2LF_RETURN_IF_ERROR(capture::write_event_images(input, events));
  std::vector<std::string> words = command;
  words.insert(words.end(), {input.string(), output.string()});
  E2LF_ASSIGN_OR_RETURN(const pid_t child, start(std::move(words)));
  E2LF_RETURN_IF_ERROR(wait_for(child, command.front()));
  std::error_code error;
  if (!fs::exists(output, error)) {
    return fail(ErrorCode::kNotFound, command.front(),
                "the program wrote no light field; write it to the last argument as .npy, float32 [8, 8, y, x]");
  }
  lightfield::ReadOptions options;
  options.range = lightfield::RangePolicy::kKeep;
  return lightfield::read_light_field(output, options);
}

}  // namespace e2lf::compare
