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
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// The first bytes of a source, by which its format is told.
inline constexpr size_t kDetectBytes = 4096;

/// Bytes read from front to back: a file, memory, a pipe or a socket. Memory use is bounded by what is asked for.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// The unread bytes at hand, at least `wanted` of them unless the source ends sooner; maybe more. The span is valid
  /// until the next call of fetch() or seek(). A live source waits only until `wanted` bytes are there, so fetch(1)
  /// returns what has arrived; an empty span is the end. Fails with kIo.
  [[nodiscard]] virtual Result<std::span<const uint8_t>> fetch(size_t wanted) = 0;

  /// Drops the first `count` of the bytes that fetch() returned.
  virtual void consume(size_t count) = 0;

  /// How many bytes have been consumed since the start of the source.
  [[nodiscard]] virtual uint64_t position() const = 0;

  /// Goes to a byte counted from the start. Fails with kUnsupported (a pipe or socket) and kIo.
  [[nodiscard]] virtual Result<void> seek(uint64_t position) = 0;
  [[nodiscard]] virtual bool seekable() const = 0;

  /// The length in bytes, where it is known; a file may still grow.
  [[nodiscard]] virtual std::optional<uint64_t> size() const = 0;

  /// When the newest bytes that fetch() returned arrived at this host; nothing where that means nothing (a file).
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return std::nullopt; }

  /// Goes on behind a place where bytes are missing, at which fetch() ended. False where the source itself has ended.
  [[nodiscard]] virtual bool pass_break() { return false; }

  /// What was left out of the recording before its bytes came here; see Camera::left_out().
  [[nodiscard]] virtual DecodeSummary left_out() const { return {}; }

  /// The name for messages ("recording.raw", "memory", "stdin").
  [[nodiscard]] virtual std::string name() const = 0;

  /// The file behind the source, for libraries that open files themselves; empty when there is none.
  [[nodiscard]] virtual std::filesystem::path path() const { return {}; }

  /// The name that the bytes would have as a file: its extension may tell the format, and other files lie beside it.
  /// path(), or of a file that is unpacked its name without ".gz"; empty when there is none.
  [[nodiscard]] virtual std::filesystem::path logical_path() const { return path(); }
};

/// Opens a file; "-" is standard input. Fails with kNotFound and kIo (a folder, no permission).
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_file_source(const std::filesystem::path& path);

/// Bytes that the caller keeps alive, without a copy; or bytes that the source owns.
[[nodiscard]] std::unique_ptr<ByteSource> make_memory_source(std::span<const uint8_t> bytes,
                                                             std::string name = "memory");
[[nodiscard]] std::unique_ptr<ByteSource> make_memory_source(std::vector<uint8_t>&& bytes, std::string name = "memory");

/// An open descriptor (pipe, socket, file), closed with the source when `owned`.
[[nodiscard]] std::unique_ptr<ByteSource> make_descriptor_source(int descriptor, bool owned, std::string name);

/// Everything from here to the end. Fails with kUnsupported beyond `limit` bytes.
[[nodiscard]] Result<std::vector<uint8_t>> read_rest(ByteSource& source, size_t limit = size_t{1} << 32);

}  // namespace e2lf::recordings
