// SPDX-License-Identifier: MIT
// The target of aperture patterns: the first byte chooses the format of a file or a recording's header with "key value"
// lines, the rest is that.
#include <sstream>

#include "e2lf/capture/patterns/codes.h"
#include "require.h"
#include "scratch.h"

namespace {

e2lf::capture::HeaderLines header_lines(std::span<const uint8_t> input) {
  e2lf::capture::HeaderLines lines;
  std::istringstream text(std::string(input.begin(), input.end()));
  std::string key, value;
  while (text >> key && std::getline(text >> std::ws, value)) lines.emplace_back(key, value);
  return lines;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf;
  using fuzz::require;
  constexpr const char* kNames[] = {"input.json", "input.npy", "input.npz"};
  static const fuzz::ScratchFolder folder;
  std::span<const uint8_t> input(data, size);
  const size_t choice = fuzz::take_choice(input, std::size(kNames) + 1);
  if (choice == std::size(kNames)) {
    const auto noted = capture::codes_from_header(header_lines(input), "input");
    if (noted && *noted) require(validate(**noted, "input").ok(), "patterns of a header are valid");
    return 0;
  }
  const auto codes = capture::read_codes(folder.put(kNames[choice], input));
  if (!codes) return 0;
  require(validate(*codes, "input").ok(), "patterns that were read are valid");
  (void)capture::codes_text(*codes);
  const auto back = capture::codes_from_json(capture::codes_to_json(*codes), "encoded");
  require(back.ok() && *back == *codes, "patterns come back as encoded");
  const auto noted = capture::codes_from_header(capture::codes_to_header(*codes), "header");
  require(noted.ok() && *noted == *codes, "so do the patterns in a recording's header");
  return 0;
}
