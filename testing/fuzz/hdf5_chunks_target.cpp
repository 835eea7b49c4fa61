// SPDX-License-Identifier: MIT
// The target of the Metavision HDF5 reader behind the HDF5 library: the input says what is in the chunks of a file that
// is otherwise sound (see chunk_file.h).
#include "chunk_file.h"
#include "recording_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::vector<uint8_t> file = e2lf::fuzz::make_chunk_file({data, size});
  if (!file.empty()) e2lf::fuzz::check_recording("hdf5", file);
  return 0;
}
