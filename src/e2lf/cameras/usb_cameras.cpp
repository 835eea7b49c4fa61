// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::cameras {
namespace fs = std::filesystem;
namespace {

/// Vendor numbers, and the prefixes of the product numbers that may be event cameras.
struct UsbVendor {
  std::string_view vendor, product;
};
constexpr std::array<UsbVendor, 4> kUsbVendors = {{{"31f7", ""}, {"04b4", "00f"}, {"03fd", "5832"}, {"1fc9", "5838"}}};

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return one_line(line);
}

/// Returns a number as in the names of device nodes: "2" becomes "002".
std::string three_digits(const std::string& number) {
  return std::string(3 - std::min<size_t>(3, number.size()), '0') + number;
}

bool is_requested(const std::string& name, const std::string& address) {
  return address.empty() || name == address || name.ends_with(":" + address);
}

}  // namespace

std::vector<UsbCamera> find_usb_cameras(const UsbFolders& folders) {
  std::vector<UsbCamera> cameras;
  std::error_code error;
  for (fs::directory_iterator device(folders.devices, error), end; !error && device != end; device.increment(error)) {
    const std::string vendor = first_line(device->path() / "idVendor");
    const std::string product = first_line(device->path() / "idProduct");
    const bool is_known = std::any_of(kUsbVendors.begin(), kUsbVendors.end(), [&](const UsbVendor& known) {
      return vendor == known.vendor && product.starts_with(known.product);
    });
    if (!is_known) continue;
    UsbCamera camera;
    camera.name = cat(vendor, ":", product, " ", first_line(device->path() / "product"));
    camera.node = folders.nodes / three_digits(first_line(device->path() / "busnum")) /
                  three_digits(first_line(device->path() / "devnum"));
    std::error_code ignored;
    if (!fs::exists(camera.node, ignored)) {
      camera.access = UsbAccess::kHidden;
    } else if (::access(camera.node.c_str(), R_OK | W_OK) != 0) {
      camera.access = UsbAccess::kForbidden;
    }
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

Error unopened_error(const std::string& address, const std::vector<std::string>& listed,
                     const std::vector<UsbCamera>& usb) {
  const std::string location = "camera://metavision" + (address.empty() ? "" : "/" + address);
  const auto with_access = [&usb](UsbAccess access) {
    const auto found = std::find_if(usb.begin(), usb.end(), [access](const auto& one) { return one.access == access; });
    return found == usb.end() ? nullptr : &*found;
  };
  const bool is_listed =
      std::any_of(listed.begin(), listed.end(), [&](const std::string& name) { return is_requested(name, address); });
  if (!listed.empty() && !is_listed) {
    return {ErrorCode::kNotFound, cat("there is no camera ", address, "; those connected are ", join(listed)),
            location};
  }
  if (const UsbCamera* const one = with_access(UsbAccess::kForbidden)) {
    return {ErrorCode::kIo,
            cat("the permissions of ", one->node.string(), " (", one->name,
                ") forbid opening the camera; install the vendor's udev rules and plug it in again"),
            location};
  }
  if (is_listed)
    return {ErrorCode::kIo, "the camera is busy: another program uses it; end that program first", location};
  if (const UsbCamera* const one = with_access(UsbAccess::kHidden)) {
    return {ErrorCode::kIo,
            cat("the camera ", one->name, " is connected, but ", one->node.string(),
                " is missing; give the container access to /dev/bus/usb"),
            location};
  }
  if (!usb.empty()) {
    return {ErrorCode::kNotFound,
            cat("the USB has ", usb.front().name,
                ", but no plugin of the HAL recognises it as a camera; set MV_HAL_PLUGIN_PATH to the folder of the "
                "plugins"),
            location};
  }
  return {
      ErrorCode::kNotFound,
      "no camera is connected; check its cable and power, and that MV_HAL_PLUGIN_PATH names the folder of the HAL's "
      "plugins",
      location};
}

}  // namespace e2lf::cameras
