// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/replay_address.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>

#include "e2lf/base/text.h"

namespace e2lf::recordings {
namespace {

template <typename T>
std::optional<T> number_in(std::string_view text, T least, T most) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && value >= least && value <= most ? std::optional(value) : std::nullopt;
}

}  // namespace

size_t replay_path_size(const std::string& address) {
  std::error_code error;
  return std::filesystem::exists(address, error) ? address.size() : std::min(address.rfind('?'), address.size());
}

Result<ReplayAddress> parse_replay_address(const std::string& address) {
  constexpr double kLeastSpeed = 1e-3, kMostSpeed = 1000;
  constexpr uint64_t kMostRepeats = 1'000'000;
  ReplayAddress replay{address.substr(0, replay_path_size(address))};
  std::string_view rest = std::string_view(address).substr(std::min(replay.path.size() + 1, address.size()));
  while (!rest.empty()) {
    const std::string_view part = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const std::string_view key = part.substr(0, part.find('=')),
                           text = part.substr(std::min(key.size() + 1, part.size()));
    const auto speed = key == "speed" ? number_in(text, kLeastSpeed, kMostSpeed) : std::nullopt;
    const auto repeat = key == "repeat" ? number_in(text, uint64_t{1}, kMostRepeats) : std::nullopt;
    if (!speed && !repeat) {
      return Error{ErrorCode::kInvalidValue,
                   cat("\"", part, "\" says nothing about a replay; write speed=S (0.001 to 1000) or repeat=N (1 to ",
                       kMostRepeats, "), joined by &"),
                   address};
    }
    replay.speed = speed.value_or(replay.speed);
    replay.repeat = repeat.value_or(replay.repeat);
  }
  return replay;
}

}  // namespace e2lf::recordings
