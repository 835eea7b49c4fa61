// SPDX-License-Identifier: MIT
// Compiled only if the vendor's open HAL is found. Its exceptions are caught here.

#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <metavision/hal/device/device.h>
#include <metavision/hal/device/device_discovery.h>
#include <metavision/hal/facilities/i_events_stream.h>
#include <metavision/hal/facilities/i_hw_identification.h>
#include <metavision/hal/utils/device_config.h>
#include <metavision/hal/utils/hal_connection_exception.h>
#include <metavision/sdk/base/utils/log.h>
#include <mutex>
#include <optional>
#include <ostream>
#include <streambuf>
#include <thread>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::cameras {
namespace {

/// Forwards the messages of the HAL to our log line by line. The HAL writes from several threads.
class HalLog final : public std::streambuf {
 protected:
  int overflow(int character) override {
    if (character == traits_type::eof()) return 0;
    const char one = static_cast<char>(character);
    xsputn(&one, 1);
    return character;
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const char c : std::string_view(text, static_cast<size_t>(count))) {
      if (c != '\n') {
        line_ += c;
      } else if (const std::string line = std::exchange(line_, {}); !line.empty()) {
        log_info("the camera's HAL: " + header_text(line));
      }
    }
    return count;
  }

 private:
  std::mutex mutex_;
  std::string line_;
};

/// Redirects the output of the HAL from stderr, and limits the memory of its USB plugin, which has no limit by default.
void prepare_hal() {
  static std::once_flag once;
  std::call_once(once, [] {
    static auto* const log = new std::ostream(new HalLog);  // the HAL's threads may outlive static objects
    Metavision::setLogStream(*log);
    ::setenv("MV_PSEE_PLUGIN_DATA_TRANSFER_BUFFER_POOL_BYTE_SIZE", "134217728", /*overwrite=*/0);
  });
}

std::string hal_encoding(const std::string& encoding) {
  if (encoding == "evt2") return "EVT2";
  return encoding == "evt2.1" ? "EVT21" : "EVT3";
}

/// Returns "EVT3" for "EVT3;height=720;width=1280".
std::string bare_format(const std::string& format) {
  return format.substr(0, format.find(';'));
}

using namespace std::chrono_literals;

void copy_buffer(const Metavision::DataTransfer::BufferPtr& buffer, std::vector<uint8_t>& bytes) {
  if (buffer.size() > 0) bytes.assign(buffer.data(), buffer.data() + buffer.size());
}

/// The buffers that the HAL has received and not yet handed out, in order. When the camera is unplugged, the HAL no
/// longer hands them out.
class UnreadBuffers {
 public:
  using Buffer = Metavision::DataTransfer::BufferPtr;

  /// Called by the thread of the HAL, possibly after the buffer was taken.
  void add(const Buffer& buffer) {
    const std::lock_guard lock(mutex_);
    if (num_early_ > 0) {
      --num_early_;
    } else {
      buffers_.push_back(buffer);
    }
  }
  /// Removes the first buffer and returns it, or nothing if there is none.
  std::optional<Buffer> take() {
    const std::lock_guard lock(mutex_);
    if (buffers_.empty()) return std::nullopt;
    Buffer buffer = std::move(buffers_.front());
    buffers_.pop_front();
    return buffer;
  }
  /// Removes the buffer that the HAL handed out.
  void forget() {
    if (take()) return;
    const std::lock_guard lock(mutex_);
    ++num_early_;
  }

 private:
  std::mutex mutex_;
  std::deque<Buffer> buffers_;
  size_t num_early_ = 0;  ///< number of buffers that were handed out before add() was called
};

/// The HAL discards the content of its queue when it is stopped. The queue is therefore emptied as soon as the HAL
/// reports data, and the HAL is stopped only when it is empty.
class MetavisionCamera final : public Camera {
 public:
  explicit MetavisionCamera(std::string address) : address_(std::move(address)) {}
  ~MetavisionCamera() override { end_stream(); }

  Result<void> set_up(const CameraSetup& setup) override {
    setup_ = setup;
    return {};
  }

  Result<void> start() override try {
    E2LF_ASSIGN_OR_RETURN(device_, open_device(address_, setup_.encoding));
    stream_ = device_->get_facility<Metavision::I_EventsStream>();
    if (stream_ == nullptr) return fail(ErrorCode::kUnsupported, name(), "the camera provides no stream of events");
    E2LF_RETURN_IF_ERROR(set_up_device(*device_, setup_));
    header_ = device_header(*device_);
    biases_ = device_biases(*device_);
    // The stream itself is not constant, but it gives no other access.
    auto& transfer = const_cast<Metavision::DataTransfer&>(stream_->get_data_transfer());
    transfer.add_new_buffer_callback(
        [unread = unread_](const Metavision::DataTransfer::BufferPtr& buffer) { unread->add(buffer); });
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
    while (bytes.empty()) {
      is_waiting_ = true;  // before the test of is_stopped_, as stop() sets and tests them in the opposite order
      const short state = is_stopped_ ? stream_->poll_buffer() : stream_->wait_next_buffer();
      is_waiting_ = false;
      const bool is_late = is_stopped_ && Clock::now() > stop_time_.load() + kLongestDrain;
      if (is_stopped_ && (state <= 0 || is_late)) {
        end_stream();
        return false;
      }
      if (state < 0) return fail(ErrorCode::kIo, name(), "the stream of the camera ended by itself; start it again");
      copy_buffer(stream_->get_latest_raw_data(), bytes);
      unread_->forget();
    }
    return true;
  } catch (const Metavision::HalConnectionException& error) {
    is_waiting_ = false;
    while (const auto buffer = unread_->take()) {
      copy_buffer(*buffer, bytes);
      if (!bytes.empty()) return true;
    }
    return fail(ErrorCode::kIo, name(), "the connection to the camera is lost (", hal_text(error),
                "); check its cable");
  } catch (const std::exception& error) {
    return failure(error);
  }

  void stop() override {
    stop_time_ = Clock::now();
    is_stopped_ = true;
    // If the camera sends nothing, only the end of the HAL ends the wait of read(); its queue is empty then.
    while (is_waiting_ && Clock::now() < stop_time_.load() + kLongestWait) std::this_thread::sleep_for(1ms);
    if (is_waiting_) end_stream();
  }

  std::string bias_file_text() const override { return biases_; }

  std::vector<CameraControl> controls() override try {
    return device_controls(*device_);
  } catch (const std::exception&) {
    return {};
  }

  Result<void> change(const std::string& setting, const std::string& value) override try {
    return change_device(*device_, setting, value);
  } catch (const std::exception& error) {
    return failure(error);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kLongestWait = 50ms;
  static constexpr auto kLongestDrain = 1s;  ///< limited because a camera continues to send

  [[nodiscard]] std::string name() const { return "camera://metavision" + (address_.empty() ? "" : "/" + address_); }

  [[nodiscard]] Error failure(const std::exception& error) const {
    return fail(ErrorCode::kIo, name(), "the camera's driver failed (", hal_text(error), "); check its connection");
  }

  void end_stream() {
    if (stream_ == nullptr) return;
    std::call_once(end_, [this] {
      try {
        stream_->stop();
      } catch (const std::exception&) {  // NOLINT: an unplugged camera has stopped
      }
    });
  }

  std::string address_;
  CameraSetup setup_;
  std::unique_ptr<Metavision::Device> device_;
  Metavision::I_EventsStream* stream_ = nullptr;
  std::shared_ptr<UnreadBuffers> unread_ = std::make_shared<UnreadBuffers>();
  std::string header_, biases_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<bool> is_waiting_ = false;  ///< whether read() waits for data
  std::once_flag end_;
  std::atomic<Clock::time_point> stop_time_;
};

}  // namespace

std::string hal_text(const std::exception& error) {
  std::string text;
  for (const char c : std::string(error.what())) {
    const bool is_space = std::isspace(static_cast<unsigned char>(c)) != 0;
    const bool is_rule = c == '-' && (text.empty() || text.ends_with('-'));  // the HAL frames its messages
    if (!is_space && !is_rule) text += c;
    if (is_space && !text.empty() && text.back() != ' ') text += ' ';
  }
  while (text.ends_with(' ') || text.ends_with('-')) text.pop_back();
  return header_text(text);
}

Result<std::vector<std::string>> list_metavision_cameras() try {
  prepare_hal();
  // A plugin that the HAL finds in two folders lists its cameras twice.
  auto names = Metavision::DeviceDiscovery::list();
  names.sort();
  names.unique();
  return std::vector<std::string>(names.begin(), names.end());
} catch (const std::exception& error) {
  return fail(ErrorCode::kIo, "", "the HAL cannot list cameras (", hal_text(error), "); check its plugins");
}

Result<std::unique_ptr<Metavision::Device>> open_device(const std::string& address, const std::string& encoding) {
  prepare_hal();
  Metavision::DeviceConfig config;
  if (!encoding.empty()) config.set_format(hal_encoding(encoding));
  std::string reason;
  std::unique_ptr<Metavision::Device> device;
  try {
    device = Metavision::DeviceDiscovery::open(address, config);
  } catch (const std::exception& error) {
    reason = cat(" (the HAL reports: ", hal_text(error), ")");
  }
  if (device == nullptr) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<std::string> listed, list_metavision_cameras());
    Error error = unopened_error(address, listed);
    error.message += reason;
    return error;
  }
  const auto* const identity = device->get_facility<Metavision::I_HW_Identification>();
  if (identity == nullptr) return fail(ErrorCode::kUnsupported, address, "the camera does not state its encoding");
  const std::string format = bare_format(identity->get_current_data_encoding_format());
  const bool is_read = format == "EVT2" || format == "EVT21" || format == "EVT2.1" || format == "EVT3";
  if (is_read && (encoding.empty() || format == hal_encoding(encoding))) return device;
  const std::vector<std::string> offered = identity->get_available_data_encoding_formats();
  return fail(ErrorCode::kUnsupported, "camera://metavision", "the camera sends ", header_text(format),
              is_read ? "" : ", which e2lf cannot read", "; it offers ", header_text(join(offered)),
              ", of which e2lf reads the encodings evt2, evt2.1 and evt3");
}

Result<CameraPtr> open_metavision_camera(const std::string& address) {
  return CameraPtr(std::make_unique<MetavisionCamera>(address));
}

}  // namespace e2lf::cameras
