// SPDX-License-Identifier: MIT
#include "e2lf/live/live_reader.h"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <numeric>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::live {
namespace fs = std::filesystem;

Recorder::Recorder(fs::path folder, recordings::RecordingInfo info)
    : folder_(std::move(folder)), info_(std::move(info)) {
  info_.format = "evt3";
}

Result<void> Recorder::begin() {
  const std::lock_guard lock(mutex_);
  if (writer_) return {};
  if (folder_.empty()) {
    return fail(ErrorCode::kInvalidValue, "", "no folder for recordings was given; start e2lf live with -o FOLDER");
  }
  int descriptor = -1;
  do {
    file_ = folder_ / formatted("recording_%03zu.raw", number_++);
    descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor < 0) return fail_to("create", file_, errno);
  error_.clear();
  auto sink = recordings::make_descriptor_sink(descriptor, /*owned=*/true, file_.string());
  E2LF_ASSIGN_OR_RETURN(writer_, recordings::create_recording(std::move(sink), "evt3", info_));
  return {};
}

Result<void> Recorder::finish() {
  if (!writer_) return {};
  const Result<void> finished = writer_->finish();
  writer_.reset();
  if (!finished) error_ = finished.error().text();
  return finished;
}

Result<void> Recorder::end() {
  const std::lock_guard lock(mutex_);
  return finish();
}

bool Recorder::is_recording() const {
  const std::lock_guard lock(mutex_);
  return writer_ != nullptr;
}

void Recorder::write(const recordings::EventBatch& batch) {
  const std::lock_guard lock(mutex_);
  if (!writer_) return;
  const Result<void> written = writer_->write(batch);
  if (written) return;
  // The file keeps what was written before; of two errors, the first one states the cause.
  (void)finish();
  error_ = written.error().text();
  log_warning(cat("the recording has ended: ", error_));
}

Json Recorder::json() const {
  const std::lock_guard lock(mutex_);
  std::error_code error;
  const uintmax_t bytes = fs::file_size(file_, error);
  return {{"can_record", !folder_.empty()},
          {"is_recording", writer_ != nullptr},
          {"file", file_.string()},
          {"bytes", error ? 0 : bytes},
          {"error", error_}};
}

namespace {

/// Returns the count that is displayed as white: the 99.5th percentile of the nonzero counts, at least 1.
int white_count(const std::vector<uint16_t>& all) {
  constexpr size_t kMostCount = 255;
  std::vector<size_t> pixels(kMostCount + 1);
  size_t lit = 0;
  for (const uint16_t count : all) {
    ++pixels[std::min<size_t>(count, kMostCount)];
    lit += count > 0 ? 1 : 0;
  }
  size_t above = 0, count = kMostCount;
  while (count > 1 && above + pixels[count] <= lit / 200) above += pixels[count--];
  return static_cast<int>(count);
}

}  // namespace

double sharpness_of(std::span<const int16_t> signed_counts, size_t width, uint64_t events) {
  const size_t height = width == 0 ? 0 : signed_counts.size() / width;
  if (events == 0 || width < 2 || height < 2) return 0;
  int64_t sum = 0;
  for (size_t y = 0; y + 1 < height; ++y) {
    const int16_t* const upper = signed_counts.data() + y * width;
    const int16_t* const lower = upper + width;
    for (size_t x = 0; x + 1 < width; ++x) {
      sum += static_cast<int64_t>(upper[x + 1] - upper[x]) * (lower[x + 1] - lower[x]);
      sum += static_cast<int64_t>(lower[x] - upper[x]) * (lower[x + 1] - upper[x + 1]);
    }
  }
  const double product = static_cast<double>(sum) / static_cast<double>(2 * (width - 1) * (height - 1));
  const double mean = static_cast<double>(events) / static_cast<double>(signed_counts.size());
  return std::max(0.0, product / (mean * mean));
}

double sharpness_of(const capture::EventImages& images) {
  const size_t pixels = images.height * images.width;
  double sum = 0, weights = 0;
  for (size_t i = 0; i < images.count; ++i) {
    const auto image = std::span<const int16_t>(images.values).subspan(i * pixels, pixels);
    uint64_t events = 0;
    for (const int16_t count : image) events += static_cast<uint64_t>(std::abs(count));
    const double weight = static_cast<double>(events) * static_cast<double>(events);
    sum += weight * sharpness_of(image, images.width, events);
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

void EventPreview::add(const recordings::EventBatch& batch) {
  const recordings::EventColumns& events = batch.events;
  if (events.empty()) return;
  const std::lock_guard lock(mutex_);
  if (!asked_ || finished_) return;
  if (signed_.empty()) {
    signed_.resize(width_ * height_);
    all_.resize(width_ * height_);
  }
  if (!begin_us_) begin_us_ = events.t.front();
  for (size_t i = 0; i < events.size() && events.t[i] < *begin_us_ + kWindowUs; ++i) {
    if (events.x[i] >= width_ || events.y[i] >= height_) continue;
    const size_t pixel = events.y[i] * width_ + events.x[i];
    if (all_[pixel] == INT16_MAX) continue;
    ++all_[pixel];
    signed_[pixel] = static_cast<int16_t>(signed_[pixel] + (events.p[i] != 0 ? 1 : -1));
    ++events_;
  }
  if (events.t.back() >= *begin_us_ + kWindowUs) finish();
}

void EventPreview::finish() {
  EventPicture picture;
  picture.image = lightfield::ByteImage(width_, height_, 1);
  picture.events = events_;
  picture.sharpness = sharpness_of(signed_, width_, events_);
  const int white = white_count(all_);
  for (size_t i = 0; i < signed_.size(); ++i) {
    picture.image.pixels[i] = static_cast<uint8_t>(std::clamp(128 + 127 * signed_[i] / white, 0, 255));
  }
  finished_ = std::move(picture);
  std::fill(signed_.begin(), signed_.end(), int16_t{0});
  std::fill(all_.begin(), all_.end(), uint16_t{0});
  begin_us_.reset();
  events_ = 0;
}

void EventPreview::add_cycle(uint64_t number, const capture::EventImages& images) {
  if (!is_asked()) return;
  const CycleSharpness cycle{number, sharpness_of(images)};
  const std::lock_guard lock(mutex_);
  cycle_ = cycle;
}

bool EventPreview::is_asked(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  return asked_ && now - *asked_ < kPatience;
}

std::optional<EventPicture> EventPreview::take(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  // A picture that was not taken for a long time is out of date.
  if (asked_ && now - *asked_ >= kPatience) finished_.reset();
  asked_ = now;
  if (finished_) finished_->cycle = cycle_;
  return std::exchange(finished_, std::nullopt);
}

size_t CycleSum::add(capture::EventImages& images, size_t wanted) {
  E2LF_REQUIRE(wanted >= 1 && wanted <= kMostCycles, "the number of summed cycles must be from 1 to kMostCycles");
  if (wanted == 1 || sum_.size() != images.values.size()) {
    last_.clear();
    sum_.clear();
  }
  if (wanted == 1) return 1;
  sum_.resize(images.values.size());
  const auto apply = [this](const capture::EventImages& of, int sign) {
    for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += sign * of.values[i];
  };
  for (; last_.size() >= wanted; last_.pop_front()) apply(last_.front(), -1);
  apply(images, 1);
  last_.push_back(images);
  for (size_t i = 0; i < sum_.size(); ++i) images.values[i] = capture::saturated(sum_[i]);
  return last_.size();
}

Result<std::unique_ptr<LiveReader>> LiveReader::open(const OpenCycles& open, const ReadingOptions& options) {
  auto reader = std::make_unique<LiveReader>();
  reader->options_ = options;
  reader->arrivals_ = ArrivalClock(options.speed);
  E2LF_ASSIGN_OR_RETURN(reader->cycles_,
                        open([self = reader.get()](const recordings::EventBatch& batch) { self->see(batch); }));
  const recordings::RecordingInfo& info = reader->cycles_->recording().info();
  reader->preview_.emplace(info.width, info.height);
  reader->recorder_.emplace(options.recordings, info);
  reader->report();
  return reader;
}

void LiveReader::see(const recordings::EventBatch& batch) {
  constexpr std::chrono::milliseconds kReportPeriod{500};
  const Clock::time_point now = Clock::now();
  statistics_.add_batch(batch, now);
  rig_.add(batch);
  if (!has_all_events_) {
    // Recordings start at the beginning of a cycle.
  } else if (options_.is_inverted && recorder_->is_recording()) {
    sent_ = batch;
    for (uint8_t& p : sent_.events.p) p = p != 0 ? 0 : 1;
    recorder_->write(sent_);
  } else {
    recorder_->write(batch);
  }
  preview_->add(batch);
  // The events of a file have no arrival time; they count as arrived when they are read.
  if (!batch.events.empty()) {
    arrivals_.add(cycles_->recording().arrival().value_or(now), batch.events.t.back());
  }
  if (now - reported_ < kReportPeriod) return;
  reported_ = now;
  report();
}

void LiveReader::report(bool has_ended) {
  constexpr int64_t kCyclesBefore = 3;  // what is found earlier may be due to a few triggers
  Json rig = rig_.json(*cycles_);
  diagnose::Findings findings;
  if ((has_ended && taken_ > 0) || rig_.seen_us() > kCyclesBefore * cycles_->schedule().cycle_us()) {
    findings = rig_.findings(*cycles_);
  }
  const std::lock_guard lock(findings_mutex_);
  findings.insert(findings.end(), other_findings_.begin(), other_findings_.end());
  rig["findings"] = diagnose::to_json(findings);
  announce(findings);
  statistics_.set_report(cycles_->summary(), std::move(rig));
}

void LiveReader::add_findings(const diagnose::Findings& findings) {
  const std::lock_guard lock(findings_mutex_);
  other_findings_.insert(other_findings_.end(), findings.begin(), findings.end());
  statistics_.add_findings(diagnose::to_json(findings));  // after the end, there is no further report
  announce(findings);
}

/// Passes findings on whose code is new. findings_mutex_ must be locked.
void LiveReader::announce(const diagnose::Findings& findings) {
  for (const diagnose::Finding& finding : findings) {
    if (announced_.insert(finding.code).second && options_.on_finding) options_.on_finding(finding);
  }
}

/// Requests all events while a recording or the picture for focusing needs them.
void LiveReader::choose_events() {
  constexpr uint64_t kWholeEvery = 20;
  has_all_events_ = recorder_->is_recording() || preview_->is_asked();
  cycles_->read_whole_every(has_all_events_ ? 1 : kWholeEvery);
}

Result<bool> LiveReader::next(LiveCycle& cycle) {
  bool has_late = false;
  for (;;) {
    const Result<bool> more = read(cycle);
    // The cycle that was read is the newest one, if there is another.
    if (has_late && (!more || *more)) statistics_.add_skipped(Skipped::kLate);
    if (!more || !*more) return !more ? more : Result<bool>(has_late);
    if (!late_.drops(seconds_since(cycle.last_event), cycle.cycle_s)) return true;
    has_late = true;
  }
}

/// Reads the next cycle. Leaves `cycle` as it is if there is none.
Result<bool> LiveReader::read(LiveCycle& cycle) {
  if (stop_requested() || (options_.max_cycles != 0 && taken_ == options_.max_cycles)) {
    report(true);
    return false;
  }
  choose_events();
  E2LF_ASSIGN_OR_RETURN(std::optional<cycles::Cycle> next, cycles_->next());
  report(!next);
  if (!next) return false;
  ++taken_;
  next->confidence = rig_.add(*next, cycles_->options());
  statistics_.add_cycle(next->confidence);
  // Until bytes have arrived without delay, the clock estimates arrivals too late; events that were read have arrived.
  cycle.last_event = std::min(arrivals_.arrival_of(next->slices.back().end_us), Clock::now());
  cycle.cycle_s = 0;
  if (previous_ && previous_->first < next->number) {
    cycle.cycle_s = 1e-6 * static_cast<double>(next->begin_us - previous_->second) /
                    (options_.speed * static_cast<double>(next->number - previous_->first));
  }
  previous_ = {next->number, next->begin_us};
  preview_->add_cycle(next->number, next->images);
  static_cast<cycles::Cycle&>(cycle) = *std::move(next);
  cycle.cycles = sum_.add(cycle.images, average_);
  fuse(cycle);
  return true;
}

void LiveReader::prepare_fusion(const capture::SensorProfile& camera, size_t most_cycles) {
  sensor_ = camera;
  most_fused_ = most_cycles;
}

/// Fuses the cycle, which may be skipped later, with those before. Averaging begins anew when it is switched on again.
void LiveReader::fuse(LiveCycle& cycle) {
  if (!is_fusing()) {
    fusion_.reset();
    cycle.fused = {};
    cycle.fused_cycles = 0;
    return;
  }
  if (!fusion_) fusion_.emplace(*sensor_, most_fused_);
  fusion_->add(cycle.images);
  cycle.fused = fusion_->fused();
  const std::vector<float>& cycles = cycle.fused.cycles.values;
  cycle.fused_cycles = std::reduce(cycles.begin(), cycles.end(), 0.0) / static_cast<double>(cycles.size());
}

}  // namespace e2lf::live
