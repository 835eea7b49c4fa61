// SPDX-License-Identifier: MIT
#include "e2lf/live/session.h"

#include "e2lf/base/guarded.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"

namespace e2lf::live {

namespace {

constexpr uint64_t kFirstCycles = 20;

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
      options_(std::move(options)),
      networks_(std::move(makers), options_.views),
      tuning_(networks_.pace(options_.size), options_.size, options_.tone) {
  if (options_.depth) depth_.emplace(*options_.depth, options_.views);
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
        pictures_.close();
        if (depth_) depth_->maps().close();
      });
}

template <typename Work, typename AtEnd>
std::thread Session::start_step(const char* step, Work work, AtEnd at_end) {
  return guarded_thread(
      std::move(work),
      [this, step](const Error& error) {
        tuning_.fail(error);
        reader_->add_findings({step_failed(step, error)});
      },
      std::move(at_end));
}

Result<void> Session::wait() {
  join();
  if (auto error = tuning_.error()) return *std::move(error);
  return {};
}

void Session::read() {
  LiveCycle cycle;
  for (;;) {
    const Result<bool> more = reader_->next(cycle);
    if (!more) tuning_.fail(more.error());
    if (!more || !*more) break;
    if (slot_.put(cycle)) reader_->statistics().add_skipped();
  }
}

/// Completes the recording and lets the reconstruction end, however the reading ended.
void Session::end_reading() {
  if (const auto ended = guarded([this] { return reader_->recorder().end(); }); !ended) tuning_.fail(ended.error());
  slot_.close();
}

void Session::reconstruct(LiveField field) {
  LiveCycle cycle;
  while (slot_.take(cycle)) {
    if (has_depth() && is_recent(depth_asked_)) {
      const Result<FieldReport> made = guarded([&] { return make_depth(cycle); });
      if (!made) tuning_.fail(made.error());
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
      tuning_.fail(made.error());
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
  return depth_->make(cycle, tuning_.named_size().value_or(PictureSize::kHalf), has_ended_);
}

std::shared_ptr<const ShownDepth> Session::depth(uint64_t after, std::chrono::milliseconds patience) {
  if (!has_depth()) return nullptr;
  depth_asked_ = Clock::now().time_since_epoch().count();
  const auto is_wanted = [&](const ShownDepth& map) { return map.field.serial > after; };
  auto map = depth_->maps().wait(patience, is_wanted);
  if (map || !has_ended_) return map;
  // The threads have ended: this one makes the map of the last cycle if it is missing.
  LiveCycle cycle;
  {
    const std::lock_guard lock(field_mutex_);
    if (shown_.serial == 0) return nullptr;
    cycle = shown_.cycle;
  }
  if (const Result<FieldReport> made = make_depth(cycle); !made) tuning_.fail(made.error());
  return depth_->maps().wait({}, is_wanted);
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
  field.level = tuning_.level();
  (void)networks_.make(dark, false, field);
  return field;
}

Result<void> Session::make(LiveCycle& cycle, LiveField& field) {
  const Clock::time_point begin = Clock::now();
  const bool is_late = seconds_since(cycle.last_event) > LateCycles::most_s(cycle.cycle_s);
  const bool has_events = !capture::is_without_events(cycle.images);
  // The check would take the processors from the first cycles, whose pace determines the size.
  if (made_ >= kFirstCycles) begin_check(cycle, false);
  field.level = tuning_.level();
  const bool finds_tone = has_events && tuning_.finds_tone();
  choose_views(field);
  // The tone is that of the exact values.
  if (finds_tone) field.views.clear();
  E2LF_RETURN_IF_ERROR(networks_.make(cycle, finds_tone, field));
  const double cycle_s = cycle.cycle_s;
  std::swap(field.cycle, cycle);
  field.reconstruct_s = seconds_since(begin);
  field.serial = ++made_;

  const Tuning::Change change = tuning_.add(cycle_s, is_late, finds_tone, field);
  if (change.gain && options_.judge_gain) {
    if (auto unusual = options_.judge_gain(*change.gain)) reader_->add_findings({std::move(*unusual)});
  }
  if (change.level && options_.on_level) options_.on_level(*change.level);
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
    pictures_.put(std::move(next));
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
  const auto is_wanted = [&](const ShownPicture& picture) {
    return picture.serial > after && picture.settings == settings;
  };
  if (auto picture = pictures_.wait(patience, is_wanted)) return picture;
  const std::lock_guard lock(field_mutex_);
  const auto newest = pictures_.newest();
  if (!newest || newest->settings == settings) return nullptr;
  if (!has_views(shown_, views_of(shown_.light_field.shape(), settings)) && !complete()) return nullptr;
  if (!has_ended_) {
    settings_changed_ = true;
    field_changed_.notify_one();
    return nullptr;
  }
  // The threads have ended: this one makes the picture.
  auto next = std::make_shared<ShownPicture>(*newest);
  ++next->serial;
  next->settings = settings;
  next->picture = render(shown_, settings);
  pictures_.put(next);
  return next;
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
  if (const Result<void> made = networks_.make(field.cycle, false, field); !made) {
    tuning_.fail(made.error());
    return std::nullopt;
  }
  return live::disparity_at(field, x, y);
}

/// Computes the missing views of the displayed light field, unless the next one is being reconstructed. field_mutex_
/// must be locked.
bool Session::complete() {
  const Result<bool> made = networks_.complete_if_free(shown_);
  if (!made) tuning_.fail(made.error());
  return made.value_or(false);
}

Result<LiveField> Session::freeze() {
  LiveField frozen;
  {
    const std::lock_guard lock(field_mutex_);
    if (shown_.serial == 0) return fail(ErrorCode::kNotFound, "", "there is no light field yet; wait for one");
    frozen = shown_.without_views();
  }
  E2LF_RETURN_IF_ERROR(networks_.make(frozen.cycle, true, frozen));
  recon::apply_tone(frozen.light_field, frozen.black, frozen.gain);
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
  json["network"] = model(tuning_.level().network).name;
  tuning_.describe(json);
  return json;
}

QualityLevel Tuning::level() const {
  const std::lock_guard lock(mutex_);
  return pace_.level();
}

std::optional<PictureSize> Tuning::named_size() const {
  const std::lock_guard lock(mutex_);
  return named_size_;
}

void Tuning::set_size(std::optional<PictureSize> named_size, const Pace& pace) {
  const std::lock_guard lock(mutex_);
  named_size_ = named_size;
  pace_ = pace;
}

bool Tuning::finds_tone() const {
  const std::lock_guard lock(mutex_);
  return !tone_.gain || !tone_.black;
}

void Tuning::set_tone(const pipeline::Tone& tone) {
  const std::lock_guard lock(mutex_);
  tone_ = tone;
}

Tuning::Change Tuning::add(double cycle_s, bool is_late, bool finds_tone, LiveField& field) {
  const std::lock_guard lock(mutex_);
  Change change;
  if (field.level == pace_.level() && pace_.add(field.reconstruct_s, cycle_s, is_late)) change.level = pace_.level();
  // As pipeline::FieldSequence determines the brightness.
  if (finds_tone && !tone_.black) tone_.black = recon::auto_black(field.light_field);
  if (finds_tone && !tone_.gain) {
    change.gain = recon::auto_gain(field.light_field, *tone_.black);
    tone_.gain = change.gain;
  }
  field.black = tone_.black.value_or(0.0F);
  field.gain = tone_.gain.value_or(1.0F);
  return change;
}

void Tuning::fail(const Error& error) {
  if (error.code == ErrorCode::kCancelled) return;  // as the user asked
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = error;
}

std::optional<Error> Tuning::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void Tuning::describe(Json& json) const {
  const std::lock_guard lock(mutex_);
  json["size"] = size_name(pace_.level().size);
  json["size_choice"] = word_of(named_size_, kPictureSizes);
  json["gain"] = tone_.gain ? Json(*tone_.gain) : Json();
  json["black"] = tone_.black ? Json(*tone_.black) : Json();
  json["error"] = error_ ? Json(error_->text()) : Json();
}

}  // namespace e2lf::live
