// SPDX-License-Identifier: MIT
#include "bench/decode/benchmark_streams.h"

#include <algorithm>
#include <optional>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/result.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::bench {
namespace {

constexpr uint32_t kWidth = 1280, kHeight = 720;

/// Generates random events of a shape, with times that begin at a realistic value.
class Synthesis {
 public:
  explicit Synthesis(StreamShape shape) : shape_(shape) {}

  void fill(recordings::EventBatch& batch, size_t events) {
    batch.clear();
    while (batch.events.size() < events) add_row(batch.events);
  }

 private:
  uint32_t below(uint32_t bound) { return rng_.below(next_++, bound); }

  void add_row(recordings::EventColumns& events) {
    switch (shape_) {
      case StreamShape::kEvt3Dense:
        t_us_ += below(4) == 0 ? 1 : 0;
        return below(10) == 0 ? add_block(events, 0x00000311) : add_singles(events, 1 + below(6));
      case StreamShape::kEvt3Sparse:
        t_us_ += 16;
        return add_singles(events, 1);
      case StreamShape::kEvt2:
        t_us_ += below(10) == 0 ? 1 : 0;
        return add_singles(events, 1);
      case StreamShape::kEvt3Vector:
      case StreamShape::kEvt21:
        t_us_ += shape_ == StreamShape::kEvt3Vector ? 16 : below(2);
        return add_block(events, half_of_32());
    }
  }

  void add_singles(recordings::EventColumns& events, uint32_t count) {
    const auto y = static_cast<uint16_t>(below(kHeight));
    for (uint32_t i = 0; i < count; ++i) {
      events.push_back({static_cast<uint16_t>(below(kWidth)), y, static_cast<uint8_t>(below(2)), t_us_});
    }
  }

  void add_block(recordings::EventColumns& events, uint32_t mask) {
    const uint32_t base = 32 * below(kWidth / 32);
    const auto y = static_cast<uint16_t>(below(kHeight));
    const auto p = static_cast<uint8_t>(below(2));
    for (uint32_t i = 0; i < 32; ++i) {
      if (((mask >> i) & 1) != 0) events.push_back({static_cast<uint16_t>(base + i), y, p, t_us_});
    }
  }

  uint32_t half_of_32() {
    uint32_t mask = 0;
    for (uint32_t left = 32, wanted = 16; left > 0; --left) {
      const bool is_set = below(left) < wanted;
      mask = mask << 1 | (is_set ? 1 : 0);
      wanted -= is_set ? 1 : 0;
    }
    return mask;
  }

  StreamShape shape_;
  CounterRng rng_{1, 0};
  uint64_t next_ = 0;
  int64_t t_us_ = 5'000'000;
};

const char* encoding_of(StreamShape shape) {
  if (shape == StreamShape::kEvt2) return "evt2";
  return shape == StreamShape::kEvt21 ? "evt2.1" : "evt3";
}

/// The location of the time words of an encoding, needed to advance them.
struct TimeWords {
  size_t word_bytes = 0;
  size_t offset = 0;  ///< offset of the time within a word
  bool is_wide = false;

  [[nodiscard]] uint32_t mask() const {
    return is_wide ? recordings::timed::kTimeHighMask : recordings::evt3::kPayloadMask;
  }
  [[nodiscard]] uint32_t load(const uint8_t* word) const {
    return is_wide ? load_le<uint32_t>(word + offset) : load_le<uint16_t>(word + offset);
  }
  [[nodiscard]] bool is_time(const uint8_t* word) const {
    return is_wide ? load(word) >> 28 == recordings::timed::kTimeHigh : load(word) >> 12 == recordings::evt3::kTimeHigh;
  }
  void move(uint8_t* word, uint32_t steps) const {
    const uint32_t value = load(word);
    const uint32_t moved = (value & ~mask()) | ((value + steps) & mask());
    for (size_t i = 0; i < (is_wide ? 4 : 2); ++i) word[offset + i] = static_cast<uint8_t>(moved >> (8 * i));
  }
};

std::optional<TimeWords> time_words(const recordings::RawHeader& header, std::span<const uint8_t> payload) {
  if (header.info.format == "evt3") return TimeWords{2, 0, false};
  if (header.info.format == "evt2") return TimeWords{4, 0, true};
  if (header.info.format != "evt2.1") return std::nullopt;
  const bool is_little =
      recordings::timed::find_byte_order(payload, header.endianness) == recordings::timed::Encoding::kEvt21Little;
  return TimeWords{8, is_little ? size_t{4} : size_t{0}, true};
}

Result<uint64_t> count_events(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto reader, recordings::open_recording(path));
  recordings::EventBatch batch;
  for (bool more = true; more;) {
    E2LF_ASSIGN_OR_RETURN(more, reader->read(batch));
  }
  return reader->summary().events();
}

/// Returns the whole words of a recording from its first time word on.
std::span<const uint8_t> words_from_time(std::span<const uint8_t> payload, const TimeWords& time) {
  size_t begin = 0;
  while (begin + time.word_bytes <= payload.size() && !time.is_time(&payload[begin])) begin += time.word_bytes;
  const size_t words = begin < payload.size() ? (payload.size() - begin) / time.word_bytes : 0;
  return payload.subspan(std::min(begin, payload.size()), words * time.word_bytes);
}

}  // namespace

const char* shape_name(StreamShape shape) {
  switch (shape) {
    case StreamShape::kEvt3Dense:
      return "evt3 dense";
    case StreamShape::kEvt3Sparse:
      return "evt3 sparse";
    case StreamShape::kEvt3Vector:
      return "evt3 vector";
    case StreamShape::kEvt2:
      return "evt2";
    case StreamShape::kEvt21:
      return "evt2.1";
  }
  E2LF_REQUIRE(false, "a shape without a name");
}

BenchmarkStream synthesise_stream(StreamShape shape, uint64_t events) {
  BenchmarkStream stream;
  stream.shape = shape_name(shape);
  stream.source = "synthesised";
  recordings::RecordingInfo info;
  info.width = kWidth;
  info.height = kHeight;
  auto writer = recordings::create_recording(recordings::make_memory_sink(stream.bytes), encoding_of(shape), info);
  Synthesis synthesis(shape);
  recordings::EventBatch batch;
  bool is_written = writer.ok();
  for (uint64_t done = 0; is_written && done < events; done += batch.events.size()) {
    synthesis.fill(batch, static_cast<size_t>(std::min<uint64_t>(events - done, 1 << 16)));
    is_written = (*writer)->write(batch).ok();
  }
  E2LF_REQUIRE(is_written && (*writer)->finish(), "writing to memory cannot fail");
  return stream;
}

Result<BenchmarkStream> repeat_recording(const std::filesystem::path& path, uint64_t events) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  const auto unsupported = [&path](const char* what) {
    return Error{ErrorCode::kUnsupported, cat(what, "; give a RAW recording with events"), path.string()};
  };
  if (!recordings::is_raw_header(file)) return unsupported("decoding is measured with RAW recordings");
  E2LF_ASSIGN_OR_RETURN(const uint64_t events_of_one, count_events(path));
  E2LF_ASSIGN_OR_RETURN(const recordings::RawHeader header, recordings::parse_raw_header(file, true, path.string()));
  const auto payload = std::span(file).subspan(header.num_bytes);
  const auto time = time_words(header, payload);
  const auto words = time ? words_from_time(payload, *time) : std::span<const uint8_t>();
  if (words.empty() || events_of_one == 0) return unsupported("the recording has no events or no times");

  const uint8_t* last = &words.back() + 1 - time->word_bytes;
  while (!time->is_time(last)) last -= time->word_bytes;
  const uint32_t period = (time->load(last) - time->load(words.data()) + 1) & time->mask();
  BenchmarkStream stream;
  const uint64_t copies = std::max<uint64_t>((events + events_of_one / 2) / events_of_one, 1);
  stream.shape = header.info.format;
  stream.source = cat(path.filename().string(), ", ", copies, " times");
  stream.bytes.assign(file.begin(), file.begin() + static_cast<ptrdiff_t>(header.num_bytes));
  stream.bytes.reserve(header.num_bytes + copies * words.size());
  for (uint64_t copy = 0; copy < copies; ++copy) {
    const size_t begin = stream.bytes.size();
    stream.bytes.insert(stream.bytes.end(), words.begin(), words.end());
    for (size_t i = begin; i < stream.bytes.size(); i += time->word_bytes) {
      if (time->is_time(&stream.bytes[i])) time->move(&stream.bytes[i], static_cast<uint32_t>(copy * period));
    }
  }
  return stream;
}

}  // namespace e2lf::bench
