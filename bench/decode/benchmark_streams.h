// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::bench {

/// A RAW recording in memory, header included, to measure decoders with.
struct BenchmarkStream {
  std::string shape;   ///< "evt3 dense"
  std::string source;  ///< what it was made of: "recording.raw, 240 times" or "synthesised"
  std::vector<uint8_t> bytes;
};

/// The shapes of streams that decoders differ on.
enum class StreamShape {
  kEvt3Dense,   ///< a busy scene: several single events in a row of the sensor, now and then a short vector
  kEvt3Sparse,  ///< a quiet one: time words for nearly every event
  kEvt3Vector,  ///< vectors with 16 of 32 pixels set, each at a time of its own
  kEvt2,        ///< ten events per microsecond
  kEvt21,       ///< words with 16 of 32 pixels set
};
inline constexpr StreamShape kStreamShapes[] = {StreamShape::kEvt3Dense, StreamShape::kEvt3Sparse,
                                                StreamShape::kEvt3Vector, StreamShape::kEvt2, StreamShape::kEvt21};

/// "evt3 dense", ...
[[nodiscard]] const char* shape_name(StreamShape shape);

/// A stream of about `events` random events in that shape, the same at every call.
[[nodiscard]] BenchmarkStream synthesise_stream(StreamShape shape, uint64_t events);

/// A RAW recording repeated until it has about `events` events: its words are copied and their time words moved on, so
/// that the clock goes on from copy to copy. Fails as opening and reading it does, and with kUnsupported when it is not
/// RAW or has no time words.
[[nodiscard]] Result<BenchmarkStream> repeat_recording(const std::filesystem::path& path, uint64_t events);

}  // namespace e2lf::bench
