// SPDX-License-Identifier: MIT
// The behaviour of a simulated camera, as the environment variable E2LF_STAND_IN describes it; stand_in_hal.h lists the
// keys.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using Scenario = std::map<std::string, std::string>;

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

inline Scenario scenario() {
  Scenario found;
  const char* const text = std::getenv("E2LF_STAND_IN");
  for (const std::string& part : split(text == nullptr ? "" : text, ';')) {
    const size_t equals = std::min(part.find('='), part.size());
    found[part.substr(0, equals)] = equals < part.size() ? part.substr(equals + 1) : "1";
  }
  return found;
}

inline uint64_t number(const Scenario& scenario, const std::string& key, uint64_t otherwise) {
  const auto found = scenario.find(key);
  return found == scenario.end() ? otherwise : std::stoull(found->second);
}

/// Returns the words of a RAW recording, without its header.
inline std::vector<uint8_t> words_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  std::vector<uint8_t> bytes(error ? 0 : size);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const std::string end = "% end\n";
  const auto header = std::search(bytes.begin(), bytes.end(), end.begin(), end.end());
  if (header != bytes.end()) bytes.erase(bytes.begin(), header + static_cast<long>(end.size()));
  return bytes;
}

/// Returns the words of EVT3 without the triggers of inputs whose bit is not set.
inline std::vector<uint8_t> with_triggers(std::vector<uint8_t> words, unsigned inputs) {
  size_t kept = 0;
  for (size_t i = 0; i + 1 < words.size(); i += 2) {
    const bool is_trigger = words[i + 1] >> 4 == 0xA;
    if (is_trigger && (inputs >> (words[i + 1] & 0xF) & 1) == 0) continue;
    words[kept++] = words[i];
    words[kept++] = words[i + 1];
  }
  words.resize(kept);
  return words;
}
