// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/camera.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <thread>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::recordings {
namespace {

constexpr std::string_view kCameraScheme = "camera://", kReplay = "replay:", kTcp = "tcp://";

struct CameraName {
  std::string plugin, address;
};

CameraName parse_name(const std::string& name) {
  if (name.starts_with(kReplay)) return {"replay", name.substr(kReplay.size())};
  if (name.starts_with(kTcp)) return {"tcp", name.substr(kTcp.size())};
  const std::string rest = name.substr(kCameraScheme.size());
  const size_t slash = std::min(rest.find('/'), rest.size());
  return {rest.substr(0, slash), slash < rest.size() ? rest.substr(slash + 1) : ""};
}

struct Registry {
  std::mutex mutex;
  std::vector<CameraPlugin> plugins;
  std::vector<std::function<std::vector<CameraPlugin>()>> loaders;  ///< not called yet
};

Registry& registry() {
  static Registry instance;
  return instance;
}

const CameraPlugin* find_known(const std::vector<CameraPlugin>& plugins, const std::string& name) {
  const auto found = std::ranges::find_if(plugins, [&](const auto& one) { return one.name == name; });
  return found == plugins.end() ? nullptr : &*found;
}

/// Adds the plugins that were not loaded yet. The mutex of the registry must be locked.
void load_plugins(Registry& known) {
  for (const auto& load : std::exchange(known.loaders, {})) {
    for (CameraPlugin& plugin : load()) {
      if (find_known(known.plugins, plugin.name) == nullptr) {
        known.plugins.push_back(std::move(plugin));
      } else {
        log_warning(cat("a camera plugin is left out: there is another one with the name ", plugin.name));
      }
    }
  }
}

/// Returns the plugin with this name; `location` is that of errors. Fails with kNotFound, listing those that exist.
Result<CameraPlugin> find_camera_plugin(const std::string& name, const std::string& location) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  const std::vector<CameraPlugin>& plugins = registry().plugins;
  if (find_known(plugins, name) == nullptr) load_plugins(registry());
  if (const CameraPlugin* const found = find_known(plugins, name)) return *found;
  if (name == "metavision") {
    return fail(ErrorCode::kMissingDependency, location,
                "this build does not contain the vendor's HAL; install it and build again");
  }
  std::vector<std::string> names;
  for (const CameraPlugin& plugin : plugins) names.push_back(plugin.name);
  return fail(ErrorCode::kNotFound, location, "there is no camera plugin \"", name,
              "\"; write camera://NAME with one of ", join(names),
              ", or give the file of a plugin in E2LF_CAMERA_PLUGINS");
}

using Clock = std::chrono::steady_clock;

struct Chunk {
  std::vector<uint8_t> bytes;
  Clock::time_point arrival;
  std::optional<LiveGap> gap = {};  ///< data missing before it
};

/// What the thread that reads a camera shares with its reader. The thread holds it, too: if the camera's driver does
/// not return, both are left behind.
struct Intake {
  explicit Intake(CameraPtr started) : camera(std::move(started)) {}

  /// Moves the bytes that the camera delivers to `waiting`. Runs in the thread.
  void take_bytes() {
    std::vector<uint8_t> bytes;
    for (bool more = true; more;) {
      const Result<bool> delivered = camera->read(bytes);
      const Clock::time_point now = Clock::now();
      std::unique_lock<std::mutex> lock(mutex);
      if (has_ended) return;  // the reader waited for it in vain
      if (!delivered) error = delivered.error();
      more = delivered && *delivered && !is_discarding;
      if (more) note_lost(camera->lost_buffers());
      if (more && !bytes.empty()) last_arrival = now;
      if (more && !bytes.empty() && make_room(lock, bytes.size())) {
        waiting_bytes += bytes.size();
        waiting.push_back({std::move(bytes), now, std::exchange(missing, std::nullopt)});
        bytes = {};
      }
      if (!more && missing) waiting.push_back({{}, now, missing});
      has_ended = !more;
      changed.notify_all();
    }
  }

  void note_lost(uint64_t buffers) {
    if (buffers == 0) return;
    backlog.lost_buffers += buffers;
    if (!missing) missing.emplace();
    missing->lost_buffers += buffers;
  }

  /// Returns true if there is room for bytes that have arrived. A sender waits for room; without it, bytes of a camera
  /// are dropped.
  bool make_room(std::unique_lock<std::mutex>& lock, size_t bytes) {
    if (waiting_bytes < kMaxWaitingBytes) return true;
    if (camera->keeps_unread()) {
      ++backlog.pauses;
      changed.wait(lock, [this] { return waiting_bytes < kMaxWaitingBytes || is_discarding; });
      return true;
    }
    if (!missing) missing.emplace();
    if (missing->dropped_bytes == 0) ++backlog.pauses;
    missing->dropped_bytes += bytes;
    backlog.loses_events = true;
    backlog.dropped_bytes += bytes;
    return false;
  }

  const CameraPtr camera;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::deque<Chunk> waiting;
  size_t waiting_bytes = 0;
  std::optional<Clock::time_point> last_arrival;
  bool has_ended = false;
  bool is_discarding = false;      ///< whether the reader has gone
  std::optional<LiveGap> missing;  ///< data missing before the next bytes
  LiveBacklog backlog;
  std::optional<Error> error;
};

class CameraSource final : public LiveSource {
 public:
  CameraSource(CameraPtr camera, std::string name)
      : intake_(std::make_shared<Intake>(std::move(camera))),
        name_(std::move(name)),
        thread_([intake = intake_] { intake->take_bytes(); }) {}
  ~CameraSource() override {
    std::unique_lock<std::mutex> lock(intake_->mutex);
    intake_->is_discarding = true;
    intake_->changed.notify_all();
    if (!is_stopping_) stop_camera(lock);
    const auto has_ended = [this] { return intake_->has_ended; };
    const bool returns = !has_hung_ && intake_->changed.wait_until(lock, last_end(), has_ended);
    lock.unlock();
    if (returns) {
      thread_.join();
    } else {
      thread_.detach();
    }
  }

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    std::unique_lock<std::mutex> lock(intake_->mutex);
    for (;;) {
      if (!is_stopping_ && (stop_requested() || Clock::now() >= end_)) stop_camera(lock);
      if (buffer_.size() - begin_ >= wanted) break;
      std::deque<Chunk>& waiting = intake_->waiting;
      if (!waiting.empty()) {
        if (waiting.front().gap && position_ + buffer_.size() == 0) take_gap();  // nothing is cut there
        if (waiting.front().gap) break;
        append_waiting();
      } else if (intake_->has_ended) {
        if (position_ == 0 && buffer_.empty() && intake_->error) return *intake_->error;
        if (intake_->error) intake_->backlog.failure = intake_->error->text();
        break;
      } else if (is_stopping_ && Clock::now() >= last_end()) {
        has_hung_ = intake_->has_ended = true;
        intake_->error =
            fail(ErrorCode::kIo, name_, "the camera was stopped, but its driver does not return; restart the camera");
      } else {
        report_silence(lock);
        intake_->changed.wait_for(lock, kNap);  // a signal does not notify this condition variable
      }
    }
    const LiveBacklog& backlog = intake_->backlog;
    const int64_t longest_behind_us = 1000 * intake_->camera->patience().reader.count();
    const bool has_failed = !backlog.failure.empty() && !std::exchange(is_failure_reported_, true);
    const bool is_behind = (backlog.most_behind_us >= longest_behind_us || backlog.loses_events) &&
                           !std::exchange(is_behind_reported_, true);
    const bool has_lost = backlog.lost_buffers > 0 && !std::exchange(is_loss_reported_, true);
    const std::string behind = is_behind ? behind_text() : "";
    lock.unlock();  // the recipient of the message may block
    if (is_behind) intake_->camera->keeps_unread() ? log_info(behind) : log_warning(behind);
    if (has_lost)
      log_warning(cat(name_, ": the camera or its driver loses data; check the cable and the load of the computer"));
    if (has_failed) log_warning(cat(intake_->error->text(), "; the data before that are kept"));
    return std::span<const uint8_t>(buffer_).subspan(begin_);
  }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= buffer_.size() - begin_, "more consumed than fetched");
    begin_ += count;
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t) override {
    return fail(ErrorCode::kUnsupported, name_, "a live source is not seekable; record it to a file first");
  }
  bool seekable() const override { return false; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::string name() const override { return name_; }
  DecodeSummary left_out() const override {
    DecodeSummary all = intake_->camera->left_out();
    const std::lock_guard<std::mutex> lock(intake_->mutex);
    all.live = intake_->backlog;
    return all;
  }
  std::optional<Clock::time_point> arrival() const override { return arrival_; }
  bool pass_break() override {
    const std::lock_guard<std::mutex> lock(intake_->mutex);
    if (intake_->waiting.empty() || !intake_->waiting.front().gap) return false;
    consume(buffer_.size() - begin_);
    take_gap();
    return true;
  }
  void end_at(Clock::time_point time) override { end_ = time; }
  std::string bias_file_text() const override { return intake_->camera->bias_file_text(); }
  std::shared_ptr<Camera> camera() const { return {intake_, intake_->camera.get()}; }

 private:
  static constexpr auto kNap = std::chrono::milliseconds(50);

  /// Requests the end of the camera. Bytes that have arrived by then are still returned.
  void stop_camera(std::unique_lock<std::mutex>& lock) {
    is_stopping_ = true;
    lock.unlock();
    intake_->camera->stop();
    lock.lock();
    stop_time_ = Clock::now();
  }

  /// Returns when the camera must have ended after it was stopped.
  [[nodiscard]] Clock::time_point last_end() const { return stop_time_ + intake_->camera->patience().end; }

  /// Warns once if a camera has sent data and then nothing for a long time.
  void report_silence(std::unique_lock<std::mutex>& lock) {
    const auto longest = intake_->camera->patience().silence;
    if (is_silence_reported_ || !intake_->last_arrival || Clock::now() - *intake_->last_arrival < longest) return;
    is_silence_reported_ = true;
    if (intake_->camera->keeps_unread()) return;  // a sender may pause
    lock.unlock();
    const std::chrono::duration<double> seconds = longest;
    log_warning(cat(name_, ": no data have arrived for ", seconds.count(), " s; check the camera and its connection"));
    lock.lock();
  }

  void take_gap() {
    std::optional<LiveGap>& gap = intake_->waiting.front().gap;
    gap->byte = position_;
    intake_->backlog.add_gap(*gap);
    gap.reset();
  }

  /// Appends the waiting bytes, up to a place where bytes are missing, to the rest of the buffer.
  void append_waiting() {
    std::deque<Chunk>& waiting = intake_->waiting;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(begin_));
    begin_ = 0;
    is_silence_reported_ = false;
    int64_t& most_behind_us = intake_->backlog.most_behind_us;
    const auto behind = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - waiting.front().arrival);
    most_behind_us = std::max<int64_t>(most_behind_us, behind.count());
    while (!waiting.empty() && !waiting.front().gap) {
      const Chunk& chunk = waiting.front();
      buffer_.insert(buffer_.end(), chunk.bytes.begin(), chunk.bytes.end());
      arrival_ = chunk.arrival;
      intake_->waiting_bytes -= chunk.bytes.size();
      waiting.pop_front();
    }
    intake_->changed.notify_all();
  }

  /// Returns the message that is logged once if the reader is too slow.
  std::string behind_text() const {
    return cat(name_, ": the input arrives faster than it is processed: the data that are read now arrived ",
               static_cast<double>(intake_->backlog.most_behind_us / 100'000) * 0.1, " s ago. Up to ",
               kMaxWaitingBytes >> 20U, " MiB wait in memory; above that, ",
               intake_->camera->keeps_unread() ? "the sender waits, and nothing is lost"
                                               : "the data of the camera are dropped",
               ". Record the input to a file and process that, or choose a faster method");
  }

  std::shared_ptr<Intake> intake_;
  std::string name_;
  bool is_behind_reported_ = false, is_loss_reported_ = false, is_failure_reported_ = false,
       is_silence_reported_ = false;
  bool is_stopping_ = false;
  bool has_hung_ = false;  ///< whether the driver did not return after the camera was stopped
  Clock::time_point end_ = Clock::time_point::max(), stop_time_ = {};
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0;
  uint64_t position_ = 0;
  std::optional<Clock::time_point> arrival_;  ///< arrival of the last bytes of the buffer
  std::thread thread_;
};

}  // namespace

bool is_camera_name(const std::string& name) {
  return name.starts_with(kCameraScheme) || name.starts_with(kReplay) || name.starts_with(kTcp);
}

std::filesystem::path path_of_camera(const std::string& name) {
  const CameraName parsed = parse_name(name);
  if (parsed.plugin == "replay") return parsed.address.substr(0, replay_path_size(parsed.address));
  return parsed.plugin == "pipe" ? parsed.address : "";
}

bool is_live_recording(const std::string& name) {
  return name == "-" || is_camera_name(name) || is_stream(name);
}

bool has_cameras() {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  return !registry().plugins.empty() || !registry().loaders.empty();
}

size_t replay_path_size(const std::string& address) {
  return is_present(address) ? address.size() : std::min(address.rfind('?'), address.size());
}

std::vector<CameraPlugin> camera_plugins() {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  load_plugins(registry());
  return registry().plugins;
}

void add_camera_plugin(const CameraPlugin& plugin) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  std::erase_if(registry().plugins, [&](const CameraPlugin& known) { return known.name == plugin.name; });
  registry().plugins.push_back(plugin);
}

void add_camera_plugins(std::function<std::vector<CameraPlugin>()> load) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  registry().loaders.push_back(std::move(load));
}

Result<void> Camera::set_up(const CameraSetup& setup) {
  if (!has_settings(setup)) return {};
  return fail(ErrorCode::kUnsupported, "",
              "this input has no settings of a camera (trigger inputs, biases, event rate, regions, encoding); leave "
              "them out");
}

Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name, const CameraSetup& setup) {
  if (!is_live_recording(name)) {
    return fail(ErrorCode::kInvalidValue, name,
                "this is not a live input; give a camera (camera://NAME), tcp://ADDRESS:PORT, replay:FILE, a named "
                "pipe or -");
  }
  const CameraName parsed = is_camera_name(name) ? parse_name(name) : CameraName{"pipe", name == "-" ? "" : name};
  E2LF_ASSIGN_OR_RETURN(const CameraPlugin plugin, find_camera_plugin(parsed.plugin, name));
  E2LF_ASSIGN_OR_RETURN(CameraPtr camera, plugin.open(parsed.address));
  return start_camera_source(std::move(camera), name, setup);
}

Result<std::unique_ptr<LiveSource>> start_camera_source(CameraPtr camera, std::string name, const CameraSetup& setup) {
  E2LF_RETURN_IF_ERROR(camera->set_up(setup));
  E2LF_RETURN_IF_ERROR(camera->start());
  auto source = std::make_unique<CameraSource>(std::move(camera), std::move(name));
  if (setup.running) setup.running->set(source->camera());
  return std::unique_ptr<LiveSource>(std::move(source));
}

Result<void> Camera::change(const std::string& name, const std::string& /*value*/) {
  return fail(ErrorCode::kUnsupported, "", "the camera cannot change ", name, " while it runs");
}

void RunningCamera::set(const std::shared_ptr<Camera>& camera) {
  const std::lock_guard lock(mutex_);
  camera_ = camera;
  controls_ = camera->controls();
}

std::vector<CameraControl> RunningCamera::controls() const {
  const std::lock_guard lock(mutex_);
  return controls_;
}

Result<void> RunningCamera::change(const std::string& name, const std::string& value) {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<Camera> camera = camera_.lock();
  if (!camera) return fail(ErrorCode::kNotFound, "", "no camera runs");
  const Result<void> changed = camera->change(name, value);
  controls_ = camera->controls();  // also after a refusal: the page shows what the camera has
  return changed;
}

}  // namespace e2lf::recordings
