// SPDX-License-Identifier: MIT
// Replays recordings as a camera; declared in cameras.h.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"

namespace e2lf::cameras {
namespace {

/// What is replayed, and how.
struct ReplayAddress {
  std::string path;
  double speed = 1;     ///< of the replay, relative to the recording's own
  uint64_t repeat = 1;  ///< how often it is played
};

/// A camera that plays a recording `speed` times as fast as it was recorded, and waits for its reader.
class TimedCamera : public Camera {
 public:
  explicit TimedCamera(double speed) : speed_(speed) {}
  Result<void> start() override {
    begin_ = Clock::now();
    return {};
  }
  void stop() override { is_stopped_ = true; }
  bool keeps_unread() const override { return true; }

 protected:
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }

  /// Sleeps until a time since the beginning of the recording, in steps that are short enough to be stopped.
  void wait_until(int64_t t_us) const {
    constexpr auto kNap = std::chrono::milliseconds(50);
    const Clock::time_point due = begin_ + std::chrono::microseconds(std::llround(static_cast<double>(t_us) / speed_));
    while (!is_stopped_ && Clock::now() < due) std::this_thread::sleep_until(std::min(due, Clock::now() + kNap));
  }

 private:
  using Clock = std::chrono::steady_clock;
  double speed_;
  Clock::time_point begin_;
  std::atomic<bool> is_stopped_ = false;
};

/// Words are delivered in intervals of at least this length, like the buffers of a camera, or up to the next TIME_HIGH,
/// or as many as there are. If more bytes were requested, they would be moved again and again in the buffer of a file.
constexpr int64_t kLeastStretchUs = 1000;
constexpr size_t kWantedBytes = size_t{1} << 17;
constexpr size_t kSearchedWords = 2048, kMostStretchWords = size_t{1} << 20;
/// Largest step of TIME_HIGH that takes time; longer ones are skipped.
constexpr uint32_t kMostSteps = 64;

/// Delivers the bytes of a RAW recording in EVT3 as they are, each when its time has come. A step of the clock by more
/// than a quarter of a second, where data is missing or damaged, takes no time. When it is played again, the clock
/// continues, and its TIME_HIGH words are shifted. The source must then be seekable.
class RawReplay final : public TimedCamera {
 public:
  RawReplay(SourcePtr source, size_t header_bytes, const ReplayAddress& replay)
      : TimedCamera(replay.speed),
        source_(std::move(source)),
        header_bytes_(header_bytes),
        repeats_(replay.repeat - 1) {}

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    if (is_stopped()) return false;
    if (std::exchange(is_header_, false)) return read_header(bytes);
    E2LF_ASSIGN_OR_RETURN(std::span<const uint8_t> ahead, source_->fetch(kWantedBytes));
    if (ahead.empty() && repeats_ > 0) {
      E2LF_RETURN_IF_ERROR(begin_again());
      E2LF_ASSIGN_OR_RETURN(ahead, source_->fetch(kWantedBytes));
    }
    if (ahead.empty()) return false;
    const size_t words = find_stretch(ahead.data(), ahead.size() / 2);
    const bool is_last = ahead.size() < kWantedBytes && 2 * words + 1 >= ahead.size();
    const size_t end = is_last ? ahead.size() : 2 * words;
    wait_until(time_us());
    bytes.assign(ahead.begin(), ahead.begin() + static_cast<ptrdiff_t>(end));
    source_->consume(end);
    if (moved_ != 0) move_time(bytes);
    return !is_stopped();
  }

 private:
  Result<bool> read_header(std::vector<uint8_t>& bytes) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> head, source_->fetch(header_bytes_));
    bytes.assign(head.begin(), head.begin() + static_cast<ptrdiff_t>(header_bytes_));
    source_->consume(header_bytes_);
    return true;
  }

  /// Returns to the first word; the clock continues one step after the last word.
  Result<void> begin_again() {
    --repeats_;
    moved_ = static_cast<uint16_t>(moved_ + time_high_ + 1 - first_high_);
    time_high_ = static_cast<uint16_t>(kTimeHighBits | ((first_high_ - 1U) & evt3::kPayloadMask));
    return source_->seek(header_bytes_);
  }

  void move_time(std::vector<uint8_t>& bytes) const {
    // Every word is stored unconditionally, so that the compiler vectorises the loop.
    uint8_t* const data = bytes.data();
    const size_t words = bytes.size() / 2;
    const uint16_t by = moved_;
    for (size_t i = 0; i < words; ++i) {
      const auto word = load_le<uint16_t>(data + 2 * i);
      const auto moved = static_cast<uint16_t>(kTimeHighBits | ((word + by) & evt3::kPayloadMask));
      store_le(data + 2 * i, (word & 0xF000U) == kTimeHighBits ? moved : word);
    }
  }

  /// Advances to the end of the next interval and returns its number of words.
  size_t find_stretch(const uint8_t* words, size_t count) {
    const int64_t begin_us = time_us();
    size_t end = 0;
    while (end < std::min(count, kMostStretchWords) && time_us() < begin_us + kLeastStretchUs) {
      const size_t block = std::min(kSearchedWords, count - end);
      const size_t mark = evt3::find_mark(words + 2 * end, block, time_high_);
      if (const size_t low = evt3::find_last(words + 2 * end, mark, evt3::only(evt3::kTimeLow)); low < mark) {
        low_us_ = load_le<uint16_t>(words + 2 * (end + low)) & evt3::kPayloadMask;
      }
      end += mark;
      if (mark == block) continue;
      const auto word = load_le<uint16_t>(words + 2 * end++);
      if (word >> 12 == evt3::kTimeHigh) take_time_high(word);
    }
    return end;
  }

  void take_time_high(uint16_t word) {
    const uint32_t step = (static_cast<uint32_t>(word) - time_high_) & evt3::kPayloadMask;
    if (time_high_ == kUnknown) first_high_ = word;
    if (time_high_ != kUnknown && step <= kMostSteps) high_us_ += int64_t{step} << 12;
    time_high_ = word;
    low_us_ = 0;
  }

  /// Returns the time of the last word relative to the first TIME_HIGH word.
  [[nodiscard]] int64_t time_us() const { return high_us_ + low_us_; }

  static constexpr uint16_t kUnknown = 0xFFFF;
  static constexpr uint16_t kTimeHighBits = evt3::kTimeHigh << 12;

  SourcePtr source_;
  size_t header_bytes_;
  uint64_t repeats_;       ///< number of remaining repetitions
  bool is_header_ = true;  ///< whether the header is delivered next
  uint16_t time_high_ = kUnknown, first_high_ = 0;
  uint16_t moved_ = 0;  ///< shift of TIME_HIGH
  int64_t high_us_ = 0, low_us_ = 0;
};

/// Events are delivered in intervals of this length, like the buffers of a camera.
constexpr int64_t kStretchUs = 1000;
constexpr size_t kBatchEvents = size_t{1} << 16;

class ReplayCamera final : public TimedCamera {
 public:
  ReplayCamera(ReaderPtr reader, double speed) : TimedCamera(speed), reader_(std::move(reader)) {}

  /// Creates the encoder, whose header is delivered first.
  Result<void> open() {
    E2LF_ASSIGN_OR_RETURN(writer_, create_recording(make_memory_sink(encoded_), "evt3", reader_->info()));
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes = std::exchange(encoded_, {});
    if (!bytes.empty()) return true;
    E2LF_ASSIGN_OR_RETURN(const bool more, next_stretch());
    if (!more || is_stopped()) return false;
    wait_until(end_us_ - origin_us_);
    E2LF_RETURN_IF_ERROR(writer_->write(stretch_));
    bytes = std::exchange(encoded_, {});
    return true;
  }

  DecodeSummary left_out() const override {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }

 private:
  /// Fills stretch_ with the events and triggers of the next interval that contains some.
  Result<bool> next_stretch() {
    stretch_.clear();
    if (event_ == batch_.events.size() && trigger_ == batch_.triggers.size()) {
      event_ = trigger_ = 0;
      E2LF_ASSIGN_OR_RETURN(const bool more, reader_->read(batch_, kBatchEvents));
      {
        const std::lock_guard lock(mutex_);
        left_out_ = reader_->summary();
      }
      if (!more) return false;
    }
    int64_t first_us = INT64_MAX;
    if (event_ < batch_.events.size()) first_us = batch_.events.t[event_];
    if (trigger_ < batch_.triggers.size()) first_us = std::min(first_us, batch_.triggers[trigger_].t);
    if (!has_begun_) origin_us_ = first_us;
    has_begun_ = true;
    end_us_ = first_us + kStretchUs;
    const auto& t = batch_.events.t;
    const auto end = std::lower_bound(t.begin() + static_cast<ptrdiff_t>(event_), t.end(), end_us_) - t.begin();
    stretch_.events.append(batch_.events, event_, static_cast<size_t>(end));
    event_ = static_cast<size_t>(end);
    for (; trigger_ < batch_.triggers.size() && batch_.triggers[trigger_].t < end_us_; ++trigger_) {
      stretch_.triggers.push_back(batch_.triggers[trigger_]);
    }
    return true;
  }

  ReaderPtr reader_;
  WriterPtr writer_;
  std::vector<uint8_t> encoded_;
  EventBatch batch_, stretch_;
  size_t event_ = 0, trigger_ = 0;  ///< first ones of batch_ that were not delivered yet
  bool has_begun_ = false;
  int64_t origin_us_ = 0, end_us_ = 0;
  mutable std::mutex mutex_;
  DecodeSummary left_out_;  ///< of the data that was read, which is ahead of the data that was delivered
};

template <typename T>
std::optional<T> number_in(std::string_view text, T least, T most) {
  const auto value = parse_number<T>(text);
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

/// Parses FILE or FILE?speed=S&repeat=N. A file that has the whole text as its name is meant.
Result<ReplayAddress> parse_replay_address(const std::string& address) {
  constexpr double kLeastSpeed = 1e-3, kMostSpeed = 1000;
  constexpr uint64_t kMostRepeats = 1'000'000;
  ReplayAddress replay{address.substr(0, replay_path_size(address))};
  std::string_view rest = std::string_view(address).substr(std::min(replay.path.size() + 1, address.size()));
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const std::string_view key = part.substr(0, part.find('=')),
                           text = part.substr(std::min(key.size() + 1, part.size()));
    const auto speed = key == "speed" ? number_in(text, kLeastSpeed, kMostSpeed) : std::nullopt;
    const auto repeat = key == "repeat" ? number_in(text, uint64_t{1}, kMostRepeats) : std::nullopt;
    if (!speed && !repeat) {
      return fail(ErrorCode::kInvalidValue, address, "\"", part,
                  "\" is not an option of a replay; write speed=S (0.001 to 1000) or repeat=N (1 to ", kMostRepeats,
                  "), joined by &");
    }
    replay.speed = speed.value_or(replay.speed);
    replay.repeat = repeat.value_or(replay.repeat);
  }
  return replay;
}

}  // namespace

double replay_speed(const std::string& input) {
  for (const std::string_view prefix : {"replay:", "camera://replay/"}) {
    if (!input.starts_with(prefix)) continue;
    const auto replay = parse_replay_address(input.substr(prefix.size()));
    return replay ? replay->speed : 1;
  }
  return 1;
}

Result<CameraPtr> open_replay_camera(const std::string& address) {
  E2LF_ASSIGN_OR_RETURN(const ReplayAddress replayed, parse_replay_address(address));
  const std::string& path = replayed.path;
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(path));
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> head, source->fetch(kDetectBytes));
  const auto header = parse_raw_header(head, true, path);
  if (header && header->info.format == "evt3") {
    return CameraPtr(std::make_unique<RawReplay>(std::move(source), header->num_bytes, replayed));
  }
  if (replayed.repeat > 1) {
    return fail(ErrorCode::kUnsupported, path,
                "only RAW recordings in EVT3 are replayed several times; make one with e2lf convert");
  }
  // The reader of the camera reports what is left out.
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(std::filesystem::path(path), {.policy = DecodePolicy::kSkip}));
  auto replay = std::make_unique<ReplayCamera>(std::move(reader), replayed.speed);
  E2LF_RETURN_IF_ERROR(replay->open());
  return CameraPtr(std::move(replay));
}

}  // namespace e2lf::cameras
