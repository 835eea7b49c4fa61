// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/recordings/event_counters.h"
#include "e2lf/view/document.h"

namespace e2lf::view {
namespace {

constexpr size_t kRateBins = 2000;
constexpr size_t kMostTriggers = 20000;  // the most that are drawn

/// The results of a first pass over a recording.
struct Overview {
  recordings::RecordingInfo info = {};
  size_t width = 0, height = 0;
  uint64_t num_events = 0;
  int64_t begin_us = 0, end_us = 0;
  recordings::EventRate rate = {};
  std::vector<recordings::Trigger> triggers = {};
};

Result<Overview> survey(const RecordingSource& source, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const auto reader, source.open(0, 0));
  Overview overview{.info = reader->info()};
  recordings::EventRateCounter counter(kRateBins);
  recordings::EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) break;
    counter.add(batch);
    for (const uint16_t x : batch.events.x) overview.width = std::max<size_t>(overview.width, x + 1U);
    for (const uint16_t y : batch.events.y) overview.height = std::max<size_t>(overview.height, y + 1U);
    for (const recordings::Trigger& trigger : batch.triggers) {
      if (overview.triggers.size() < kMostTriggers) overview.triggers.push_back(trigger);
    }
  }
  const recordings::DecodeSummary summary = reader->summary();
  overview.num_events = summary.events();
  if (overview.num_events == 0) {
    return fail(ErrorCode::kInvalidValue, name, "the recording holds no events; there is nothing to show");
  }
  if (overview.info.width != 0) {
    overview.width = overview.info.width;
    overview.height = overview.info.height;
  }
  overview.begin_us = summary.first_t_us;
  overview.end_us = summary.last_t_us + 1;
  overview.rate = counter.rate();
  return overview;
}

class Frames {
 public:
  Frames(Document& document, const Overview& overview, size_t num_frames)
      : document_(document),
        begin_us_(overview.begin_us),
        length_us_(overview.end_us - overview.begin_us),
        count_(std::min(static_cast<int64_t>(num_frames), length_us_)),
        image_(1, overview.height, overview.width) {}

  /// Adds events except the first `first` ones.
  void add(const recordings::EventColumns& events, size_t first = 0) {
    num_events_ += events.size() - first;
    for (size_t i = first; i < events.size(); ++i) {
      while (events.t[i] - begin_us_ >= edge_us(frame_ + 1)) finish();
      if (events.x[i] >= image_.width || events.y[i] >= image_.height) continue;
      int16_t& count = image_.values[events.y[i] * image_.width + events.x[i]];
      count = capture::saturated(count + (events.p[i] != 0 ? 1 : -1));
    }
  }

  [[nodiscard]] uint64_t num_events() const { return num_events_; }

  Json take() {
    while (frame_ < count_) finish();
    return std::move(frames_);
  }

 private:
  [[nodiscard]] int64_t edge_us(int64_t frame) const {
    return length_us_ / count_ * frame + length_us_ % count_ * frame / count_;
  }

  void finish() {
    frames_.push_back({{"begin_us", edge_us(frame_)},
                       {"end_us", edge_us(frame_ + 1)},
                       {"counts", document_.add_part(counts_part(image_.values))}});
    std::fill(image_.values.begin(), image_.values.end(), int16_t{0});
    ++frame_;
  }

  Document& document_;
  int64_t begin_us_, length_us_, count_, frame_ = 0;
  uint64_t num_events_ = 0;
  capture::EventImages image_;
  Json frames_ = Json::array();
};

/// Adds the events that `frames` has not received yet.
Result<void> add_remaining(const RecordingSource& source, const Overview& overview, Frames& frames) {
  if (frames.num_events() == overview.num_events) return {};
  E2LF_ASSIGN_OR_RETURN(const auto reader, source.open(overview.width, overview.height));
  recordings::EventBatch batch;
  for (uint64_t known = frames.num_events();;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) return {};
    const size_t skipped = std::min<uint64_t>(known, batch.events.size());
    known -= skipped;
    frames.add(batch.events, skipped);
  }
}

/// Returns the cycles that can be found, and adds the events that are read to `frames`. The absence of cycles is not an
/// error for a viewer.
Json found_cycles(const RecordingSource& source, int64_t origin_us, Frames& frames) {
  Json cycles = Json::array();
  if (!source.open_cycles) return cycles;
  auto reader = source.open_cycles([&frames](const recordings::EventBatch& batch) { frames.add(batch.events); });
  if (!reader) return cycles;
  for (;;) {
    const auto cycle = reader->next();
    if (!cycle || !*cycle) return cycles;
    Json slices = Json::array();
    for (const cycles::TimeSlice& slice : (*cycle)->slices) {
      slices.push_back({slice.begin_us - origin_us, slice.end_us - origin_us});
    }
    cycles.push_back(
        {{"number", (*cycle)->number}, {"confidence", (*cycle)->confidence}, {"slices", std::move(slices)}});
  }
}

}  // namespace

Result<void> add_recording(Document& document, const std::string& name, const RecordingSource& source,
                           size_t num_frames) {
  E2LF_ASSIGN_OR_RETURN(const Overview overview, survey(source, name));
  Frames frames(document, overview, num_frames);
  const Json cycles = found_cycles(source, overview.begin_us, frames);
  E2LF_RETURN_IF_ERROR(add_remaining(source, overview, frames));
  Json triggers = Json::array();
  for (const recordings::Trigger& trigger : overview.triggers) {
    triggers.push_back({trigger.t - overview.begin_us, trigger.p, trigger.id});
  }
  document.add_item({{"kind", "recording"},
                     {"name", name},
                     {"format", overview.info.format},
                     {"height", overview.height},
                     {"width", overview.width},
                     {"events", overview.num_events},
                     {"origin_us", overview.begin_us},
                     {"frames", frames.take()},
                     {"rate",
                      {{"begin_us", overview.rate.begin_us - overview.begin_us},
                       {"bin_us", overview.rate.bin_us},
                       {"on", overview.rate.on},
                       {"off", overview.rate.off}}},
                     {"triggers", triggers},
                     {"cycles", cycles}});
  return {};
}

}  // namespace e2lf::view
