// SPDX-License-Identifier: MIT
// Opens and creates RAW recordings of every encoding; declared in codecs.h.
#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_stream.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {
namespace {

/// Decodes the first `size` bytes with a new stream; returns false if it stops elsewhere.
template <typename Stream>
bool warm_up(std::span<const uint8_t> bytes, size_t size, ColumnSink& sink, Stream& stream) {
  DecodeSummary ignored;
  for (size_t at = 0; at != size;) {
    const auto progress = stream.process(bytes.subspan(at), false, at, sink, ignored, size - at);
    at += progress.used;
    sink.count = 0;
    sink.triggers->clear();
    sink.set_latest(INT64_MIN);
    if (progress.wanted > 0 || progress.used == 0 || at > size) return false;
  }
  return true;
}

/// Guesses the state of a stream at byte `begin` of `bytes` from the words before it, where `stream` is the state at
/// the first byte. Returns false if the words are not conclusive. Overwrites the content of the sink and leaves it
/// empty.
template <typename WordCodec>
bool guess_state(std::span<const uint8_t> bytes, size_t begin, const SensorLimits& limits,
                 const RawStream<WordCodec>& stream, ColumnSink& sink, RawStream<WordCodec>& guess) {
  for (const size_t words : {1024, 16384}) {  // a few first, then more
    const size_t from = begin - std::min(begin, words * WordCodec::kWordBytes);
    guess = RawStream<WordCodec>(limits);
    if (!warm_up(bytes.subspan(from), begin - from, sink, guess) || !guess.is_steady()) continue;
    guess.extrapolate(stream);
    return true;
  }
  return false;
}

/// Decodes consecutive parts of a RAW stream in parallel. The state at the start of a part is guessed from the words
/// before it. A part is accepted only if the previous part ends in exactly this state, so that the result is that of a
/// single thread.
template <typename WordCodec>
class PartDecoder {
 public:
  using Stream = RawStream<WordCodec>;

  struct Part {
    explicit Part(const SensorLimits& limits) : stream(limits), guess(limits) {}

    EventBatch batch;
    DecodeSummary summary;          ///< summary of this part only, without the counts of events and triggers
    Stream stream;                  ///< state after the part
    size_t end = 0;                 ///< number of bytes that are done
    int64_t latest_us = INT64_MIN;  ///< time of the last event or trigger so far

    Stream guess;  ///< guessed state before the part
    bool is_guessed = false;
    bool restarts = false;  ///< whether the clock starts again at the end of the part
    bool is_whole = false;  ///< whether the next part begins at the end of this one
  };

  PartDecoder(size_t max_parts, const SensorLimits& limits) : limits_(limits), parts_(max_parts, Part(limits)) {}

  /// Returns the number of bytes that decode() can use.
  [[nodiscard]] size_t wanted_bytes() const { return parts_.size() * part_bytes_ + kBytesBehind; }

  /// Decodes from `bytes`, which begin at the state of `stream` and at byte `first_byte` of the file; `latest_us` is as
  /// in Part. Returns the number of accepted parts, or 0 if there are too few bytes for two.
  size_t decode(std::span<const uint8_t> bytes, uint64_t first_byte, const Stream& stream, int64_t latest_us) {
    const size_t usable = bytes.size() - std::min(bytes.size(), kBytesBehind);
    const size_t count = std::min(parts_.size(), usable / part_bytes_);
    if (count < 2) return 0;
    parallel_for(count, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) decode_part(bytes, first_byte, stream, i);
    });
    raise(parts_[0], latest_us);
    size_t good = 1;
    while (good < count && joins(parts_[good - 1], parts_[good])) ++good;
    if (parts_[0].end == 0 && !parts_[0].restarts) return 0;
    adapt(good);
    return good;
  }

  [[nodiscard]] Part& part(size_t i) { return parts_[i]; }

 private:
  /// Intended number of events per part, small enough to stay in the cache until they are used.
  static constexpr size_t kPartEvents = size_t{1} << 16;
  static constexpr size_t kMaxPartEvents = 4 * kPartEvents;
  static constexpr size_t kMinPartBytes = size_t{1} << 16;
  static constexpr size_t kMaxPartBytes = size_t{1} << 21;
  /// Number of bytes after its end that a part may inspect.
  static constexpr size_t kBytesBehind = 2 * kJudgeWords * WordCodec::kWordBytes;

  void decode_part(std::span<const uint8_t> bytes, uint64_t first_byte, const Stream& stream, size_t i) {
    Part& part = parts_[i];
    EventBatch& batch = part.batch;
    batch.clear();
    part.summary = {};
    ColumnSink sink(batch, kMaxPartEvents);
    const size_t begin = i * part_bytes_;
    part.guess = stream;
    part.is_guessed = i == 0 || guess_state(bytes, begin, limits_, stream, sink, part.guess);
    part.is_whole = part.restarts = false;
    if (part.is_guessed) {
      part.stream = part.guess;
      const auto progress =
          part.stream.process(bytes.subspan(begin), false, first_byte + begin, sink, part.summary, part_bytes_);
      part.end = begin + progress.used;
      part.restarts = progress.restarts;
      part.is_whole = progress.used == part_bytes_ && !part.restarts;
      part.latest_us = sink.latest();
    }
    batch.events.resize(sink.count);
  }

  /// Returns whether a part continues from the previous one, and adapts it if so.
  static bool joins(const Part& before, Part& part) {
    if (!before.is_whole || !part.is_guessed) return false;
    if (!Stream::is_confirmed(part.guess, before.stream, part.stream)) return false;
    raise(part, before.latest_us);
    return true;
  }

  /// Raises times to the last one before the part, as the sink does within it.
  static void raise(Part& part, int64_t latest_us) {
    for (int64_t& t_us : part.batch.events.t) {
      if (t_us >= latest_us) break;
      t_us = latest_us;
    }
    for (Trigger& trigger : part.batch.triggers) trigger.t = std::max(trigger.t, latest_us);
    part.latest_us = std::max(part.latest_us, latest_us);
  }

  void adapt(size_t good) {
    size_t events = 0;
    for (size_t i = 0; i < good; ++i) events += parts_[i].batch.events.size();
    const double bytes_per_event =
        static_cast<double>(parts_[good - 1].end) / static_cast<double>(std::max<size_t>(events, 1));
    const auto wanted = static_cast<size_t>(std::min(1e9, bytes_per_event * static_cast<double>(kPartEvents)));
    part_bytes_ = std::clamp(wanted, kMinPartBytes, kMaxPartBytes) / 64 * 64;
  }

  SensorLimits limits_;
  std::vector<Part> parts_;
  size_t part_bytes_ = 2 * kMinPartBytes;
};

/// The blocks of a RAW recording of one encoding. Bytes of a source are decoded by a RawStream, or, for files and
/// several threads, by a PartDecoder that is some parts ahead. The stream is copied every kCheckpointBytes, so that
/// seeking requires no index file: it continues from the last copy before the time.
template <typename WordCodec>
class RawBlocks final : public EventBlocks {
 public:
  /// `source` is positioned after the header, whose properties are `info`.
  RawBlocks(SourcePtr source, const RecordingInfo& info, const OpenOptions& options)
      : source_(std::move(source)),
        options_(options),
        limits_(limits_of(info, options)),
        setup_(setup_of(info)),
        stream_(limits_) {
    options_.format = info.format;
    options_.width = info.width;
    options_.height = info.height;
    checkpoints_.push_back({INT64_MIN, source_->position(), stream_, INT64_MIN});
    const auto threads = static_cast<size_t>(options.threads == 0 ? num_threads() : options.threads);
    if (threads == 1 || !source_->seekable()) return;
    parts_.emplace(kPartsPerThread * threads, limits_);
  }

  std::optional<std::chrono::steady_clock::time_point> arrival() const override { return source_->arrival(); }
  bool is_ordered() const override { return true; }
  bool begins_recording() const override { return begins_recording_; }
  uint64_t block_byte() const override { return recording_byte_; }
  void limit_block(size_t max_events) override { max_events_ = max_events; }
  void skip_events(int64_t begin_us, int64_t end_us) override { stream_.skip_events({begin_us, end_us}); }

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    begins_recording_ = next_part_ == num_parts_ && restart_;
    if (begins_recording_) E2LF_RETURN_IF_ERROR(begin_again());
    if (next_part_ == num_parts_) E2LF_RETURN_IF_ERROR(decode_parts());
    if (next_part_ == num_parts_) return read_directly(block, summary);
    auto& part = parts_->part(next_part_++);
    summary.append(part.summary);
    summary.time_loops = loops_before_ + part.stream.time_loops();
    std::swap(block, part.batch);
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    auto checkpoint = checkpoints_.rbegin();
    while (checkpoint->time_us >= t_us && std::next(checkpoint) != checkpoints_.rend()) ++checkpoint;
    E2LF_RETURN_IF_ERROR(source_->seek(checkpoint->byte));
    stream_ = checkpoint->stream;
    latest_us_ = checkpoint->latest_us;
    stream_.skip_events({});
    wanted_ = std::max<size_t>(stream_.num_seen_bytes(), 1);
    next_part_ = num_parts_ = 0;
    has_restarted_ = restart_ = false;
    loops_before_ = 0;
    return {};
  }

 private:
  static constexpr uint64_t kCheckpointBytes = uint64_t{4} << 20;
  static constexpr size_t kPartsPerThread = 4;

  struct Checkpoint {
    int64_t time_us;  ///< no earlier event is later than this
    uint64_t byte;
    RawStream<WordCodec> stream;
    int64_t latest_us;  ///< latest time that was returned so far
  };

  /// Returns what the header of a recording of e2lf states about patterns and camera.
  static std::vector<std::pair<std::string, std::string>> setup_of(const RecordingInfo& info) {
    std::vector<std::pair<std::string, std::string>> setup;
    std::ranges::copy_if(info.header, std::back_inserter(setup),
                         [](const auto& entry) { return entry.first.starts_with("e2lf"); });
    return setup;
  }

  static SensorLimits limits_of(const RecordingInfo& info, const OpenOptions& options) {
    SensorLimits limits;
    limits.counts_reports = options.counts_reports;
    if (info.width != 0) limits.width = static_cast<uint32_t>(info.width);
    if (info.height != 0) limits.height = static_cast<uint32_t>(info.height);
    return limits;
  }

  /// Starts a new stream where the clock starts again, after the header of another file if there is one.
  Result<void> begin_again() {
    restart_ = false;
    recording_byte_ = source_->position();
    const auto header = read_raw_header(*source_, options_);
    if (!header) {
      return Error{header.error().code,
                   cat("another recording begins here that does not match the one before it (", header.error().message,
                       "); split the file here"),
                   cat(source_->name(), ": byte ", recording_byte_)};
    }
    if (header->num_bytes > 0 && setup_of(header->info) != setup_) {
      return fail(
          ErrorCode::kUnsupported, cat(source_->name(), ": byte ", recording_byte_),
          "another recording begins here, which states other patterns or another camera than the one before it; "
          "split the file here");
    }
    loops_before_ += stream_.time_loops();
    stream_ = RawStream<WordCodec>(limits_);
    latest_us_ = INT64_MIN;
    has_restarted_ = true;
    wanted_ = 1;
    return {};
  }

  /// Decodes the next parts in several threads, if possible.
  Result<void> decode_parts() {
    next_part_ = num_parts_ = 0;
    if (!parts_ || !stream_.is_steady()) return {};
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> bytes, source_->fetch(parts_->wanted_bytes()));
    const uint64_t first_byte = source_->position();
    num_parts_ = parts_->decode(bytes, first_byte, stream_, latest_us_);
    for (size_t i = 0; i < num_parts_; ++i) {
      const auto& part = parts_->part(i);
      stream_ = part.stream;
      latest_us_ = part.latest_us;
      add_checkpoint(first_byte + part.end, latest_us_);
    }
    if (num_parts_ == 0) return {};
    source_->consume(parts_->part(num_parts_ - 1).end);
    restart_ = parts_->part(num_parts_ - 1).restarts;
    wanted_ = std::max<size_t>(stream_.num_seen_bytes(), 1);
    return {};
  }

  /// Decodes to the block in this thread.
  Result<bool> read_directly(EventBatch& block, DecodeSummary& summary) {
    ColumnSink sink(block, max_events_);
    sink.set_latest(latest_us_);
    Result<bool> more = true;
    bool full = false;
    // A live source returns the bytes that have arrived.
    const auto has_enough = [&] { return !source_->seekable() && (sink.count > 0 || !block.triggers.empty()); };
    while (more && *more && !full && !restart_ && !has_enough()) more = step(sink, summary, full);
    block.events.resize(sink.count);
    latest_us_ = sink.latest();
    return more;
  }

  /// Decodes the available bytes. Returns false at the end of the source; sets `full` if the sink stopped.
  Result<bool> step(ColumnSink& sink, DecodeSummary& summary, bool& full) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> bytes, source_->fetch(wanted_));
    const bool ended = bytes.size() < wanted_;
    const auto progress = stream_.process(bytes, ended, source_->position(), sink, summary);
    source_->consume(progress.used);
    summary.time_loops = loops_before_ + stream_.time_loops();
    restart_ = progress.restarts;
    if (restart_) return true;
    if (ended && progress.used == bytes.size() && source_->pass_break()) {
      stream_.pass_break(source_->position(), summary);
      wanted_ = 1;
      return true;
    }
    full = progress.wanted == 0 && !(ended && progress.used == bytes.size());
    wanted_ = std::max<size_t>({progress.wanted, stream_.num_seen_bytes(), 1});
    add_checkpoint(source_->position(), sink.latest());
    return full || !ended;
  }

  /// Stores a checkpoint of stream_ at this byte.
  void add_checkpoint(uint64_t byte, int64_t latest_us) {
    if (!source_->seekable() || has_restarted_ || byte < checkpoints_.back().byte + kCheckpointBytes) return;
    const int64_t time_us = std::max(stream_.time_us(), latest_us);
    if (time_us > checkpoints_.back().time_us) checkpoints_.push_back({time_us, byte, stream_, latest_us});
  }

  SourcePtr source_;
  OpenOptions options_;  ///< with the format and size of the first header, with which later ones must agree
  SensorLimits limits_;
  std::vector<std::pair<std::string, std::string>> setup_;
  RawStream<WordCodec> stream_;
  std::vector<Checkpoint> checkpoints_;
  size_t wanted_ = 1;
  int64_t latest_us_ = INT64_MIN;  ///< latest time that was decoded

  std::optional<PartDecoder<WordCodec>> parts_;
  size_t num_parts_ = 0;  ///< number of decoded parts, of which the first next_part_ were returned
  size_t next_part_ = 0;

  size_t max_events_ = RecordingReader::kDefaultBatch;
  bool begins_recording_ = false;
  uint64_t recording_byte_ = 0;  ///< where the last recording begins, after the first one

  bool restart_ = false;        ///< whether the clock starts again after what was decoded
  bool has_restarted_ = false;  ///< whether it did so before
  uint64_t loops_before_ = 0;   ///< loops of the clock before that
};

template <typename WordCodec>
ReaderPtr make_reader(SourcePtr source, RawHeader header, const OpenOptions& options) {
  auto blocks = std::make_unique<RawBlocks<WordCodec>>(source, header.info, options);
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(header.info), source->name(), options);
}

Result<ReaderPtr> open_evt21(SourcePtr source, RawHeader header, const OpenOptions& options) {
  using timed::TimedWordCodec, timed::Encoding;
  constexpr size_t kLookedAtBytes = 4096;
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> words, source->fetch(kLookedAtBytes));
  return timed::find_byte_order(words, header.endianness) == Encoding::kEvt21Little
             ? make_reader<TimedWordCodec<Encoding::kEvt21Little>>(std::move(source), std::move(header), options)
             : make_reader<TimedWordCodec<Encoding::kEvt21Legacy>>(std::move(source), std::move(header), options);
}

}  // namespace

Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(RawHeader header, read_raw_header(*source, options));
  if (header.info.format == "evt2.1") return open_evt21(std::move(source), std::move(header), options);
  if (header.info.format == "evt2") {
    return make_reader<timed::TimedWordCodec<timed::Encoding::kEvt2>>(std::move(source), std::move(header), options);
  }
  if (header.info.format == "evt4") return evt4::make_reader(std::move(source), std::move(header.info), options);
  return make_reader<evt3::Evt3WordCodec>(std::move(source), std::move(header), options);
}

Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info) {
  if (info.format == "evt2") return create_raw_writer<timed::Evt2Encoder>(std::move(sink), info);
  if (info.format == "evt2.1") return create_raw_writer<timed::Evt21Encoder>(std::move(sink), info);
  return create_raw_writer<evt3::Encoder>(std::move(sink), info);
}

}  // namespace e2lf::recordings
