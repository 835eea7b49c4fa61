// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <unistd.h>

namespace e2lf::fuzz {

/// A folder of this process for readers that take a path, removed at the end. run.sh keeps temporary files in memory.
class ScratchFolder {
 public:
  ScratchFolder() : path_(std::filesystem::temp_directory_path() / ("e2lf_fuzz_" + std::to_string(::getpid()))) {
    clear();
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  /// Leaves it empty.
  void clear() const {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }

  /// Writes a file without the care that results need, and so quickly.
  std::filesystem::path put(const std::string& name, std::span<const uint8_t> bytes) const {
    std::ofstream(path_ / name, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The first byte of an input chooses among `count`; the rest is what is read.
inline size_t take_choice(std::span<const uint8_t>& input, size_t count) {
  if (input.empty()) return 0;
  const size_t choice = input[0] % count;
  input = input.subspan(1);
  return choice;
}

}  // namespace e2lf::fuzz
