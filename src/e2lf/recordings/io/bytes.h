// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// Returns bytes as text, and text as bytes.
[[nodiscard]] inline std::string_view as_text(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline std::span<const uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

/// Number of bytes at the start of a source from which its format is detected.
inline constexpr size_t kDetectBytes = 4096;

/// Bytes that are read from front to back: a file, memory, a pipe or a socket. Memory use is bounded by the size of the
/// requests.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// Returns the available unread bytes, possibly more than `wanted`, and fewer only at the end of the source. The span
  /// is valid until the next call of fetch() or seek(). A live source waits only until `wanted` bytes are available, so
  /// that fetch(1) returns what has arrived. An empty span is the end. Fails with kIo.
  [[nodiscard]] virtual Result<std::span<const uint8_t>> fetch(size_t wanted) = 0;

  /// Removes the first `count` bytes that fetch() returned.
  virtual void consume(size_t count) = 0;

  /// Returns the number of bytes that were consumed since the start of the source.
  [[nodiscard]] virtual uint64_t position() const = 0;

  /// Seeks to a byte counted from the start. Fails with kUnsupported (a pipe or socket) and kIo.
  [[nodiscard]] virtual Result<void> seek(uint64_t position) = 0;
  [[nodiscard]] virtual bool seekable() const = 0;

  /// Returns the length in bytes if it is known. A file may still grow.
  [[nodiscard]] virtual std::optional<uint64_t> size() const = 0;

  /// Returns when the newest bytes that fetch() returned arrived at this host, or nothing for sources that are not live
  /// (a file).
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return std::nullopt; }

  /// Continues after a place where bytes are missing, at which fetch() ended. Returns false if the source itself has
  /// ended.
  [[nodiscard]] virtual bool pass_break() { return false; }

  /// Returns what was left out of the recording before its bytes reached this source; see Camera::left_out().
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }

  /// Returns the name for messages ("recording.raw", "memory", "stdin").
  [[nodiscard]] virtual std::string name() const = 0;

  /// Returns the file of the source, for libraries that open files themselves, or an empty path if there is none.
  [[nodiscard]] virtual std::filesystem::path path() const { return {}; }
};

using SourcePtr = std::shared_ptr<ByteSource>;

/// Opens a file; "-" is standard input. Fails with kNotFound and kIo (a folder, no permission).
[[nodiscard]] Result<SourcePtr> open_file_source(const std::filesystem::path& path);

/// Returns a source of bytes that the caller keeps alive, without copying them, or of bytes that the source owns.
[[nodiscard]] SourcePtr make_memory_source(std::span<const uint8_t> bytes, std::string name = "memory");
[[nodiscard]] SourcePtr make_memory_source(std::vector<uint8_t>&& bytes, std::string name = "memory");

/// Returns a source for an open descriptor (pipe, socket, file), which is closed with the source if `owned`.
[[nodiscard]] SourcePtr make_descriptor_source(int descriptor, bool owned, std::string name);

/// Reads the rest of a source. Fails with kUnsupported if it exceeds `limit` bytes.
[[nodiscard]] Result<std::vector<uint8_t>> read_rest(ByteSource& source, size_t limit = size_t{1} << 32);

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
