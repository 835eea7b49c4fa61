// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// Whether this process can use a USB device.
enum class UsbAccess {
  kFree,
  kInUse,      ///< another process has its device node open
  kForbidden,  ///< the permissions of its device node do not allow it
  kHidden,     ///< there is no device node, for example in a container without access to it
};

/// A USB device that may be an event camera.
struct UsbCamera {
  std::string name;            ///< vendor, product and device name, e.g. "04b4:00f4 EVK"
  std::filesystem::path node;  ///< "/dev/bus/usb/002/003"
  UsbAccess access = UsbAccess::kFree;
  std::string user;  ///< "NAME (process 123)" of the process that uses it, if known
};

/// The folders in which Linux describes USB devices and processes.
struct UsbFolders {
  std::filesystem::path devices = "/sys/bus/usb/devices", nodes = "/dev/bus/usb", processes = "/proc";
};

/// Returns the devices whose vendor number is that of a manufacturer of event cameras or of their USB chips.
[[nodiscard]] std::vector<UsbCamera> find_usb_cameras(const UsbFolders& folders = {});

/// Returns the reason why no camera could be opened, which the HAL does not report: there is none (kNotFound), another
/// program uses it, or permissions are missing (kIo). `address` is the requested camera, empty = any; `listed` contains
/// the cameras that the HAL lists.
[[nodiscard]] Error unopened_error(const std::string& address, const std::vector<std::string>& listed,
                                   const std::vector<UsbCamera>& usb);

}  // namespace e2lf::recordings
