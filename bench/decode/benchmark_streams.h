// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::bench {

/// A RAW recording in memory, header included, for decoder benchmarks.
struct BenchmarkStream {
  std::string shape;   ///< "evt3 dense"
  std::string source;  ///< its source: "recording.raw, 240 times" or "synthesised"
  std::vector<uint8_t> bytes;
};

/// The shapes of streams for which decoders differ.
enum class StreamShape {
  kEvt3Dense,   ///< a busy scene: several single events in a sensor row, occasionally a short vector
  kEvt3Sparse,  ///< a quiet scene: time words for nearly every event
  kEvt3Vector,  ///< vectors with 16 of 32 pixels set, each at its own time
  kEvt2,        ///< ten events per microsecond
  kEvt21,       ///< words with 16 of 32 pixels set
};
inline constexpr StreamShape kStreamShapes[] = {StreamShape::kEvt3Dense, StreamShape::kEvt3Sparse,
                                                StreamShape::kEvt3Vector, StreamShape::kEvt2, StreamShape::kEvt21};

/// Returns the name of a shape, e.g. "evt3 dense".
[[nodiscard]] const char* shape_name(StreamShape shape);

/// Returns a stream of about `events` random events in this shape, which is the same at every call.
[[nodiscard]] BenchmarkStream synthesise_stream(StreamShape shape, uint64_t events);

/// Repeats a RAW recording until it has about `events` events. Its words are copied and their time words are advanced,
/// so that time increases from copy to copy. Fails as opening and reading it does, and with kUnsupported if it is not
/// RAW or has no time words.
[[nodiscard]] Result<BenchmarkStream> repeat_recording(const std::filesystem::path& path, uint64_t events);

}  // namespace e2lf::bench
