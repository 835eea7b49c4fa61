// SPDX-License-Identifier: MIT
// Compiled only where the vendor's open HAL is found.
#include <cctype>
#include <cstdlib>
#include <metavision/hal/device/device_discovery.h>
#include <metavision/hal/facilities/i_hw_identification.h>
#include <metavision/hal/utils/device_config.h>
#include <metavision/sdk/base/utils/log.h>
#include <mutex>
#include <ostream>
#include <streambuf>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cameras/metavision_device.h"
#include "e2lf/cameras/usb_cameras.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::recordings {
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
      } else if (const std::string said = std::exchange(line_, {}); !said.empty()) {
        log_info("the camera's HAL: " + one_line(said));
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
  static const bool is_prepared = [] {
    static auto* const log = new std::ostream(new HalLog);  // the HAL's threads may outlive static objects
    Metavision::setLogStream(*log);
    ::setenv("MV_PSEE_PLUGIN_DATA_TRANSFER_BUFFER_POOL_BYTE_SIZE", "134217728", /*overwrite=*/0);
    return true;
  }();
  static_cast<void>(is_prepared);
}

std::string hal_encoding(const std::string& encoding) {
  if (encoding == "evt2") return "EVT2";
  return encoding == "evt2.1" ? "EVT21" : "EVT3";
}

/// Returns "EVT3" for "EVT3;height=720;width=1280".
std::string bare_format(const std::string& format) {
  return format.substr(0, format.find(';'));
}

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
  return one_line(text);
}

Result<std::vector<std::string>> list_metavision_cameras() try {
  prepare_hal();
  // A plugin that the HAL finds in two folders lists its cameras twice.
  auto names = Metavision::DeviceDiscovery::list();
  names.sort();
  names.unique();
  return std::vector<std::string>(names.begin(), names.end());
} catch (const std::exception& error) {
  return Error{ErrorCode::kIo, cat("the HAL cannot list cameras (", hal_text(error), "); check its plugins"), ""};
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
    reason = cat(" (the HAL says: ", hal_text(error), ")");
  }
  if (device == nullptr) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<std::string> listed, list_metavision_cameras());
    Error error = unopened_error(address, listed, find_usb_cameras());
    error.message += reason;
    return error;
  }
  const auto* const identity = device->get_facility<Metavision::I_HW_Identification>();
  if (identity == nullptr) return Error{ErrorCode::kUnsupported, "the camera does not state its encoding", address};
  const std::string format = bare_format(identity->get_current_data_encoding_format());
  const bool is_read = format == "EVT2" || format == "EVT21" || format == "EVT2.1" || format == "EVT3";
  if (is_read && (encoding.empty() || format == hal_encoding(encoding))) return device;
  const std::vector<std::string> offered = identity->get_available_data_encoding_formats();
  return Error{ErrorCode::kUnsupported,
               cat("the camera sends ", one_line(format), is_read ? "" : ", which e2lf cannot read", "; it offers ",
                   one_line(join(offered)), ", of which e2lf reads the encodings evt2, evt2.1 and evt3"),
               "camera://metavision"};
}

}  // namespace e2lf::recordings
