// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <fcntl.h>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

#include "scenario.h"
#include "stand_in_hal.h"

namespace {

std::ostream* g_log = &std::cerr;
std::atomic<uint64_t> g_sent, g_taken, g_most_queued;

}  // namespace

namespace stand_in {
uint64_t bytes_sent() {
  return g_sent;
}
uint64_t bytes_taken() {
  return g_taken;
}
uint64_t most_bytes_queued() {
  return g_most_queued;
}
}  // namespace stand_in

namespace Metavision {

void setLogStream(std::ostream& stream) {
  g_log = &stream;
}

/// Sends buffers from a thread of its own into a queue without bounds, as the vendor's does.
struct Camera {
  Camera(Scenario known, std::string name, int held) : scenario(std::move(known)), serial(std::move(name)), lock(held) {
    const auto stated = scenario.find("format");
    format = stated == scenario.end() ? "EVT3" : stated->second;
    *g_log << "[HAL][INFO] stand-in camera " << serial << " opened" << std::endl;
  }
  ~Camera() {
    stop();
    if (lock >= 0) ::close(lock);
  }

  void start() {
    stop();
    is_stopped = false;
    g_sent = g_taken = g_most_queued = 0;
    thread = std::thread([this] { send(); });
  }
  void stop() {
    {
      const std::lock_guard guard(mutex);
      is_stopped = true;
      queue.clear();
    }
    changed.notify_all();
    if (thread.joinable()) thread.join();
  }

  /// The words without the triggers of inputs that are off.
  std::vector<uint8_t> visible_words() {
    unsigned inputs = 0;
    for (const auto& [channel, id] : trigger_in.get_available_channels()) {
      inputs |= static_cast<unsigned>(trigger_in.is_enabled(channel)) << id;
    }
    std::vector<uint8_t> words = words_of(scenario["file"]);
    return format.starts_with("EVT3") ? with_triggers(std::move(words), inputs) : words;
  }

  void send() {
    const std::vector<uint8_t> words = visible_words();
    const uint64_t size = number(scenario, "buffer", 4096), never = UINT64_MAX;
    const uint64_t unplug_at = number(scenario, "unplug_at", never), end_at = number(scenario, "end_at", never);
    const auto period = std::chrono::microseconds(number(scenario, "period_us", 1000));
    const bool loops = scenario.count("loop") == 1 && !words.empty();
    auto due = std::chrono::steady_clock::now();
    for (uint64_t done = 0;;) {
      std::unique_lock guard(mutex);
      if (is_stopped) return;
      if (done >= std::min(unplug_at, end_at)) {
        is_lost = unplug_at <= end_at;
        is_stopped = true;
        changed.notify_all();
        return;
      }
      const uint64_t at = words.empty() ? 0 : done % words.size();
      const uint64_t left = std::min(unplug_at, end_at) - done;
      const uint64_t count = loops || done < words.size() ? std::min({size, words.size() - at, left}) : 0;
      if (count > 0) {
        const auto first = words.begin() + static_cast<long>(at);
        const DataTransfer::BufferPtr buffer(std::vector<uint8_t>(first, first + static_cast<long>(count)));
        queue.push_back(buffer);
        queued += count;
        g_most_queued = std::max<uint64_t>(g_most_queued, queued);
        g_sent += count;
        done += count;
        changed.notify_all();
        // The vendor's HAL calls others after its own queue has the buffer, without its lock.
        guard.unlock();
        for (const auto& callback : transfer.callbacks) callback(buffer);
        guard.lock();
      }
      due += period;
      if (count == 0) due = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
      changed.wait_until(guard, due, [this] { return is_stopped; });
    }
  }

  void check_connection() const {
    if (is_stopped && is_lost) throw HalConnectionException("\n------\nError 101001\nConnection lost\n------\n");
  }

  Scenario scenario;
  std::string serial, format;
  int lock;
  I_TriggerIn trigger_in;
  std::mutex mutex;
  std::condition_variable changed;
  DataTransfer transfer;
  std::deque<DataTransfer::BufferPtr> queue;
  uint64_t queued = 0;
  bool is_stopped = true, is_lost = false;
  std::thread thread;
};

void I_EventsStream::start() {
  camera_.start();
}
void I_EventsStream::stop() {
  camera_.stop();
}

short I_EventsStream::poll_buffer() {
  const std::lock_guard guard(camera_.mutex);
  camera_.check_connection();
  if (!camera_.queue.empty()) return 1;
  return camera_.is_stopped ? -1 : 0;
}

short I_EventsStream::wait_next_buffer() {
  std::unique_lock guard(camera_.mutex);
  camera_.changed.wait(guard, [this] { return !camera_.queue.empty() || camera_.is_stopped; });
  camera_.check_connection();
  return camera_.queue.empty() ? -1 : 1;
}

DataTransfer::BufferPtr I_EventsStream::get_latest_raw_data() {
  const std::lock_guard guard(camera_.mutex);
  camera_.check_connection();
  if (camera_.queue.empty()) return {};
  const DataTransfer::BufferPtr buffer = camera_.queue.front();
  camera_.queue.pop_front();
  camera_.queued -= buffer.size();
  g_taken += buffer.size();
  return buffer;
}

const DataTransfer& I_EventsStream::get_data_transfer() const {
  return camera_.transfer;
}

int I_Geometry::get_width() const {
  return static_cast<int>(number(camera_.scenario, "width", 1280));
}
int I_Geometry::get_height() const {
  return static_cast<int>(number(camera_.scenario, "height", 720));
}

std::string I_HW_Identification::get_serial() const {
  return camera_.serial;
}
std::string I_HW_Identification::get_current_data_encoding_format() const {
  return camera_.format;
}
RawFileHeader I_HW_Identification::get_header() const {
  return RawFileHeader({{"serial_number", camera_.serial}, {"system_ID", "49"}, {"plugin_name", "stand_in"}});
}

void I_LL_Biases::load_from_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    int value = 0;
    std::string percent, name;
    if (!(words >> value >> percent >> name) || biases_.count(name) == 0) {
      throw HalException("cannot load " + path.string() + "\nunknown bias: " + line);
    }
    biases_[name] = value;
  }
}

void I_LL_Biases::save_to_file(const std::filesystem::path& path) const {
  std::ofstream file(path);
  for (const auto& [name, value] : biases_) file << value << " % " << name << "\n";
}

bool I_TriggerIn::enable(const Channel& channel) {
  if (channel == Channel::Aux && scenario().count("refuse_aux") == 1) return false;
  on_.insert(channel);
  return true;
}

Filter::Filter() : is_on_(scenario().count("filters") == 1) {}

bool I_ErcModule::set_cd_event_rate(uint32_t events_per_s) {
  if (events_per_s > get_max_supported_cd_event_rate()) return false;
  events_per_s_ = events_per_s;
  return true;
}

struct Device::Facilities {
  explicit Facilities(Camera& camera) : stream(camera), geometry(camera), identification(camera) {}
  I_EventsStream stream;
  I_Geometry geometry;
  I_HW_Identification identification;
  I_LL_Biases biases;
  I_ErcModule erc;
  I_ROI roi;
  I_AntiFlickerModule anti_flicker;
  I_EventTrailFilterModule trail_filter;
};

Device::Device(std::unique_ptr<Camera> camera)
    : camera_(std::move(camera)), facilities_(std::make_unique<Facilities>(*camera_)) {}
Device::~Device() = default;

// clang-format off
template <> I_EventsStream* Device::get_facility() { return &facilities_->stream; }
template <> I_Geometry* Device::get_facility() { return &facilities_->geometry; }
template <> I_HW_Identification* Device::get_facility() { return &facilities_->identification; }
template <> I_TriggerIn* Device::get_facility() { return &camera_->trigger_in; }
template <> I_LL_Biases* Device::get_facility() { return &facilities_->biases; }
template <> I_ErcModule* Device::get_facility() { return &facilities_->erc; }
template <> I_ROI* Device::get_facility() { return &facilities_->roi; }
template <> I_AntiFlickerModule* Device::get_facility() { return &facilities_->anti_flicker; }
template <> I_EventTrailFilterModule* Device::get_facility() { return &facilities_->trail_filter; }
// clang-format on

DeviceDiscovery::SerialList DeviceDiscovery::list() {
  SerialList names;
  for (const std::string& serial : split(scenario()["serial"], ',')) names.push_back("e2lf:stand_in:" + serial);
  return names;
}

std::unique_ptr<Device> DeviceDiscovery::open(const std::string& name, const DeviceConfig& config) {
  Scenario known = scenario();
  const std::vector<std::string> serials = split(known["serial"], ',');
  const std::string serial = name.substr(name.rfind(':') + 1);
  if (serials.empty() || known.count("busy") == 1) return nullptr;
  if (!serial.empty() && std::find(serials.begin(), serials.end(), serial) == serials.end()) return nullptr;
  int lock = -1;
  if (known.count("lock") == 1) {
    lock = ::open(known["lock"].c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
      ::close(lock);
      return nullptr;
    }
  }
  if (config.format() == "EVT21" || config.format() == "EVT3") known.emplace("format", config.format());
  return std::make_unique<Device>(
      std::make_unique<Camera>(std::move(known), serial.empty() ? serials.front() : serial, lock));
}

}  // namespace Metavision
