// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "e2lf/cameras/cameras.h"
#include "e2lf/files/file.h"
#include "testing/test_streams.h"

namespace e2lf::cameras {
namespace fs = std::filesystem;
namespace {

/// A tree as Linux shows it, with one device in it.
class UsbTree {
 public:
  UsbTree(const std::string& vendor, const std::string& product) {
    const fs::path device = folders.devices / "2-1";
    for (const fs::path& made : {device, folders.nodes / "002"}) {
      fs::create_directories(made);
    }
    for (const auto& [name, text] : {std::pair<std::string, std::string>{"idVendor", vendor},
                                     {"idProduct", product},
                                     {"busnum", "2"},
                                     {"devnum", "13"},
                                     {"product", "EVK4"}}) {
      EXPECT_TRUE(write_file(device / name, text + "\n").ok());
    }
  }
  void add_node() const { EXPECT_TRUE(write_file(folders.nodes / "002" / "013", std::string("x")).ok()); }

  TestFolder folder;
  UsbFolders folders{folder / "devices", folder / "nodes"};
};

std::string reason(const UsbTree& usb, const std::string& address = "", const std::vector<std::string>& listed = {}) {
  return unopened_error(address, listed, find_usb_cameras(usb.folders)).text();
}

void expect_said(const std::string& text, const std::string& said) {
  EXPECT_NE(text.find(said), std::string::npos) << text;
}

TEST(UsbCameras, NoneBusyForbiddenAndHiddenAreToldApart) {
  const UsbTree mouse("046d", "c077");
  expect_said(reason(mouse), "no camera is connected");
  const UsbTree camera("04b4", "00f5");
  expect_said(reason(camera), "02/013 is missing; give the container");
  camera.add_node();
  expect_said(reason(camera), "no plugin of the HAL recognises it");
  expect_said(reason(mouse, "A1", {"e2lf:plugin:A1"}), "busy: another program uses it");
  expect_said(reason(mouse, "A1", {"e2lf:plugin:B2"}), "no camera A1; those connected are e2lf:plugin:B2");
  if (::geteuid() == 0) return;  // nothing is forbidden then
  fs::permissions(camera.folders.nodes / "002" / "013", fs::perms::none);
  expect_said(reason(camera), "udev rules");
}

TEST(UsbCameras, PermissionsComeFirstAndNameTheDevice) {
  const UsbCamera forbidden{"04b4:00f5 EVK4", "/dev/bus/usb/002/013", UsbAccess::kForbidden};
  const Error error = unopened_error("", {"e2lf:plugin:A1"}, {forbidden});
  EXPECT_EQ(error.code, ErrorCode::kIo);
  expect_said(error.text(), "/dev/bus/usb/002/013");
  expect_said(error.text(), "udev rules");
}

}  // namespace
}  // namespace e2lf::cameras
