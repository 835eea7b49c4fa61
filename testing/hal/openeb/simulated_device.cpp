// SPDX-License-Identifier: MIT
// A plugin of the vendor's HAL (OpenEB 5) with one simulated camera, which behaves like the stand-in in testing/hal.
#include <chrono>
#include <fcntl.h>
#include <metavision/hal/facilities/i_erc_module.h>
#include <metavision/hal/facilities/i_events_stream.h>
#include <metavision/hal/facilities/i_geometry.h>
#include <metavision/hal/facilities/i_hw_identification.h>
#include <metavision/hal/facilities/i_ll_biases.h>
#include <metavision/hal/facilities/i_roi.h>
#include <metavision/hal/facilities/i_trigger_in.h>
#include <metavision/hal/plugin/plugin.h>
#include <metavision/hal/plugin/plugin_entrypoint.h>
#include <metavision/hal/utils/camera_discovery.h>
#include <metavision/hal/utils/data_transfer.h>
#include <metavision/hal/utils/device_builder.h>
#include <metavision/hal/utils/device_config.h>
#include <metavision/hal/utils/hal_connection_exception.h>
#include <metavision/hal/utils/hal_error_code.h>
#include <metavision/hal/utils/hal_exception.h>
#include <metavision/hal/utils/hal_log.h>
#include <metavision/hal/utils/hal_software_info.h>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

#include "scenario.h"

namespace {

namespace mv = Metavision;

class TriggerIn final : public mv::I_TriggerIn {
 public:
  bool enable(const Channel& channel) override { return on_[channel] = true; }
  bool disable(const Channel& channel) override { return !(on_[channel] = false); }
  bool is_enabled(const Channel& channel) const override { return on_.count(channel) == 1 && on_.at(channel); }
  std::map<Channel, short> get_available_channels() const override {
    return {{Channel::Main, 0}, {Channel::Aux, 6}, {Channel::Loopback, 7}};
  }

 private:
  std::map<Channel, bool> on_;
};

/// Sends the words of the scenario's file from the thread of the HAL.
class Producer final : public mv::DataTransfer::RawDataProducer {
 public:
  Producer(Scenario scenario, std::string format, std::shared_ptr<TriggerIn> triggers, int lock)
      : scenario_(std::move(scenario)), format_(std::move(format)), triggers_(std::move(triggers)), lock_(lock) {}
  ~Producer() override {
    if (lock_ >= 0) ::close(lock_);
  }

  void run_impl(const mv::DataTransfer& transfer) override {
    const std::vector<uint8_t> words = visible_words();
    const uint64_t size = number(scenario_, "buffer", 4096), never = UINT64_MAX;
    const uint64_t unplug_at = number(scenario_, "unplug_at", never), end_at = number(scenario_, "end_at", never);
    const auto period = std::chrono::microseconds(number(scenario_, "period_us", 1000));
    const bool loops = scenario_.count("loop") == 1 && !words.empty();
    auto due = std::chrono::steady_clock::now();
    for (uint64_t done = 0; !transfer.should_stop();) {
      if (done >= unplug_at) {
        throw mv::HalConnectionException(101001, mv::hal_error_category(), "the simulated camera is unplugged");
      }
      if (done >= end_at) return;
      const uint64_t at = words.empty() ? 0 : done % words.size();
      const uint64_t left = std::min(unplug_at, end_at) - done;
      const uint64_t count = loops || done < words.size() ? std::min({size, words.size() - at, left}) : 0;
      if (count > 0) {
        auto buffer = pool_.acquire();
        buffer->assign(words.begin() + static_cast<long>(at), words.begin() + static_cast<long>(at + count));
        transfer.transfer_data(buffer);
      }
      done += count;
      due = count == 0 ? std::chrono::steady_clock::now() + std::chrono::milliseconds(1) : due + period;
      std::this_thread::sleep_until(due);
    }
  }

 private:
  std::vector<uint8_t> visible_words() {
    unsigned inputs = 0;
    for (const auto& [channel, id] : triggers_->get_available_channels()) {
      inputs |= static_cast<unsigned>(triggers_->is_enabled(channel)) << id;
    }
    std::vector<uint8_t> words = words_of(scenario_["file"]);
    return format_.rfind("EVT3", 0) == 0 ? with_triggers(std::move(words), inputs) : words;
  }

  Scenario scenario_;
  std::string format_;
  std::shared_ptr<TriggerIn> triggers_;
  int lock_;
  mv::DataTransfer::DefaultBufferPool pool_ = mv::DataTransfer::DefaultBufferPool::make_unbounded();
};

class Geometry final : public mv::I_Geometry {
 public:
  explicit Geometry(const Scenario& scenario)
      : width_(static_cast<int>(number(scenario, "width", 1280))),
        height_(static_cast<int>(number(scenario, "height", 720))) {}
  int get_width() const override { return width_; }
  int get_height() const override { return height_; }

 private:
  int width_, height_;
};

class Identification final : public mv::I_HW_Identification {
 public:
  Identification(const std::shared_ptr<mv::I_PluginSoftwareInfo>& plugin, std::string serial, std::string format)
      : I_HW_Identification(plugin), serial_(std::move(serial)), format_(std::move(format)) {}
  std::string get_serial() const override { return serial_; }
  SensorInfo get_sensor_info() const override { return {4, 2, "IMX636"}; }
  std::vector<std::string> get_available_data_encoding_formats() const override { return {"EVT3", "EVT21"}; }
  std::string get_current_data_encoding_format() const override { return format_; }
  std::string get_integrator() const override { return "e2lf"; }
  std::string get_connection_type() const override { return "USB"; }

 private:
  mv::DeviceConfigOptionMap get_device_config_options_impl() const override { return {}; }
  std::string serial_, format_;
};

class Biases final : public mv::I_LL_Biases {
 public:
  explicit Biases(const mv::DeviceConfig& config) : I_LL_Biases(config) {}
  std::map<std::string, int> get_all_biases() const override { return values_; }

 private:
  bool set_impl(const std::string& name, int value) override {
    values_.at(name) = value;
    return true;
  }
  int get_impl(const std::string& name) const override { return values_.at(name); }
  bool get_bias_info_impl(const std::string& name, mv::LL_Bias_Info& info) const override {
    info = mv::LL_Bias_Info(-100, 100, "", /*modifiable=*/true);
    return values_.count(name) == 1;
  }
  std::map<std::string, int> values_ = {{"bias_diff_off", 0}, {"bias_diff_on", 0}, {"bias_fo", 0}, {"bias_hpf", 0}};
};

class EventRate final : public mv::I_ErcModule {
 public:
  bool enable(bool is_on) override {
    is_on_ = is_on;
    return true;
  }
  bool is_enabled() const override { return is_on_; }
  bool set_cd_event_rate(uint32_t events_per_s) override {
    if (events_per_s > get_max_supported_cd_event_rate()) return false;
    events_per_s_ = events_per_s;
    return true;
  }
  uint32_t get_min_supported_cd_event_rate() const override { return 0; }
  uint32_t get_max_supported_cd_event_rate() const override { return 160'000'000; }
  uint32_t get_cd_event_rate() const override { return events_per_s_; }
  uint32_t get_count_period() const override { return 1'000'000; }
  bool set_cd_event_count(uint32_t count) override { return set_cd_event_rate(count); }
  uint32_t get_min_supported_cd_event_count() const override { return 0; }
  uint32_t get_max_supported_cd_event_count() const override { return get_max_supported_cd_event_rate(); }
  uint32_t get_cd_event_count() const override { return events_per_s_; }
  void erc_from_file(const std::string&) override {}

 private:
  bool is_on_ = false;
  uint32_t events_per_s_ = 20'000'000;
};

class Regions final : public mv::I_ROI {
 public:
  bool enable(bool is_on) override {
    is_on_ = is_on;
    return true;
  }
  bool is_enabled() const override { return is_on_; }
  bool set_mode(const Mode&) override { return true; }
  Mode get_mode() const override { return Mode::ROI; }
  size_t get_max_supported_windows_count() const override { return 18; }
  std::vector<Window> get_windows() const override { return windows_; }
  bool get_lines(std::vector<bool>&, std::vector<bool>&) const override { return false; }
  bool set_lines(const std::vector<bool>&, const std::vector<bool>&) override { return false; }

 private:
  bool set_windows_impl(const std::vector<Window>& windows) override {
    windows_ = windows;
    return true;
  }
  bool is_on_ = false;
  std::vector<Window> windows_;
};

class Discovery final : public mv::CameraDiscovery {
 public:
  SerialList list() override {
    const std::vector<std::string> serials = split(scenario()["serial"], ',');
    return {serials.begin(), serials.end()};
  }
  SystemList list_available_sources() override {
    SystemList found;
    for (const std::string& serial : list()) found.push_back({serial, mv::USB_LINK});
    return found;
  }
  bool is_for_local_camera() const override { return true; }

  bool discover(mv::DeviceBuilder& builder, const std::string& serial, const mv::DeviceConfig& config) override {
    Scenario known = scenario();
    const SerialList serials = list();
    if (serials.empty() || known.count("busy") == 1) return false;
    if (!serial.empty() && std::find(serials.begin(), serials.end(), serial) == serials.end()) return false;
    int lock = -1;
    if (known.count("lock") == 1) {
      lock = ::open(known["lock"].c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
      if (::flock(lock, LOCK_EX | LOCK_NB) != 0) return ::close(lock), false;
    }
    if (config.format() == "EVT21" || config.format() == "EVT3") known.emplace("format", config.format());
    const std::string format = known.count("format") == 1 ? known["format"] : "EVT3";
    const std::string name = serial.empty() ? serials.front() : serial;
    MV_HAL_LOG_INFO() << "stand-in camera" << name << "opened";
    const std::shared_ptr<mv::I_HW_Identification> identification =
        builder.add_facility(std::make_unique<Identification>(builder.get_plugin_software_info(), name, format));
    builder.add_facility(std::make_unique<Geometry>(known));
    builder.add_facility(std::make_unique<Biases>(config));
    builder.add_facility(std::make_unique<EventRate>());
    builder.add_facility(std::make_unique<Regions>());
    const std::shared_ptr<TriggerIn> triggers = builder.add_facility(std::make_unique<TriggerIn>());
    builder.add_facility(std::make_unique<mv::I_EventsStream>(std::make_unique<Producer>(known, format, triggers, lock),
                                                              identification));
    return true;
  }
};

}  // namespace

void initialize_plugin(void* plugin_pointer) {
  mv::Plugin& plugin = mv::plugin_cast(plugin_pointer);
  plugin.set_integrator_name("e2lf");
  plugin.set_plugin_info(mv::get_hal_software_info());
  plugin.set_hal_info(mv::get_hal_software_info());
  plugin.add_camera_discovery(std::make_unique<Discovery>());
}
