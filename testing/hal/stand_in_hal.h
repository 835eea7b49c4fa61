// SPDX-License-Identifier: MIT
// The part of the vendor's HAL that e2lf calls, with one simulated camera. See stand_in below.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

/// The environment variable E2LF_STAND_IN describes the simulated camera, as "serial=A1;file=rec.raw;unplug_at=5000":
///   serial     of the listed cameras, separated by commas; the first one is simulated; empty: there is none
///   busy       another program has the camera
///   lock       a file that is locked while the camera is open, so that a second program finds it busy
///   file       the RAW recording whose words the camera sends; it sends nothing after the end, unless `loop` is set
///   loop       sends the words repeatedly
///   buffer     number of bytes in a buffer (4096); period_us: time between two buffers (1000; 0 = full speed)
///   unplug_at  number of bytes after which the connection is lost; end_at: the same for the end of the stream
///   refuse_aux the trigger input Aux cannot be switched on; filters: anti-flicker and trail filter are on at first
///   format     the name of the encoding (EVT3)
namespace stand_in {

uint64_t bytes_sent();         ///< number of bytes that the last opened camera sent
uint64_t bytes_taken();        ///< number of these that get_latest_raw_data() returned
uint64_t most_bytes_queued();  ///< largest number of bytes in the queue

}  // namespace stand_in

namespace Metavision {

class BaseException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class HalException : public BaseException {
 public:
  using BaseException::BaseException;
};
class HalConnectionException : public BaseException {
 public:
  using BaseException::BaseException;
};

void setLogStream(std::ostream& stream);

class DeviceConfig {
 public:
  void set_format(const std::string& format) { format_ = format; }
  std::string format() const { return format_; }

 private:
  std::string format_;
};

class RawFileHeader {
 public:
  using HeaderMap = std::map<std::string, std::string>;
  explicit RawFileHeader(HeaderMap map) : map_(std::move(map)) {}
  const HeaderMap& get_header_map() const { return map_; }

 private:
  HeaderMap map_;
};

class DataTransfer {
 public:
  class BufferPtr {
   public:
    BufferPtr() = default;
    explicit BufferPtr(std::vector<uint8_t> bytes) : bytes_(std::make_shared<std::vector<uint8_t>>(std::move(bytes))) {}
    const uint8_t* data() const { return bytes_ == nullptr ? nullptr : bytes_->data(); }
    size_t size() const { return bytes_ == nullptr ? 0 : bytes_->size(); }

   private:
    std::shared_ptr<std::vector<uint8_t>> bytes_;
  };
  using NewBufferCallback_t = std::function<void(const BufferPtr&)>;
  size_t add_new_buffer_callback(NewBufferCallback_t callback) {
    callbacks.push_back(std::move(callback));
    return callbacks.size() - 1;
  }

  std::vector<NewBufferCallback_t> callbacks;
};

struct Camera;  // stand_in.cpp

class I_EventsStream {
 public:
  explicit I_EventsStream(Camera& camera) : camera_(camera) {}
  void start();
  void stop();
  short poll_buffer();
  short wait_next_buffer();
  DataTransfer::BufferPtr get_latest_raw_data();
  const DataTransfer& get_data_transfer() const;

 private:
  Camera& camera_;
};

class I_Geometry {
 public:
  explicit I_Geometry(Camera& camera) : camera_(camera) {}
  int get_width() const;
  int get_height() const;

 private:
  Camera& camera_;
};

class I_HW_Identification {
 public:
  struct SensorInfo {
    uint16_t major_version_ = 0, minor_version_ = 0;
    std::string name_;
  };
  explicit I_HW_Identification(Camera& camera) : camera_(camera) {}
  std::string get_serial() const;
  SensorInfo get_sensor_info() const { return {4, 2, "IMX636"}; }
  std::vector<std::string> get_available_data_encoding_formats() const { return {"EVT3", "EVT21"}; }
  std::string get_current_data_encoding_format() const;
  std::string get_integrator() const { return "e2lf"; }
  std::string get_connection_type() const { return "USB"; }
  RawFileHeader get_header() const;

 private:
  Camera& camera_;
};

class I_TriggerIn {
 public:
  enum class Channel { Main, Aux, Loopback };
  bool enable(const Channel& channel);
  bool disable(const Channel& channel) { return on_.erase(channel) == 1 || true; }
  bool is_enabled(const Channel& channel) const { return on_.count(channel) == 1; }
  std::map<Channel, short> get_available_channels() const {
    return {{Channel::Main, 0}, {Channel::Aux, 6}, {Channel::Loopback, 7}};
  }

 private:
  std::set<Channel> on_;
};

class LL_Bias_Info {
 public:
  std::pair<int, int> get_bias_range() const { return {-80, 140}; }
};

class I_LL_Biases {
 public:
  bool set(const std::string& name, int value) { return (biases_.at(name) = value, true); }
  bool get_bias_info(const std::string& name, LL_Bias_Info&) const { return biases_.count(name) == 1; }
  std::map<std::string, int> get_all_biases() const { return biases_; }
  void load_from_file(const std::filesystem::path& file);
  void save_to_file(const std::filesystem::path& file) const;

 private:
  std::map<std::string, int> biases_ = {{"bias_diff_off", 0}, {"bias_diff_on", 0}, {"bias_fo", 0}, {"bias_hpf", 0}};
};

class I_ErcModule {
 public:
  bool enable(bool on) { return (is_on_ = on, true); }
  bool is_enabled() const { return is_on_; }
  bool set_cd_event_rate(uint32_t events_per_s);
  uint32_t get_cd_event_rate() const { return events_per_s_; }
  uint32_t get_min_supported_cd_event_rate() const { return 0; }
  uint32_t get_max_supported_cd_event_rate() const { return 160'000'000; }

 private:
  bool is_on_ = false;
  uint32_t events_per_s_ = 20'000'000;
};

class I_ROI {
 public:
  struct Window {
    Window(int x0, int y0, int w, int h) : x(x0), y(y0), width(w), height(h) {}
    int x, y, width, height;
  };
  bool enable(bool on) { return (is_on_ = on, true); }
  bool is_enabled() const { return is_on_; }
  bool set_windows(const std::vector<Window>& windows) { return (windows_ = windows, true); }
  std::vector<Window> get_windows() const { return windows_; }
  size_t get_max_supported_windows_count() const { return 18; }

 private:
  bool is_on_ = false;
  std::vector<Window> windows_;
};

class Filter {
 public:
  Filter();
  bool enable(bool on) { return (is_on_ = on, true); }
  bool is_enabled() const { return is_on_; }

 private:
  bool is_on_;
};
class I_AntiFlickerModule : public Filter {};
class I_EventTrailFilterModule : public Filter {};

class Device {
 public:
  Device(std::unique_ptr<Camera> camera);
  ~Device();
  template <typename Facility>
  Facility* get_facility();

 private:
  struct Facilities;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<Facilities> facilities_;
};

class DeviceDiscovery {
 public:
  using SerialList = std::list<std::string>;
  static SerialList list();
  static std::unique_ptr<Device> open(const std::string& serial, const DeviceConfig& config = {});
};

}  // namespace Metavision
