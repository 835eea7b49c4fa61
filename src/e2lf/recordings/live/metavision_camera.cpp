// SPDX-License-Identifier: MIT
// Compiled only if the vendor's open HAL is found. Its exceptions are caught here.
#include <atomic>
#include <exception>
#include <metavision/hal/device/device.h>
#include <metavision/hal/device/device_discovery.h>
#include <metavision/hal/facilities/i_events_stream.h>
#include <metavision/hal/facilities/i_geometry.h>
#include <metavision/hal/facilities/i_hw_identification.h>

#include "e2lf/base/text.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::recordings {
namespace {

/// Converts "EVT3" or "EVT3;height=720;..." to the version number of a RAW header.
std::string version_of(const std::string& format) {
  if (format.starts_with("EVT3")) return "3.0";
  return format.starts_with("EVT21") || format.starts_with("EVT2.1") ? "2.1" : "2.0";
}

/// Returns the newest bytes of a stream: a pointer and a length in OpenEB 4, a buffer since OpenEB 5.
template <typename Stream>
void copy_latest(Stream& stream, std::vector<uint8_t>& bytes) {
  if constexpr (requires(long count) { stream.get_latest_raw_data(count); }) {
    long count = 0;
    const auto* data = stream.get_latest_raw_data(count);
    bytes.assign(data, data + count);
  } else {
    const auto buffer = stream.get_latest_raw_data();
    bytes.assign(buffer.data(), buffer.data() + buffer.size());
  }
}

class MetavisionCamera final : public Camera {
 public:
  explicit MetavisionCamera(std::unique_ptr<Metavision::Device> device)
      : device_(std::move(device)), stream_(device_->get_facility<Metavision::I_EventsStream>()) {}

  [[nodiscard]] bool can_stream() const { return stream_ != nullptr; }

  Result<void> start() override try {
    header_ = make_header();
    stream_->start();
    return {};
  } catch (const std::exception& error) {
    return failure(error);
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override try {
    bytes.clear();
    if (!header_.empty()) {
      bytes.assign(header_.begin(), header_.end());
      header_.clear();
      return true;
    }
    if (is_stopped_ || stream_->wait_next_buffer() < 0) return false;
    copy_latest(*stream_, bytes);
    return true;
  } catch (const std::exception& error) {
    return failure(error);
  }

  void stop() override {
    is_stopped_ = true;
    try {
      stream_->stop();
    } catch (const std::exception&) {  // NOLINT: a camera that is gone has stopped
    }
  }

 private:
  static Error failure(const std::exception& error) {
    return {ErrorCode::kIo, cat("the camera's driver failed (", error.what(), "); check its connection"), "metavision"};
  }

  [[nodiscard]] std::string make_header() const {
    const auto* geometry = device_->get_facility<Metavision::I_Geometry>();
    const auto* identity = device_->get_facility<Metavision::I_HW_Identification>();
    std::string header =
        "% evt " + version_of(identity != nullptr ? identity->get_current_data_encoding_format() : "EVT3");
    if (identity != nullptr) header += "\n% serial_number " + identity->get_serial();
    if (geometry != nullptr) header += cat("\n% geometry ", geometry->get_width(), "x", geometry->get_height());
    return header + "\n% end\n";
  }

  std::unique_ptr<Metavision::Device> device_;
  Metavision::I_EventsStream* stream_;
  std::string header_;
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace

Result<std::unique_ptr<Camera>> open_metavision_camera(const std::string& serial) try {
  auto device = Metavision::DeviceDiscovery::open(serial);
  if (device == nullptr) {
    return Error{ErrorCode::kNotFound, "no such camera; check its connection and the HAL's plugins", serial};
  }
  auto opened = std::make_unique<MetavisionCamera>(std::move(device));
  if (!opened->can_stream())
    return Error{ErrorCode::kUnsupported, "the camera does not provide a stream of events", serial};
  std::unique_ptr<Camera> camera = std::move(opened);
  return camera;
} catch (const std::exception& error) {
  return Error{ErrorCode::kIo, cat("the camera cannot be opened (", error.what(), "); check its connection"), serial};
}

}  // namespace e2lf::recordings
