// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/camera_header.h"

#include <ctime>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {
namespace {

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::localtime_r(&now, &parts);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts)};
}

}  // namespace

std::string camera_header(std::map<std::string, std::string> keys) {
  keys.erase("end");
  keys.emplace("date", local_time());
  std::string text;
  for (const auto& [key, value] : keys) {
    if (!value.empty()) text += cat("% ", key, " ", header_text(value), "\n");
  }
  return text + "% end\n";
}

}  // namespace e2lf::recordings
