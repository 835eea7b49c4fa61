// SPDX-License-Identifier: MIT
#include "e2lf/live/session.h"

#include "e2lf/base/guarded.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/pipeline/event_depth.h"

namespace e2lf::live {

namespace {

constexpr uint64_t kFirstCycles = 20;

/// Returns the figures of a light field or map that is complete now.
FieldReport report_of(const LiveCycle& cycle, const QualityLevel& level, double reconstruct_s) {
  return {0,
          cycle.number,
          cycle.begin_us,
          cycle.cycles,
          cycle.fused_cycles,
          cycle.events,
          cycle.confidence,
          level,
          reconstruct_s,
          seconds_since(cycle.last_event)};
}

/// The event images in the resolution of a picture, and how many values of the camera each count sums unless they are
/// fused.
struct SizedImages {
  const capture::EventImages& events;
  capture::MeasurementView measured;
  size_t samples;
};

/// `memory` is that of images that are smaller than those of the cycle.
SizedImages images_of(const LiveCycle& cycle, PictureSize size, bool takes_fused, SizedMemory& memory) {
  const size_t side = block_side(size);
  const bool is_fused = takes_fused && !cycle.fused.is_empty();
  if (side > 1) sum_blocks(cycle.images, side, memory.sums);
  if (side > 1 && is_fused) fuse_blocks(cycle.fused, side, memory.fused);
  const capture::EventImages& events = side > 1 ? memory.sums : cycle.images;
  const capture::MeasurementView measured =
      is_fused ? capture::MeasurementView(events, side > 1 ? memory.fused : cycle.fused) : events;
  return {events, measured, cycle.cycles * side * side};
}

/// Returns the finding that a thread ended early. The other threads go on, so that a recording is completed.
diagnose::Finding step_failed(const char* step, const Error& error) {
  return {.code = "live-step-failed",
          .severity = diagnose::Severity::kError,
          .message = cat("the ", step, " ended early: ", error.message),
          .remedy = "start `e2lf live` again",
          .figures = {{"step", step}}};
}

bool is_recent(Clock::rep asked) {
  constexpr std::chrono::seconds kAskedRecently{1};
  return Clock::now().time_since_epoch().count() - asked < Clock::duration(kAskedRecently).count();
}

}  // namespace

Session::Session(std::unique_ptr<LiveReader> reader, std::vector<FieldMaker> makers, SessionOptions options)
    : reader_(std::move(reader)),
      makers_(std::move(makers)),
      options_(std::move(options)),
      pace_(pace_of(options_.size)),
      named_size_(options_.size),
      tone_(options_.tone) {
  if (options_.depth) depth_maker_.emplace(*options_.depth);
}

Session::~Session() {
  join();
}

void Session::join() {
  for (std::thread* thread : {&reading_, &reconstructing_, &showing_, &checking_}) {
    if (thread->joinable()) thread->join();
  }
}

void Session::start() {
  LiveField prepared = prepare();
  reading_ = start_step(
      "reading", [this] { read(); }, [this] { end_reading(); });
  reconstructing_ = start_step(
      "reconstruction", [this, field = std::move(prepared)]() mutable { reconstruct(std::move(field)); },
      [this] { end_reconstruction(); });
  showing_ = start_step(
      "display", [this] { show(); },
      [this] {
        has_ended_ = true;
        picture_changed_.notify_all();
      });
}

template <typename Work, typename AtEnd>
std::thread Session::start_step(const char* step, Work work, AtEnd at_end) {
  return guarded_thread(
      std::move(work),
      [this, step](const Error& error) {
        fail(error);
        reader_->add_findings({step_failed(step, error)});
      },
      std::move(at_end));
}

Result<void> Session::wait() {
  join();
  const std::lock_guard lock(settings_mutex_);
  if (error_) return *error_;
  return {};
}

void Session::fail(const Error& error) {
  const std::lock_guard lock(settings_mutex_);
  if (!error_) error_ = error;
}

void Session::read() {
  LiveCycle cycle;
  for (;;) {
    const Result<bool> more = reader_->next(cycle);
    if (!more) fail(more.error());
    if (!more || !*more) break;
    if (slot_.put(cycle)) reader_->statistics().add_skipped();
  }
}

/// Completes the recording and lets the reconstruction end, however the reading ended.
void Session::end_reading() {
  if (const auto ended = guarded([this] { return reader_->recorder().end(); }); !ended) fail(ended.error());
  slot_.close();
}

void Session::reconstruct(LiveField field) {
  LiveCycle cycle;
  while (slot_.take(cycle)) {
    if (has_depth() && is_recent(depth_asked_)) {
      const Result<FieldReport> made = guarded([&] { return make_depth(cycle); });
      if (!made) fail(made.error());
      // A cycle that is shown in both ways counts once.
      if (!is_recent(picture_asked_)) {
        made ? reader_->statistics().add_field(made->latency_s, made->reconstruct_s, made->level.size)
             : reader_->statistics().add_skipped();
        continue;
      }
    }
    const Result<void> made = guarded([&] { return make(cycle, field); });
    // An error of the reconstruction must not stop the reading, which also writes the recording.
    if (!made) {
      fail(made.error());
      reader_->statistics().add_skipped();
      continue;
    }
    {
      const std::lock_guard lock(field_mutex_);
      std::swap(field, shown_);
      if (std::exchange(is_new_, true)) reader_->statistics().add_skipped();
    }
    field_changed_.notify_one();
  }
  const std::lock_guard lock(field_mutex_);
  if (shown_.serial > 0) begin_check(shown_.cycle, true);
}

/// Lets the display end, however the reconstruction ended.
void Session::end_reconstruction() {
  {
    const std::lock_guard lock(field_mutex_);
    is_last_ = true;
  }
  field_changed_.notify_one();
}

Result<FieldReport> Session::make_depth(const LiveCycle& cycle) {
  const Clock::time_point begin = Clock::now();
  auto next = std::make_shared<ShownDepth>();
  QualityLevel level;
  {
    const std::lock_guard lock(settings_mutex_);
    level.size = named_size_.value_or(PictureSize::kHalf);
  }
  FieldMaker& maker = *depth_maker_;
  const auto [events, measured, samples] = images_of(cycle, level.size, maker.takes_fused(), depth_sized_);
  E2LF_RETURN_IF_ERROR(maker.make(measured, samples, {}, depth_outputs_));
  E2LF_ASSIGN_OR_RETURN(
      pipeline::EventDepth found,
      pipeline::depth_of_outputs(maker.reconstructor().model(), depth_outputs_, events, samples, options_.views));
  for (float& value : found.map.disparity.pixels) value *= static_cast<float>(block_side(level.size));
  next->disparity = std::move(found.map.disparity);
  next->confidence = std::move(found.map.confidence);
  next->picture = std::move(found.picture);
  const LightFieldOutput bright(next->picture.pixels.data(), {1, 1, next->picture.height, next->picture.width, 1});
  recon::apply_tone(bright, 0, recon::auto_gain(bright));
  next->field = report_of(cycle, level, seconds_since(begin));
  if (has_ended_) next->field.latency_s = 0;
  const FieldReport report = next->field;
  {
    const std::lock_guard lock(picture_mutex_);
    next->field.serial = depth_ ? depth_->field.serial + 1 : 1;
    depth_ = std::move(next);
  }
  picture_changed_.notify_all();
  return report;
}

std::shared_ptr<const ShownDepth> Session::depth(uint64_t after, std::chrono::milliseconds patience) {
  if (!has_depth()) return nullptr;
  depth_asked_ = Clock::now().time_since_epoch().count();
  const auto is_wanted = [&] { return depth_ && depth_->field.serial > after; };
  std::unique_lock lock(picture_mutex_);
  if (!has_ended_) picture_changed_.wait_for(lock, patience, is_wanted);
  if (has_ended_ && !is_wanted()) {
    lock.unlock();
    complete_depth();
    lock.lock();
  }
  return is_wanted() ? depth_ : nullptr;
}

/// Computes the disparities of the last cycle if they are missing. The threads must have ended.
void Session::complete_depth() {
  const std::lock_guard one(maker_mutex_);
  LiveCycle cycle;
  {
    const std::scoped_lock lock(picture_mutex_, field_mutex_);
    if (shown_.serial == 0 || (depth_ && depth_->field.cycle >= shown_.cycle.number)) return;
    cycle = shown_.cycle;
  }
  if (const Result<FieldReport> made = make_depth(cycle); !made) fail(made.error());
}

/// Prepares the network and its memory before the source is read, so that the first cycles are not late. An error would
/// also be that of the first cycle.
LiveField Session::prepare() {
  const cycles::CycleReader& cycles = reader_->cycles();
  const recordings::RecordingInfo& info = cycles.recording().info();
  LiveField field;
  LiveCycle dark;
  dark.cycles = reader_->average();
  dark.images = capture::EventImages(cycles.schedule().num_images(), info.height, info.width);
  if (reader_->is_fusing()) {
    dark.fused = {dark.images, Planes<float>(1, info.height, info.width)};
    std::ranges::fill(dark.fused.cycles.values, 1.0F);
  }
  {
    const std::lock_guard lock(settings_mutex_);
    field.level = pace_.level();
  }
  (void)make_views(dark, false, field);
  return field;
}

Result<void> Session::make(LiveCycle& cycle, LiveField& field) {
  const Clock::time_point begin = Clock::now();
  const bool is_late = seconds_since(cycle.last_event) > LateCycles::most_s(cycle.cycle_s);
  const bool has_events = !capture::is_without_events(cycle.images);
  bool finds_tone = false;
  // The check would take the processors from the first cycles, whose pace determines the size.
  if (made_ >= kFirstCycles) begin_check(cycle, false);
  {
    const std::lock_guard lock(settings_mutex_);
    field.level = pace_.level();
    finds_tone = has_events && (!tone_.gain || !tone_.black);
  }
  choose_views(field);
  // The tone is that of the exact values.
  if (finds_tone) field.views.clear();
  E2LF_RETURN_IF_ERROR(make_views(cycle, finds_tone, field));
  const double cycle_s = cycle.cycle_s;
  std::swap(field.cycle, cycle);
  field.reconstruct_s = seconds_since(begin);
  field.serial = ++made_;

  std::unique_lock lock(settings_mutex_);
  const bool changes = field.level == pace_.level() && pace_.add(field.reconstruct_s, cycle_s, is_late);
  const QualityLevel level = pace_.level();
  // As pipeline::FieldSequence determines the brightness.
  if (finds_tone && !tone_.black) tone_.black = recon::auto_black(field.light_field);
  const bool finds_gain = finds_tone && !tone_.gain;
  if (finds_gain) tone_.gain = recon::auto_gain(field.light_field, *tone_.black);
  field.black = tone_.black.value_or(0.0F);
  field.gain = tone_.gain.value_or(1.0F);
  lock.unlock();
  if (finds_gain && options_.judge_gain) {
    if (auto unusual = options_.judge_gain(field.gain)) reader_->add_findings({std::move(*unusual)});
  }
  if (changes && options_.on_level) options_.on_level(level);
  return {};
}

void Session::begin_check(const LiveCycle& cycle, bool is_last) {
  if (!options_.check || checking_.joinable()) return;
  const auto source = reader_->cycles().options().source;
  const bool is_confirmed = !diagnose::is_doubtful(cycle.confidence, source);
  if (!is_last && (!is_confirmed || capture::is_without_events(cycle.images))) return;
  checking_ = start_step(
      "check",
      [this, events = cycle.images, cycles = cycle.cycles, is_confirmed] {
        reader_->add_findings(options_.check(events, cycles, is_confirmed));
      },
      [] {});
}

/// While the settings change, all views are made, so that the next picture need not wait for another light field.
void Session::choose_views(LiveField& field) {
  constexpr std::chrono::seconds kStill{1};
  const lightfield::Shape grid{model().views_y, model().views_x, 1, 1};
  const std::lock_guard lock(field_mutex_);
  field.settings = render_settings_;
  const bool needs_all = !options_.views.is_upright() || Clock::now() - settings_since_ < kStill;
  field.views = needs_all ? std::vector<size_t>() : views_of(grid, render_settings_);
}

Result<void> Session::make_views(const LiveCycle& cycle, bool exactly, LiveField& field) {
  const std::lock_guard lock(maker_mutex_);
  FieldMaker& maker = makers_[field.level.network];
  const auto [events, measured, samples] = images_of(cycle, field.level.size, maker.takes_fused(), sized_);
  E2LF_RETURN_IF_ERROR(maker.make(measured, samples, field.views, field.light_field, exactly));
  if (!options_.views.is_upright()) lightfield::orient(field.light_field, options_.views);
  return {};
}

void Session::show() {
  uint64_t serial = 0;
  for (;;) {
    auto next = std::make_shared<ShownPicture>();
    bool is_new = false;
    {
      std::unique_lock lock(field_mutex_);
      field_changed_.wait(lock, [this] { return is_new_ || is_last_ || (settings_changed_ && shown_.serial > 0); });
      // After the last light field, picture() renders the pictures itself.
      if (is_last_ && !is_new_) break;
      is_new = std::exchange(is_new_, false);
      settings_changed_ = false;
      field_changed_.notify_one();
      const bool can_render = has_views(shown_, views_of(shown_.light_field.shape(), render_settings_));
      // The next light field has the views.
      if (!can_render && !is_new) continue;
      next->settings = can_render ? render_settings_ : shown_.settings;
      next->picture = render(shown_, next->settings);
      next->field = report_of(shown_.cycle, shown_.level, shown_.reconstruct_s);
      next->field.serial = shown_.serial;
    }
    next->serial = ++serial;
    const FieldReport report = next->field;
    {
      const std::lock_guard lock(picture_mutex_);
      picture_ = std::move(next);
    }
    picture_changed_.notify_all();
    if (!is_new) continue;
    reader_->statistics().add_field(report.latency_s, report.reconstruct_s, report.level.size);
    if (options_.on_field) options_.on_field(report);
  }
}

std::shared_ptr<const ShownPicture> Session::picture(const RenderSettings& settings, uint64_t after,
                                                     std::chrono::milliseconds patience) {
  picture_asked_ = Clock::now().time_since_epoch().count();
  {
    const std::lock_guard lock(field_mutex_);
    if (!(settings == render_settings_)) {
      render_settings_ = settings;
      settings_since_ = Clock::now();
      settings_changed_ = true;
    }
  }
  field_changed_.notify_one();
  const auto is_wanted = [&] { return picture_ && picture_->serial > after && picture_->settings == settings; };
  std::unique_lock lock(picture_mutex_);
  if (!has_ended_) picture_changed_.wait_for(lock, patience, is_wanted);
  if (is_wanted()) return picture_;
  if (!picture_ || picture_->settings == settings) return nullptr;
  const std::lock_guard field_lock(field_mutex_);
  if (!has_views(shown_, views_of(shown_.light_field.shape(), settings)) && !complete()) return nullptr;
  if (!has_ended_) {
    settings_changed_ = true;
    field_changed_.notify_one();
    return nullptr;
  }
  // The threads have ended: this one makes the picture.
  auto next = std::make_shared<ShownPicture>(*picture_);
  ++next->serial;
  next->settings = settings;
  next->picture = render(shown_, settings);
  picture_ = std::move(next);
  return picture_;
}

std::optional<float> Session::disparity_at(float x, float y) {
  LiveField field;
  {
    const std::lock_guard lock(field_mutex_);
    if (shown_.serial == 0) return std::nullopt;
    if (shown_.views.empty()) return live::disparity_at(shown_, x, y);
    field = shown_.without_views();
  }
  // The comparison needs all views of the same cycle.
  if (const Result<void> made = make_views(field.cycle, false, field); !made) {
    fail(made.error());
    return std::nullopt;
  }
  return live::disparity_at(field, x, y);
}

/// Computes the missing views of the displayed light field, unless the next one is being reconstructed. field_mutex_
/// must be locked.
bool Session::complete() {
  const std::unique_lock idle(maker_mutex_, std::try_to_lock);
  if (!idle.owns_lock()) return false;
  const Result<void> made = shown_.complete([this](LiveField& field) { return make_views(field.cycle, false, field); });
  if (!made) fail(made.error());
  return made.ok();
}

std::optional<LiveField> Session::freeze() {
  std::optional<LiveField> frozen;
  {
    const std::lock_guard lock(field_mutex_);
    if (shown_.serial == 0) return frozen;
    frozen = shown_.without_views();
  }
  if (const Result<void> made = make_views(frozen->cycle, true, *frozen); !made) {
    fail(made.error());
    return std::nullopt;
  }
  recon::apply_tone(frozen->light_field, frozen->black, frozen->gain);
  return frozen;
}

std::optional<lightfield::ByteImage> Session::fused_cycles() {
  constexpr size_t kStep = 4;
  const std::lock_guard lock(field_mutex_);
  const Planes<float>& cycles = shown_.cycle.fused.cycles;
  if (cycles.values.empty()) return std::nullopt;
  lightfield::ByteImage map((cycles.width + kStep - 1) / kStep, (cycles.height + kStep - 1) / kStep, 1);
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    const size_t y = i / map.width * kStep, x = i % map.width * kStep;
    map.pixels[i] = static_cast<uint8_t>(std::min(255.0F, std::round(cycles.values[y * cycles.width + x])));
  }
  return map;
}

Pace Session::pace_of(std::optional<PictureSize> size) const {
  std::vector<double> macs;
  for (const FieldMaker& maker : makers_) macs.push_back(model::macs_per_pixel(maker.reconstructor().model().network));
  return Pace(macs, size);
}

void Session::set_size(std::optional<PictureSize> size) {
  const std::lock_guard lock(settings_mutex_);
  named_size_ = size;
  pace_ = pace_of(size);
}

void Session::measure_tone() {
  const std::lock_guard lock(settings_mutex_);
  tone_ = options_.tone;
}

Json Session::json() {
  Json json = reader_->statistics().json();
  json["average"] = reader_->average();
  json["fuse"] = reader_->most_fused();
  json["is_fusing"] = reader_->is_fusing();
  json["fuse_obstacle"] = options_.fuse_obstacle;
  json["has_ended"] = has_ended();
  json["has_depth"] = has_depth();
  const cycles::Schedule& schedule = reader_->cycles().schedule();
  json["schedule"] = {{"patterns", schedule.size()}, {"cycle_us", schedule.cycle_us()}};
  const std::lock_guard lock(settings_mutex_);
  json["size"] = size_name(pace_.level().size);
  json["size_choice"] = word_of(named_size_, kPictureSizes);
  json["network"] = model(pace_.level().network).name;
  json["gain"] = tone_.gain ? Json(*tone_.gain) : Json();
  json["black"] = tone_.black ? Json(*tone_.black) : Json();
  json["error"] = error_ ? Json(error_->text()) : Json();
  return json;
}

}  // namespace e2lf::live
