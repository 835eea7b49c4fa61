// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/v4l2_camera.h"

#include <atomic>
#include <chrono>
#include <optional>

#include "e2lf/base/text.h"
#include "e2lf/recordings/live/camera_header.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::recordings {
namespace {

constexpr char kDeviceFolder[] = "/dev";

V4l2System& kernel() {
  static V4l2System system;
  return system;
}

class V4l2Camera final : public Camera {
 public:
  V4l2Camera(V4l2System& system, std::string folder, std::string address)
      : system_(system), folder_(std::move(folder)), address_(std::move(address)) {}

  Result<void> set_up(const CameraSetup& setup) override {
    encoding_ = setup.encoding;
    CameraSetup others = setup;
    others.encoding.clear();
    if (others == CameraSetup()) return {};
    return Error{ErrorCode::kUnsupported,
                 "the drivers of Linux have no common settings for trigger inputs, biases, event rate and regions; "
                 "leave the options out, and set the controls of the sensor with v4l2-ctl",
                 name()};
  }

  Result<void> start() override {
    E2LF_ASSIGN_OR_RETURN(const std::string path, device_path());
    E2LF_ASSIGN_OR_RETURN(V4l2Device device, V4l2Device::open(system_, path, encoding_));
    device_.emplace(std::move(device));
    E2LF_RETURN_IF_ERROR(device_->start());
    const V4l2Encoding& encoding = device_->encoding();
    const std::string size = cat(device_->width(), "x", device_->height());
    header_ = camera_header({{"evt", encoding.raw.version},
                             {"format", cat(encoding.raw.format, encoding.endianness, ";height=", device_->height(),
                                            ";width=", device_->width())},
                             {"geometry", size},
                             {"plugin_name", "v4l2"},
                             {"sensor_name", device_->card()},
                             {"driver", device_->driver()}});
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes.assign(header_.begin(), header_.end());
    header_.clear();
    frame_.lost = 0;
    uint64_t lost = 0;
    while (bytes.empty()) {
      const bool is_stopped = is_stopped_;
      if (is_stopped && Clock::now() > stop_time_.load() + kLongestDrain) return false;
      E2LF_ASSIGN_OR_RETURN(const bool came, device_->read(is_stopped ? 0 : kPollMs, frame_));
      if (!came && is_stopped) return false;
      if (!came) continue;
      lost += frame_.lost;
      bytes.swap(frame_.bytes);
    }
    frame_.lost = lost;
    return true;
  }

  uint64_t lost_buffers() override { return frame_.lost; }

  void stop() override {
    stop_time_ = Clock::now();
    is_stopped_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kPollMs = 100;                             // longest delay of a stop
  static constexpr auto kLongestDrain = std::chrono::seconds(1);  ///< because a camera continues to send

  [[nodiscard]] std::string name() const { return cat("camera://v4l2", address_.empty() ? "" : "/", address_); }

  [[nodiscard]] Result<std::string> device_path() const {
    if (address_.starts_with('/')) return address_;
    if (!address_.empty()) return cat(folder_, "/", address_);
    const std::vector<std::string> found = find_v4l2_devices(system_, folder_);
    if (found.empty()) {
      return Error{ErrorCode::kNotFound,
                   cat("no device in ", folder_, " sends events; load the driver of the sensor, or give its device"),
                   name()};
    }
    return cat(folder_, "/", found.front());
  }

  V4l2System& system_;
  std::string folder_, address_, encoding_, header_;
  std::optional<V4l2Device> device_;
  V4l2Frame frame_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<Clock::time_point> stop_time_;
};

}  // namespace

CameraPtr make_v4l2_camera(V4l2System& system, const std::string& folder, const std::string& address) {
  return std::make_unique<V4l2Camera>(system, folder, address);
}

Result<CameraPtr> open_v4l2_camera(const std::string& address) {
  return make_v4l2_camera(kernel(), kDeviceFolder, address);
}

Result<std::vector<std::string>> list_v4l2_cameras() {
  return find_v4l2_devices(kernel(), kDeviceFolder);
}

}  // namespace e2lf::recordings
