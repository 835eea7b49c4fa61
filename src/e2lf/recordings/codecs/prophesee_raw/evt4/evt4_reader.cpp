// SPDX-License-Identifier: MIT
// Reads EVT4; declared in codecs.h.
#include <bit>
#include <utility>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::evt4 {
namespace {

constexpr size_t kWordBytes = 4;
constexpr size_t kBlockBytes = size_t{1} << 17;

/// The type in bits 31..28 of a word.
enum Type : uint32_t {
  kOthers = 0x6,
  kContinued = 0x7,
  kTrigger = 0x9,
  kOff = 0xA,
  kOn = 0xB,
  kVectorOff = 0xC,  ///< a second word states which of the 32 pixels from x on have an event
  kVectorOn = 0xD,
  kTimeHigh = 0xE,
  kPadding = 0xF
};

class Evt4Blocks final : public EventBlocks {
 public:
  explicit Evt4Blocks(SourcePtr source) : source_(std::move(source)), header_bytes_(source_->position()) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(source_->seekable() ? kBlockBytes : 2 * kWordBytes));
    const size_t count = std::min(bytes.size(), kBlockBytes) / kWordBytes;
    const auto word_at = [&](size_t i) { return load_le<uint32_t>(&bytes[i * kWordBytes]); };
    size_t i = 0;
    for (; i < count; ++i) {
      const uint32_t word = word_at(i), type = word >> 28;
      const bool is_vector = type == kVectorOff || type == kVectorOn;
      if (is_vector && i + 1 == count) break;
      if (type == kOff || type == kOn) {
        append(word, 1, block.events, summary);
      } else if (is_vector) {
        append(word, word_at(++i), block.events, summary);
      } else if (type == kTimeHigh) {
        high_us_ = clock_(int64_t{word & 0xFFFFFFF} << 6);
        has_time_ = true;
      } else if (type == kTrigger) {
        if (has_time_)
          block.triggers.push_back({time_of(word), static_cast<uint16_t>(word >> 8 & 0x1F), uint8_t(word & 1)});
      } else if (type != kOthers && type != kContinued && type != kPadding) {
        summary.add_dropped(Violation::kUnknownWord, source_->position() + i * kWordBytes);
      }
    }
    // An incomplete word, or a vector without its pixels.
    const bool is_cut = i == 0 && !bytes.empty();
    if (is_cut) summary.add(Violation::kTruncated, source_->position());
    source_->consume(is_cut ? bytes.size() : i * kWordBytes);
    return i > 0;
  }

  Result<void> seek_before(int64_t) override {
    has_time_ = false;
    clock_ = {};
    return source_->seek(header_bytes_);
  }

 private:
  [[nodiscard]] int64_t time_of(uint32_t word) const { return high_us_ + (word >> 22 & 0x3F); }

  /// Appends an event for each set bit of `pixels`.
  void append(uint32_t word, uint32_t pixels, EventColumns& events, DecodeSummary& summary) const {
    if (!has_time_) {
      summary.events_before_time += static_cast<uint64_t>(std::popcount(pixels));
      return;
    }
    const uint32_t x = word >> 11 & 0x7FF, y = word & 0x7FF, p = word >> 28 & 1;
    for (; pixels != 0; pixels &= pixels - 1) {
      const auto place = static_cast<uint32_t>(std::countr_zero(pixels));
      events.push_back(
          {static_cast<uint16_t>(x + place), static_cast<uint16_t>(y), static_cast<uint8_t>(p), time_of(word)});
    }
  }

  SourcePtr source_;
  uint64_t header_bytes_;
  TimeUnwrapper<34> clock_;
  int64_t high_us_ = 0;
  bool has_time_ = false;
};

}  // namespace

ReaderPtr make_reader(SourcePtr source, RecordingInfo info, const OpenOptions& options) {
  return std::make_unique<RecordingReader>(std::make_unique<Evt4Blocks>(source), std::move(info), source->name(),
                                           options);
}

}  // namespace e2lf::recordings::evt4
