// SPDX-License-Identifier: MIT
// The target of one recording format, E2LF_FUZZ_FORMAT: the input is a file.
#include "recording_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  e2lf::fuzz::check_recording(E2LF_FUZZ_FORMAT, {data, size});
  return 0;
}
