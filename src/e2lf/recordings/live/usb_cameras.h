// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// Whether a program may use a USB device.
enum class UsbAccess {
  kFree,
  kInUse,      ///< another process has its device node open
  kForbidden,  ///< the permissions of its device node do not allow it
  kHidden,     ///< there is no device node, as in a container that was not given it
};

/// A camera on the USB that may have an event sensor.
struct UsbCamera {
  std::string name;            ///< vendor, product and what it calls itself: "04b4:00f4 EVK"
  std::filesystem::path node;  ///< "/dev/bus/usb/002/003"
  UsbAccess access = UsbAccess::kFree;
  std::string user;  ///< "NAME (process 123)" where it is in use and that can be seen
};

/// Where Linux tells of USB devices and processes.
struct UsbFolders {
  std::filesystem::path devices = "/sys/bus/usb/devices", nodes = "/dev/bus/usb", processes = "/proc";
};

/// Returns the devices that have the vendor number of a maker of event cameras or of the USB chip of one.
[[nodiscard]] std::vector<UsbCamera> find_usb_cameras(const UsbFolders& folders = {});

/// Says why no camera could be opened, which the HAL does not tell: there is none (kNotFound), another program has it,
/// or the permissions forbid it (kIo). `address` is what was asked for, empty = any; `listed` is what the HAL lists.
[[nodiscard]] Error unopened_error(const std::string& address, const std::vector<std::string>& listed,
                                   const std::vector<UsbCamera>& usb);

}  // namespace e2lf::recordings
