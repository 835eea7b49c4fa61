// SPDX-License-Identifier: MIT
// The target of light fields in one file: the input is one. Which kind (MATLAB, HDF5, npy, npz, lenslet mosaic) is up
// to the seeds.

#include "e2lf/lightfield/light_field_io.h"
#include "require.h"
#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf::lightfield;
  using e2lf::fuzz::require;
  static const e2lf::fuzz::ScratchFolder folder;
  const auto path = folder.put("input", {data, size});
  ReadOptions options;
  options.colour = size % 2 == 0;
  options.lenslet_views = 8;
  options.max_bytes = uint64_t{1} << 24;
  const auto kind = detect_kind(path);
  const auto light_field = read_light_field(path, options);
  if (!light_field) {
    require(!light_field.error().message.empty(), "an error says what is wrong");
    return 0;
  }
  require(kind.ok(), "what can be read is of a known kind");
  const Shape& shape = light_field->shape();
  require(shape.views_y == 8 && shape.views_x == 8, "it has as many views as were asked for");
  require(light_field->data().size() == shape.size(), "the samples are those of the shape");
  for (const float value : light_field->data()) require(value >= 0.0F && value <= 1.0F, "samples lie in [0, 1]");
  return 0;
}
