// SPDX-License-Identifier: MIT
// The target of folders of view images. The input lists files: u8 which name, u16 how many bytes, which follow; a file
// without bytes is a copy of the first.
#include "e2lf/base/little_endian.h"
#include "e2lf/lightfield/light_field_io.h"
#include "require.h"
#include "scratch.h"

namespace {

constexpr const char* kNames[] = {"00_00.png", "00_01.png",         "01_00.jpg",         "01_01.jpeg",
                                  "0_0.PNG",   "input_Cam000.png",  "input_Cam001.png",  "input_Cam009.png",
                                  "1_1.png",   "input_Cam010.png",  "out_00_00_1_2.png", "out_00_01.png",
                                  "notes.txt", "out_01_00_-3_.png", "out_01_01_x.jpg",   "9999_9999.png",
                                  "-1_0.png",  "-1_-1.png",         "view-1-0.png",      "view-1--1.png"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf::lightfield;
  using e2lf::fuzz::require;
  static const e2lf::fuzz::ScratchFolder folder;
  folder.clear();
  std::span<const uint8_t> input(data, size), first;
  while (input.size() >= 3) {
    const char* name = kNames[input[0] % std::size(kNames)];
    const size_t length = std::min<size_t>(e2lf::load_le<uint16_t>(&input[1]), input.size() - 3);
    const std::span<const uint8_t> bytes = input.subspan(3, length);
    input = input.subspan(3 + length);
    if (first.empty()) first = bytes;
    folder.put(name, bytes.empty() ? first : bytes);
  }
  ReadOptions options;
  options.views_y.count = options.views_x.count = size % 3 == 0 ? 0 : 2;
  options.colour = size % 2 == 0;
  options.max_bytes = uint64_t{1} << 24;
  const auto light_field = read_light_field(folder.path(), options);
  if (!light_field) return 0;
  const Shape& shape = light_field->shape();
  require(shape.views_y >= 1 && shape.views_x >= 1 && light_field->data().size() == shape.size(),
          "it has all its views");
  for (const float value : light_field->data()) require(value >= 0.0F && value <= 1.0F, "samples lie in [0, 1]");
  return 0;
}
