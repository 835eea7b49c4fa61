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

/// The destination of a writer's bytes, written from front to back.
class ByteSink {
 public:
  virtual ~ByteSink() = default;

  /// Appends bytes. Fails with kIo.
  [[nodiscard]] virtual Result<void> write(std::span<const uint8_t> bytes) = 0;

  /// Moves the output to its place; without this call, no file appears. Fails with kIo.
  [[nodiscard]] virtual Result<void> commit() = 0;

  /// Returns the name for messages.
  [[nodiscard]] virtual std::string name() const = 0;
};

using SinkPtr = std::unique_ptr<ByteSink>;

/// Opens a file that appears complete at commit() or not at all. "-" is standard output, from which nothing can be
/// withdrawn.
[[nodiscard]] Result<SinkPtr> open_file_sink(const std::filesystem::path& path);

/// Returns a sink that appends to `bytes`, which must outlive it.
[[nodiscard]] SinkPtr make_memory_sink(std::vector<uint8_t>& bytes);

/// Returns a sink for an open descriptor (pipe, socket), which is closed with the sink if `owned`.
[[nodiscard]] SinkPtr make_descriptor_sink(int descriptor, bool owned, std::string name);

}  // namespace e2lf::recordings
