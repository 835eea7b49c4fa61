// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/measurement_io.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"

namespace e2lf::capture {
namespace fs = std::filesystem;
namespace {

constexpr const char* kImages = "images";
constexpr const char* kLensArray = "lens_array";

/// Returns the images of each cycle from an array [cycles, image, y, x].
Result<std::vector<CodedIntensities>> images_from_array(const NpyArray& array, const std::string& location) {
  const std::vector<size_t>& shape = array.shape;
  if (shape.size() != 4 || array.num_elements() == 0) {
    return Error{ErrorCode::kShape,
                 cat("intensity images have shape ", shape_text(shape), "; expected [cycles, image, y, x]"), location};
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, array.to_float(location));
  if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) {
    return Error{ErrorCode::kInvalidValue, "an intensity is not finite; correct the images", location};
  }
  std::vector<CodedIntensities> cycles(shape[0], CodedIntensities(shape[1], shape[2], shape[3]));
  for (size_t i = 0; i < cycles.size(); ++i) {
    const size_t size = cycles[i].values.size();
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * size), size, cycles[i].values.begin());
  }
  return cycles;
}

Result<void> check_hybrid(const EventImages& events, const CodedIntensities& images, const std::string& location) {
  if (images.count == 1 && images.height == events.height && images.width == events.width) return {};
  return Error{
      ErrorCode::kShape,
      cat("the intensity images of a cycle have shape ", shape_text({images.count, images.height, images.width}),
          ", the event images ", shape_text({events.count, events.height, events.width}),
          "; beside events there is one image of their size"),
      location};
}

Result<MeasurementFile> measurement_of_arrays(NpzArrays arrays, const fs::path& path) {
  const bool is_lens_array = arrays.contains(kLensArray);
  const char* name = is_lens_array ? kLensArray : kImages;
  const std::string location = cat(path.string(), ": ", name);
  NpyArray& array = arrays.at(name);
  if (is_lens_array && array.shape.size() == 3) array.shape.insert(array.shape.begin() + 1, 1);
  E2LF_ASSIGN_OR_RETURN(std::vector<CodedIntensities> images, images_from_array(array, location));
  MeasurementFile file;
  file.cycles.resize(images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    file.cycles[i].kind = is_lens_array ? MeasurementKind::kLensArray : MeasurementKind::kCodedImages;
    file.cycles[i].images = std::move(images[i]);
  }
  if (arrays.contains("events")) {
    E2LF_ASSIGN_OR_RETURN(EventImageFile events, read_event_images(path));
    if (events.cycles.size() != file.cycles.size()) {
      return Error{ErrorCode::kShape,
                   cat(file.cycles.size(), " cycles of images with ", events.cycles.size(),
                       " of events; give both for each cycle"),
                   location};
    }
    for (size_t i = 0; i < file.cycles.size(); ++i) {
      E2LF_RETURN_IF_ERROR(check_hybrid(events.cycles[i], file.cycles[i].images, location));
      file.cycles[i].kind = MeasurementKind::kHybrid;
      file.cycles[i].events = std::move(events.cycles[i]);
    }
  }
  E2LF_ASSIGN_OR_RETURN(file.setup, setup_from_arrays(arrays, path.string()));
  return file;
}

}  // namespace

bool holds_images(const NpzArrays& arrays) {
  return arrays.contains(kImages) || arrays.contains(kLensArray);
}

Result<MeasurementFile> read_measurements(const fs::path& path) {
  if (path.extension() == ".npz") {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays names, peek_npz(path));
    if (holds_images(names)) {
      E2LF_ASSIGN_OR_RETURN(NpzArrays arrays, read_npz(path));
      return measurement_of_arrays(std::move(arrays), path);
    }
  }
  E2LF_ASSIGN_OR_RETURN(EventImageFile events, read_event_images(path));
  MeasurementFile file{{}, std::move(events.setup)};
  for (EventImages& cycle : events.cycles) file.cycles.emplace_back(std::move(cycle));
  return file;
}

Result<void> write_measurements(const fs::path& path, const MeasurementFile& file) {
  E2LF_REQUIRE(!file.cycles.empty(), "writing measurements needs at least one cycle");
  const Measurement& first = file.cycles.front();
  std::vector<int16_t> counts;
  std::vector<float> values;
  for (const Measurement& cycle : file.cycles) {
    E2LF_REQUIRE(cycle.kind == first.kind && cycle.events.values.size() == first.events.values.size() &&
                     cycle.images.values.size() == first.images.values.size(),
                 "all cycles of a file must have one kind and shape");
    counts.insert(counts.end(), cycle.events.values.begin(), cycle.events.values.end());
    values.insert(values.end(), cycle.images.values.begin(), cycle.images.values.end());
  }
  NpzArrays arrays;
  const size_t cycles = file.cycles.size();
  if (has_events(first.kind)) {
    const EventImages& events = first.events;
    arrays["events"] = make_npy(std::vector<size_t>{cycles, events.count, events.height, events.width},
                                std::span<const int16_t>(counts));
  }
  const CodedIntensities& images = first.images;
  if (first.kind == MeasurementKind::kLensArray) {
    arrays[kLensArray] =
        make_npy(std::vector<size_t>{cycles, images.height, images.width}, std::span<const float>(values));
  } else if (first.kind != MeasurementKind::kEventImages) {
    arrays[kImages] = make_npy(std::vector<size_t>{cycles, images.count, images.height, images.width},
                               std::span<const float>(values));
  }
  setup_to_arrays(file.setup, arrays);
  return write_npz(path, arrays);
}

}  // namespace e2lf::capture
