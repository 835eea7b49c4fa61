// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "e2lf/base/threads.h"
#include "e2lf/events/move_counts.h"
#include "e2lf/events/raw/raw_stream.h"
#include "e2lf/events/raw/stream_guess.h"

namespace e2lf::events {

/// Counts consecutive parts of a RAW stream into event images at once: the first part straight into the caller's, each
/// other one into images of its own, for a few slices from where it seems to begin. Those are added once the part in
/// front has come to just the state that was guessed for this one, so the result is that of one thread; only a pixel
/// whose sum reaches an end of int16 and turns back may differ.
template <typename Codec>
class ImageParts {
 public:
  using Stream = RawStream<Codec>;

  /// What is counted: bytes from where the stream is, the first of them the file's byte `first_byte`.
  struct Input {
    std::span<const uint8_t> bytes;
    uint64_t first_byte;
    std::span<const TimeSlice> slices;
  };

  ImageParts(size_t threads, const SensorLimits& limits) : limits_(limits), parts_(threads - 1, Part(limits)) {}

  /// Notes that so many bytes brought time on by so much.
  void learn(uint64_t bytes, int64_t from_us, int64_t to_us) {
    if (from_us == INT64_MIN || to_us <= from_us || bytes == 0) return;
    bytes_per_us_ = static_cast<double>(bytes) / static_cast<double>(to_us - from_us);
  }

  /// How many bytes count() is to be given: enough for parts that end together about where the last slice does; 0 when
  /// images of their own would not pay.
  size_t plan(std::span<const TimeSlice> slices, const EventImages& images, int64_t latest_us) {
    part_bytes_ = share_of_rest(slices, images, latest_us) / 64 * 64;
    return part_bytes_ == 0 ? 0 : (parts_.size() + 1) * part_bytes_ + kBytesBehindPart<Codec>;
  }

  /// Counts with all threads; moves stream and sink on and adds to the summary. Returns how many bytes are done with, 0
  /// when there are too few for two parts.
  size_t count(const Input& input, EventImages& images, Stream& stream, ImageSink& sink, DecodeSummary& summary) {
    const size_t usable = input.bytes.size() - std::min(input.bytes.size(), kBytesBehindPart<Codec>);
    const size_t num_parts = std::min(parts_.size() + 1, usable / part_bytes_);
    if (num_parts < 2) return 0;
    const Stream start = stream;
    size_t used = 0;
    parallel_for(num_parts, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) {
        if (i > 0) {
          count_part(input, images, start, i, parts_[i - 1]);
        } else {
          used = stream.process(input.bytes, false, input.first_byte, sink, summary, part_bytes_).used;
        }
      }
    });
    bool is_whole = used == part_bytes_;
    for (Part& part : std::span(parts_).first(num_parts - 1)) {
      if (is_whole && joins(part, input.slices, stream, sink)) {
        take(part, images, stream, sink, summary);
        used += part.used;
        is_whole = part.used == part_bytes_;
      } else {
        drop(part);
        is_whole = false;
      }
    }
    return used;
  }

 private:
  /// How many images of its own a part has.
  static constexpr size_t kImages = 3;
  static constexpr size_t kMinPartBytes = size_t{1} << 17;
  static constexpr size_t kMaxPartBytes = size_t{1} << 22;
  static constexpr size_t kGuessEvents = size_t{1} << 12;

  struct Part {
    explicit Part(const SensorLimits& limits) : stream(limits), guess(limits) {}

    Stream stream;  ///< behind the part
    Stream guess;   ///< in front of it
    bool is_guessed = false;
    size_t used = 0;
    size_t first_slice = 0;  ///< of the caller's; that of images.image(0)
    EventImages images;      ///< all zero between two calls of count()
    std::optional<ImageSink> sink;
    std::vector<Trigger> triggers;
    DecodeSummary summary;
    EventColumns scratch;
  };

  /// Bytes for each part when all threads share what is left; 0 = too few.
  [[nodiscard]] size_t share_of_rest(std::span<const TimeSlice> slices, const EventImages& images,
                                     int64_t latest_us) const {
    const auto current = std::find_if(slices.begin(), slices.end(),
                                      [latest_us](const TimeSlice& slice) { return slice.end_us > latest_us; });
    if (current == slices.end()) return 0;
    const auto begin_us = static_cast<double>(std::max(latest_us, current->begin_us));
    const double rest_us = static_cast<double>(slices.back().end_us) - begin_us;
    const double slice_us = (static_cast<double>(slices.back().end_us) - static_cast<double>(current->begin_us)) /
                            static_cast<double>(slices.end() - current);
    // What it takes to add an image and to zero it again must be little beside what it takes to decode a slice.
    const double worth = static_cast<double>(images.image_size() * Codec::kWordBytes) / 4;
    if (bytes_per_us_ * slice_us < worth) return 0;
    // A little more than what seems to be left: a small rest would be one thread's.
    const double share = 1.05 * rest_us / static_cast<double>(parts_.size() + 1);
    const double bytes = bytes_per_us_ * std::min(share, (kImages - 1) * slice_us);
    if (bytes < std::max(worth / 4, static_cast<double>(kMinPartBytes))) return 0;
    return static_cast<size_t>(std::min(bytes, static_cast<double>(kMaxPartBytes)));
  }

  void count_part(const Input& input, const EventImages& images, const Stream& start, size_t i, Part& part) {
    const size_t begin = i * part_bytes_;
    part.sink.reset();
    part.triggers.clear();
    part.summary = {};
    part.used = 0;
    part.is_guessed = guess(input.bytes, begin, start, part);
    if (!part.is_guessed || !open(input.slices, images, part)) return;
    part.stream = part.guess;
    part.used =
        part.stream
            .process(input.bytes.subspan(begin), false, input.first_byte + begin, *part.sink, part.summary, part_bytes_)
            .used;
  }

  bool guess(std::span<const uint8_t> bytes, size_t begin, const Stream& start, Part& part) {
    ColumnSink sink(part.scratch, 0, kGuessEvents, part.triggers);
    return StreamGuess<Codec>::at(bytes, begin, limits_, start, sink, part.guess);
  }

  /// Makes a sink for some slices from the one where the part seems to begin; false when it lies behind all of them.
  static bool open(std::span<const TimeSlice> slices, const EventImages& images, Part& part) {
    const int64_t begin_us = part.guess.time_us();
    const auto first = std::find_if(slices.begin(), slices.end(),
                                    [begin_us](const TimeSlice& slice) { return slice.end_us > begin_us; });
    if (first == slices.end()) return false;
    part.first_slice = static_cast<size_t>(first - slices.begin());
    if (part.images.height != images.height || part.images.width != images.width) {
      part.images = EventImages(kImages, images.height, images.width);
    }
    const auto own = slices.subspan(part.first_slice);
    part.sink.emplace(own.first(std::min(own.size(), kImages)), part.images, &part.triggers);
    return true;
  }

  /// Whether the part goes on from what was counted before it, and into the right images.
  static bool joins(Part& part, std::span<const TimeSlice> slices, const Stream& stream, ImageSink& sink) {
    if (!part.is_guessed || !part.sink || !Stream::is_confirmed(part.guess, stream, part.stream)) return false;
    const int64_t first_us = first_time(part);
    if (part.first_slice > 0 && first_us < slices[part.first_slice - 1].end_us) return false;
    // Times that are earlier than the last one before the part are raised to it: not across an end of a slice.
    const int64_t latest_us = sink.latest();
    return first_us >= latest_us || std::none_of(slices.begin(), slices.end(), [&](const TimeSlice& slice) {
             const auto is_crossed = [&](int64_t border_us) { return first_us < border_us && border_us <= latest_us; };
             return is_crossed(slice.begin_us) || is_crossed(slice.end_us);
           });
  }

  /// The time of the part's first event or trigger.
  static int64_t first_time(Part& part) {
    part.sink->settle();
    int64_t first_us = part.sink->on + part.sink->off > 0 ? part.sink->first_t_us : INT64_MAX;
    if (!part.triggers.empty()) first_us = std::min(first_us, part.triggers.front().t);
    return first_us;
  }

  static void take(Part& part, EventImages& images, Stream& stream, ImageSink& sink, DecodeSummary& summary) {
    stream = part.stream;
    sink.append(*part.sink);
    summary.append(part.summary);
    for (size_t i = 0; i < part.sink->images_end(); ++i) {
      const auto from = part.images.image(i), to = images.image(part.first_slice + i);
      constexpr size_t kMinPixels = size_t{1} << 14;
      parallel_for(from.size(), kMinPixels, [&](size_t begin, size_t end) {
        move_counts(from.subspan(begin, end - begin), to.subspan(begin, end - begin));
      });
    }
  }

  /// Empties the images of a part that does not count.
  static void drop(Part& part) {
    if (!part.sink) return;
    for (size_t i = 0; i < part.sink->images_end(); ++i) std::ranges::fill(part.images.image(i), int16_t{0});
  }

  SensorLimits limits_;
  std::vector<Part> parts_;
  double bytes_per_us_ = 0;  ///< of what was counted last; 0 = not known yet
  size_t part_bytes_ = 0;
};

}  // namespace e2lf::events
