// SPDX-License-Identifier: MIT
// The target of files of aperture patterns: the first byte chooses the format, the rest is the file.
#include "e2lf/aperture/codes_io.h"
#include "require.h"
#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf;
  using fuzz::require;
  constexpr const char* kNames[] = {"input.json", "input.npy", "input.npz"};
  static const fuzz::ScratchFolder folder;
  std::span<const uint8_t> input(data, size);
  const char* name = kNames[fuzz::take_choice(input, std::size(kNames))];
  const auto codes = aperture::read_codes(folder.put(name, input));
  if (!codes) return 0;
  require(validate(*codes, "input").ok(), "patterns that were read are valid");
  (void)aperture::codes_text(*codes);
  const auto back = aperture::codes_from_json(aperture::codes_to_json(*codes), "encoded");
  require(back.ok() && *back == *codes, "patterns come back as encoded");
  return 0;
}
