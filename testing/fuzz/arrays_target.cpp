// SPDX-License-Identifier: MIT
// The target of .npy and .npz arrays of any kind (event images, light fields): the input is a file.
#include "e2lf/files/npy.h"
#include "require.h"

namespace {

bool equal(const e2lf::NpyArray& a, const e2lf::NpyArray& b) {
  return a.type == b.type && a.item_size == b.item_size && a.shape == b.shape && a.bytes == b.bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using e2lf::fuzz::require;
  if (const auto array = e2lf::decode_npy({data, size}, "input")) {
    require(array->bytes.size() == array->num_elements() * array->item_size, "the bytes are those of the shape");
    (void)array->to_float("input");
    const auto back = e2lf::decode_npy(e2lf::encode_npy(*array), "encoded");
    require(back.ok() && equal(*back, *array), "an array comes back as encoded");
  }
  if (const auto arrays = e2lf::decode_npz({data, size}, "input")) {
    const auto back = e2lf::decode_npz(e2lf::encode_npz(*arrays, size % 2 == 0), "encoded");
    require(back.ok() && back->size() == arrays->size(), "an archive comes back as encoded");
    for (const auto& [name, array] : *arrays) require(equal(back->at(name), array), "so does every array");
  }
  return 0;
}
