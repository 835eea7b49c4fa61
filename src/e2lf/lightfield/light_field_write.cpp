// SPDX-License-Identifier: MIT
// Writes light fields; declared in light_field_io.h.
#include <algorithm>
#include <mutex>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/view_names.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {
namespace fs = std::filesystem;
namespace {

struct FormatWord {
  const char* word;
  LightFieldFormat format;
};
constexpr FormatWord kFormatWords[] = {{"png", LightFieldFormat::kPng8}, {"png16", LightFieldFormat::kPng16},
                                       {"hci", LightFieldFormat::kHci},  {"stanford", LightFieldFormat::kStanford},
                                       {"npy", LightFieldFormat::kNpy},  {"lenslet", LightFieldFormat::kLenslet},
                                       {"mat", LightFieldFormat::kMat},  {"h5", LightFieldFormat::kHdf5}};

LightFieldKind kind_of_folder(LightFieldFormat format) {
  if (format == LightFieldFormat::kHci) return LightFieldKind::kHciFolder;
  return format == LightFieldFormat::kStanford ? LightFieldKind::kStanfordFolder : LightFieldKind::kViewFolder;
}

Image view_to_write(const LightField& light_field, size_t view_y, size_t view_x) {
  const Shape& shape = light_field.shape();
  Image image(shape.width, shape.height, shape.channels);
  const std::span<const float> view = light_field.view(view_y, view_x);
  std::copy(view.begin(), view.end(), image.pixels.begin());
  return image;
}

Result<void> write_folder(const fs::path& path, const LightField& light_field, const WriteOptions& options,
                          const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder, ResultFolder::create(path, options.overwrite));
  E2LF_RETURN_IF_ERROR(write_views(folder.path(), light_field, options.format, progress));
  return folder.commit();
}

Result<void> write_array(const fs::path& path, const LightField& light_field) {
  const Shape& shape = light_field.shape();
  std::vector<size_t> extents = {shape.views_y, shape.views_x, shape.height, shape.width};
  if (shape.channels == 3) extents.push_back(3);
  return write_npy(path, make_npy<float>(std::move(extents), light_field.data()));
}

Result<void> write_lenslet(const fs::path& path, const LightField& light_field) {
  const Shape& shape = light_field.shape();
  const AxisStrides strides = huwvc_strides(shape);
  Image mosaic(shape.width * shape.views_x, shape.height * shape.views_y, shape.channels);
  parallel_for(shape.height, 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      for (size_t view = 0; view < shape.num_views(); ++view) {
        const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
        const float* row = light_field.view(view_y, view_x).data() + y * shape.width * shape.channels;
        float* out = mosaic.pixels.data() + view_y * strides.view_y + view_x * strides.view_x + y * strides.y;
        for (size_t x = 0; x < shape.width; ++x) {
          std::copy_n(row + x * shape.channels, shape.channels, out + x * strides.x);
        }
      }
    }
  });
  return write_png(path, mosaic, PngDepth::k16, cat(shape.views_y, "x", shape.views_x));
}

Result<void> write_mat(const fs::path& path, const LightField& light_field) {
  const Shape& shape = light_field.shape();
  const AxisStrides strides = matlab_uvhwc_strides(shape);
  std::vector<float> samples(shape.size());
  parallel_for(shape.width, 8, [&](size_t begin, size_t end) {
    for (size_t x = begin; x < end; ++x) {
      for (size_t view = 0; view < shape.num_views(); ++view) {
        const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
        const float* pixel = light_field.view(view_y, view_x).data() + x * shape.channels;
        float* out = samples.data() + view_y * strides.view_y + view_x * strides.view_x + x * strides.x;
        for (size_t y = 0; y < shape.height; ++y, pixel += shape.width * shape.channels) {
          for (size_t c = 0; c < shape.channels; ++c) out[y * strides.y + c * strides.channel] = pixel[c];
        }
      }
    }
  });
  std::vector<size_t> extents = {shape.views_y, shape.views_x, shape.height, shape.width};
  if (shape.channels == 3) extents.push_back(3);
  const std::span<const uint8_t> data(reinterpret_cast<const uint8_t*>(samples.data()), samples.size() * sizeof(float));
  const MatVariable variable{"LF", MatClass::kSingle, std::move(extents), data};
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, encode_mat(std::span(&variable, 1), path.string()));
  return write_file(path, file);
}

/// Returns the bytes of an HDF5 file that is made in memory, or none if HDF5 fails.
std::vector<uint8_t> encode_hdf5(const std::string& name, const std::vector<size_t>& extents,
                                 std::span<const float> values) {
  constexpr size_t kGrowBytes = size_t{1} << 24;
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!access.valid() || H5Pset_fapl_core(access.get(), kGrowBytes, 0) < 0) return {};
  const hdf5::Handle file(H5Fcreate("memory.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  const std::vector<hsize_t> sizes(extents.begin(), extents.end());
  const hdf5::Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  if (!file.valid() || !space.valid()) return {};
  const hdf5::Handle set(
      H5Dcreate2(file.get(), name.c_str(), H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (!set.valid() || H5Dwrite(set.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0 ||
      H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0) {
    return {};
  }
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  std::vector<uint8_t> bytes(size > 0 ? static_cast<size_t>(size) : 0);
  if (bytes.empty() || H5Fget_file_image(file.get(), bytes.data(), bytes.size()) != size) return {};
  return bytes;
}

/// Writes one float32 data set with these extents as an HDF5 file that appears either whole or not at all. Fails with
/// kIo, and with kInternal if HDF5 fails.
Result<void> write_hdf5(const fs::path& path, const std::string& name, const std::vector<size_t>& extents,
                        std::span<const float> values) {
  const hdf5::LibraryLock lock;
  const std::vector<uint8_t> bytes = encode_hdf5(name, extents, values);
  if (bytes.empty()) {
    return Error{ErrorCode::kInternal,
                 cat("HDF5 could not encode ", name, " (", hdf5::last_reason(), "); write npy instead"), path.string()};
  }
  return write_file(path, bytes);
}

Result<void> write_luma(const fs::path& path, const LightField& light_field) {
  const Shape& shape = light_field.shape();
  const std::vector<size_t> extents = {shape.num_views(), shape.height, shape.width};
  if (shape.channels == 1) return write_hdf5(path, "LF_y", extents, light_field.data());
  std::vector<float> grey(shape.num_views() * shape.height * shape.width);
  for (size_t i = 0; i < grey.size(); ++i) {
    const float* pixel = light_field.data().data() + 3 * i;
    grey[i] = grey_of(pixel[0], pixel[1], pixel[2]);
  }
  return write_hdf5(path, "LF_y", extents, grey);
}

}  // namespace

Result<LightFieldFormat> parse_format(const std::string& word) {
  std::vector<std::string> words;
  for (const FormatWord& known : kFormatWords) {
    if (word == known.word) return known.format;
    words.emplace_back(known.word);
  }
  return Error{ErrorCode::kInvalidValue,
               cat("no light-field format is called \"", word, "\"; use one of ", join(words)), ""};
}

bool is_folder_format(LightFieldFormat format) {
  return format == LightFieldFormat::kPng8 || format == LightFieldFormat::kPng16 || format == LightFieldFormat::kHci ||
         format == LightFieldFormat::kStanford;
}

LightFieldFormat format_of_path(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npy") return LightFieldFormat::kNpy;
  if (extension == ".mat") return LightFieldFormat::kMat;
  if (extension == ".h5" || extension == ".hdf5") return LightFieldFormat::kHdf5;
  if (extension == ".png") return LightFieldFormat::kLenslet;
  return LightFieldFormat::kPng8;
}

Result<void> write_views(const fs::path& folder, const LightField& light_field, LightFieldFormat format,
                         const ProgressFn& progress) {
  E2LF_REQUIRE(is_folder_format(format), "views are written in a folder format");
  const Shape& shape = light_field.shape();
  if (format == LightFieldFormat::kHci && shape.views_x > kHciColumns) {
    return Error{ErrorCode::kShape, cat("HCI names number at most 9 view columns, not ", shape.views_x, "; write png"),
                 folder.string()};
  }
  const LightFieldKind kind = kind_of_folder(format);
  const PngDepth depth = format == LightFieldFormat::kPng16 ? PngDepth::k16 : PngDepth::k8;
  std::mutex mutex;
  std::optional<Error> error;
  size_t done = 0;
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
      const Result<void> status = write_png(folder / written_view_name(kind, view_y, view_x),
                                            view_to_write(light_field, view_y, view_x), depth);
      const std::lock_guard lock(mutex);
      if (!status.ok() && !error) error = status.error();
      ++done;
      if (progress) progress(done, shape.num_views());
    }
  });
  if (error) return *error;
  return {};
}

Result<void> write_light_field(const fs::path& path, const LightField& light_field, const WriteOptions& options,
                               const ProgressFn& progress) {
  E2LF_REQUIRE(light_field.shape().size() > 0, "a light field to write has samples");
  if (is_folder_format(options.format)) return write_folder(path, light_field, options, progress);
  E2LF_RETURN_IF_ERROR(check_output(path, options.overwrite));
  if (options.format == LightFieldFormat::kNpy) return write_array(path, light_field);
  if (options.format == LightFieldFormat::kLenslet) return write_lenslet(path, light_field);
  if (options.format == LightFieldFormat::kMat) return write_mat(path, light_field);
  return write_luma(path, light_field);
}

}  // namespace e2lf::lightfield
