// SPDX-License-Identifier: MIT
#include "reader_seeds.h"

#include <zlib.h>

#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/model/model.h"
#include "testing/test_jpeg.h"
#include "testing/test_light_field.h"

namespace e2lf::fuzz {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<uint8_t>;

void put32(Bytes& bytes, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

/// A data element of a MATLAB file, padded to eight bytes.
void put_element(Bytes& bytes, uint32_t type, const Bytes& data) {
  put32(bytes, type);
  put32(bytes, static_cast<uint32_t>(data.size()));
  bytes.insert(bytes.end(), data.begin(), data.end());
  bytes.resize((bytes.size() + 7) / 8 * 8);
}

/// A MATLAB file with `LF`, uint8 8x8 views of 2x3 pixels and three colours.
Bytes mat_file(bool is_compressed) {
  Bytes flags, extents, samples(size_t{64} * 2 * 3 * 3), matrix, variable;
  put32(flags, 9);
  put32(flags, 0);
  for (const uint32_t extent : {8, 8, 2, 3, 3}) put32(extents, extent);
  for (size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<uint8_t>(i * 7);
  put_element(matrix, 6, flags);
  put_element(matrix, 5, extents);
  put_element(matrix, 1, {'L', 'F'});
  put_element(matrix, 2, samples);
  put_element(variable, 14, matrix);
  const std::string text = "MATLAB 5.0 MAT-file";
  Bytes file(text.begin(), text.end());
  file.resize(124, ' ');
  file.insert(file.end(), {0, 1, 'I', 'M'});
  if (!is_compressed) {
    file.insert(file.end(), variable.begin(), variable.end());
    return file;
  }
  uLongf size = compressBound(variable.size());
  Bytes packed(size);
  compress(packed.data(), &size, variable.data(), variable.size());
  put32(file, 15);
  put32(file, static_cast<uint32_t>(size));
  file.insert(file.end(), packed.begin(), packed.begin() + static_cast<ptrdiff_t>(size));
  return file;
}

Result<void> write_light_fields(const fs::path& folder) {
  using namespace lightfield;
  const LightField grey = numbered_light_field({8, 8, 2, 3});
  const LightField colour = numbered_light_field({8, 8, 2, 2, 3});
  E2LF_RETURN_IF_ERROR(write_file(folder / "mat" / "plain", mat_file(false)));
  E2LF_RETURN_IF_ERROR(write_file(folder / "mat" / "compressed", mat_file(true)));
  const WriteOptions hdf5{.format = LightFieldFormat::kHdf5}, npy{.format = LightFieldFormat::kNpy};
  E2LF_RETURN_IF_ERROR(write_light_field(folder / "light_field_hdf5" / "grey", grey, hdf5));
  E2LF_RETURN_IF_ERROR(write_png(folder / "light_field_png" / "grey.png", mosaic_of(grey), PngDepth::k16));
  E2LF_RETURN_IF_ERROR(write_png(folder / "light_field_png" / "colour.png", mosaic_of(colour), PngDepth::k16));
  E2LF_RETURN_IF_ERROR(write_light_field(folder / "light_field_npy" / "grey.npy", grey, npy));
  E2LF_RETURN_IF_ERROR(write_light_field(folder / "light_field_npy" / "colour.npy", colour, npy));
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(folder / "light_field_npy" / "grey.npy"));
  return write_file(folder / "light_field_npy" / "npz", encode_npz({{"light_field", array}}));
}

void put_view(Bytes& input, uint8_t name, const Bytes& file) {
  input.insert(input.end(), {name, static_cast<uint8_t>(file.size()), static_cast<uint8_t>(file.size() >> 8)});
  input.insert(input.end(), file.begin(), file.end());
}

Result<void> write_view_folders(const fs::path& folder) {
  using namespace lightfield;
  Image image(3, 2, 1);
  image.pixels[1] = 0.5F;
  E2LF_ASSIGN_OR_RETURN(const Bytes png, encode_png(image, PngDepth::k8));
  E2LF_ASSIGN_OR_RETURN(const Bytes deep, encode_png(image, PngDepth::k16));
  const Bytes jpeg = make_jpeg(Bytes(18, 99), 3, 2, 3, JCS_RGB);
  const uint8_t grids[][4] = {{0, 1, 2, 3}, {5, 6, 7, 9}, {10, 11, 13, 14}, {0, 1, 2, 12}};
  for (size_t i = 0; i < std::size(grids); ++i) {
    Bytes input;
    for (const uint8_t name : grids[i])
      put_view(input, name, name == grids[i][3] ? deep : name % 2 == 0 ? png : Bytes());
    E2LF_RETURN_IF_ERROR(write_file(folder / "view_folder" / std::to_string(i), input));
  }
  Bytes input;
  for (const uint8_t name : {2, 3, 0, 1}) put_view(input, name, name == 2 ? jpeg : Bytes());
  return write_file(folder / "view_folder" / "jpeg", input);
}

/// Two layers for the default codes.
model::Model small_model() {
  model::Model model;
  model.name = "small";
  model.num_patterns = 4;
  model.codes = capture::default_codes();
  model.input = {{model::InputKind::kCounts, 0.125F}};
  model.network.input_channels = 3;
  model::Layer first, second;
  first.name = "a";
  first.inputs = {"input"};
  first.out_channels = 2;
  first.kernel = 3;
  second.name = "b";
  second.inputs = {"a"};
  second.out_channels = 64;
  model.network.layers = {first, second};
  for (const model::WeightShape& tensor : weight_shapes(model.network)) {
    size_t size = 1;
    for (const size_t extent : tensor.shape) size *= extent;
    model.weights[tensor.name] = std::vector<float>(size, 0.25F);
  }
  return model;
}

/// A file behind the byte that chooses its format.
Result<void> write_choice(const fs::path& path, uint8_t choice, Bytes file) {
  file.insert(file.begin(), choice);
  return write_file(path, file);
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

Result<void> write_patterns(const fs::path& folder) {
  const capture::Codes codes = capture::default_codes();
  const NpyArray array = make_npy<float>({4, 8, 8}, codes.values);
  const fs::path out = folder / "codes";
  E2LF_RETURN_IF_ERROR(write_choice(out / "binary", 0, bytes_of(capture::codes_to_json(codes).dump())));
  const std::string numbers = R"({"patterns": [[[0, 0.5], [1, 0.25]], [[1, 0], [0, 1]]]})";
  E2LF_RETURN_IF_ERROR(write_choice(out / "numbers", 0, bytes_of(numbers)));
  E2LF_RETURN_IF_ERROR(write_choice(out / "npy", 1, encode_npy(array)));
  E2LF_RETURN_IF_ERROR(write_choice(out / "npz", 2, encode_npz({{"codes", array}})));
  std::string header;
  for (const auto& [key, value] : capture::codes_to_header(codes)) header += key + " " + value + "\n";
  E2LF_RETURN_IF_ERROR(write_choice(out / "header", 3, bytes_of(header)));
  capture::SensorProfile camera;
  E2LF_RETURN_IF_ERROR(write_file(folder / "camera" / "paper", to_json(camera).dump()));
  camera.event_model = "pixel";
  camera.pixel.values.fill(0.5F);
  camera.transmission = {1.0F, 0.9F};
  E2LF_RETURN_IF_ERROR(write_file(folder / "camera" / "pixel", to_json(camera).dump()));
  E2LF_RETURN_IF_ERROR(write_file(folder / "schedule" / "paper", schedule_text(cycles::paper_schedule())));
  return write_file(folder / "schedule" / "plain", schedule_text(cycles::plain_schedule(4, 5000)));
}

Result<void> write_event_images(const fs::path& folder) {
  const std::vector<int16_t> counts(size_t{2} * 3 * 4 * 5, -3);
  const NpyArray cycles = make_npy<int16_t>({2, 3, 4, 5}, counts);
  const NpyArray codes = make_npy<float>({4, 8, 8}, capture::default_codes().values);
  const NpyArray image = make_npy<float>({4, 5, 1}, std::vector<float>(20, 2.0F));
  const fs::path out = folder / "event_images";
  E2LF_RETURN_IF_ERROR(write_choice(out / "npz", 0, encode_npz({{"events", cycles}, {"codes", codes}})));
  E2LF_RETURN_IF_ERROR(write_choice(out / "npy", 1, encode_npy(cycles)));
  const NpyArray sums = make_npy<float>({2, 1, 4, 5}, std::vector<float>(40, 0.25F));
  E2LF_RETURN_IF_ERROR(
      write_choice(out / "hybrid", 0, encode_npz({{"events", cycles}, {"images", sums}, {"codes", codes}})));
  const NpyArray lenses = make_npy<float>({1, 8, 16}, std::vector<float>(128, 0.5F));
  E2LF_RETURN_IF_ERROR(write_choice(out / "lenses", 0, encode_npz({{"lens_array", lenses}})));
  return write_choice(out / "folder", 2, encode_npy(image));
}

Result<void> write_settings(const fs::path& folder) {
  const std::string run = R"({"verb": "simulate", "version": "0.1.0", "seed": 7, "options": {"tau": 0.3, "gain": null},
 "inputs": [{"path": "a.raw", "sha256": "00"}], "seconds": 1.5e0})";
  E2LF_RETURN_IF_ERROR(write_file(folder / "settings" / "number", "options.tau=0.25\n" + run));
  E2LF_RETURN_IF_ERROR(write_file(folder / "settings" / "word", "verb=eval\n" + run));
  return write_file(folder / "settings" / "object", "a.b={\"c\": [1]}\n{} // a comment\n");
}

}  // namespace

Result<void> write_reader_seeds(const fs::path& folder) {
  E2LF_RETURN_IF_ERROR(write_light_fields(folder));
  E2LF_RETURN_IF_ERROR(write_view_folders(folder));
  E2LF_RETURN_IF_ERROR(model::write_model(folder / "model" / "small", small_model()));
  E2LF_RETURN_IF_ERROR(write_patterns(folder));
  E2LF_RETURN_IF_ERROR(write_event_images(folder));
  return write_settings(folder);
}

}  // namespace e2lf::fuzz
