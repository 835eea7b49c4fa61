// SPDX-License-Identifier: MIT
// The target of the pictures and MATLAB files that light fields are read from: the input is a file.
#include "e2lf/files/mat5.h"
#include "e2lf/lightfield/formats/readers.h"
#include "require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf::lightfield;
  using e2lf::find_mat_array;
  using e2lf::fuzz::require;
  const std::span<const uint8_t> bytes(data, size);
  if (const auto image = decode_raw_image(bytes, "input")) {
    require(image->samples.size() == image->height * image->row_bytes(), "an image has all its samples");
  }
  std::vector<std::string> others;
  if (const auto array = find_mat_array(bytes, "LF", uint64_t{1} << 24, "input", others)) {
    require(array->data.size() <= (size_t{1} << 24), "a variable is no larger than was allowed");
  }
  return 0;
}
