// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// Where a writer puts its bytes, front to back.
class ByteSink {
 public:
  virtual ~ByteSink() = default;

  /// Appends bytes. Fails with kIo.
  [[nodiscard]] virtual Result<void> write(std::span<const uint8_t> bytes) = 0;

  /// Puts the output in place; without it a file does not appear. Fails with kIo.
  [[nodiscard]] virtual Result<void> commit() = 0;

  /// The name for messages.
  [[nodiscard]] virtual std::string name() const = 0;
};

/// A file that appears whole at commit() or not at all; "-" is standard output (nothing to take back there).
[[nodiscard]] Result<std::unique_ptr<ByteSink>> open_file_sink(const std::filesystem::path& path);

/// Appends to `bytes`, which must outlive the sink.
[[nodiscard]] std::unique_ptr<ByteSink> make_memory_sink(std::vector<uint8_t>& bytes);

/// An open descriptor (pipe, socket), closed with the sink when `owned`.
[[nodiscard]] std::unique_ptr<ByteSink> make_descriptor_sink(int descriptor, bool owned, std::string name);

}  // namespace e2lf::recordings
