// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/event_image_io.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::capture {
namespace {

namespace fs = std::filesystem;

/// Returns the position of an element as its indices, "[0, 2, 14, 7]".
std::string place_of(size_t element, const std::vector<size_t>& shape) {
  std::vector<size_t> place(shape.size());
  for (size_t axis = shape.size(); axis-- > 0; element /= shape[axis]) place[axis] = element % shape[axis];
  return shape_text(place);
}

/// Converts `array` to int16; any value that is not an integer within int16 is an error, which names the first one.
Result<std::vector<int16_t>> to_counts(const NpyArray& array, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, array.to_float(location));
  // In unsigned numbers of 8 to 64 bits, -1 is the largest value, so values beyond half of it were negative.
  const bool is_unsigned = array.type.starts_with('u');
  const float half = std::ldexp(0.5F, static_cast<int>(8 * array.item_size));
  const float end = is_unsigned ? std::min(half, 32768.0F) : 32768.0F;
  const auto is_count = [end](float value) { return value == std::trunc(value) && value >= -32768.0F && value < end; };
  const auto other = std::ranges::find_if_not(values, is_count);
  if (other != values.end()) {
    const std::string count =
        cat("the count ", *other, " at ", place_of(static_cast<size_t>(other - values.begin()), array.shape));
    if (is_unsigned && *other >= half) {
      return fail(ErrorCode::kInvalidValue, location, count, " has an unsigned type (", array.type,
                  "), in which -1 became ", 2 * half - 1, "; store the counts as int16");
    }
    return fail(ErrorCode::kInvalidValue, location, count,
                " is not a whole number of int16; event images contain sums of signed events, so undo a scaling and "
                "replace NaN");
  }
  std::vector<int16_t> counts(values.size());
  std::ranges::transform(values, counts.begin(), [](float v) { return static_cast<int16_t>(v); });
  return counts;
}

/// Splits values [cycles, plane, y, x], or those of one cycle, into cycles.
template <typename T>
std::vector<Planes<T>> split_cycles(const std::vector<T>& values, const std::vector<size_t>& shape) {
  const size_t axis = shape.size() - 3;
  std::vector<Planes<T>> cycles(axis == 0 ? 1 : shape[0], Planes<T>(shape[axis], shape[axis + 1], shape[axis + 2]));
  for (size_t i = 0; i < cycles.size(); ++i) {
    const size_t size = cycles[i].values.size();
    std::copy_n(values.begin() + static_cast<ptrdiff_t>(i * size), size, cycles[i].values.begin());
  }
  return cycles;
}

/// Returns the cycles of an array [cycles, N-1, y, x] or [N-1, y, x].
Result<std::vector<EventImages>> cycles_from_array(const NpyArray& array, const std::string& location) {
  const std::vector<size_t>& shape = array.shape;
  if ((shape.size() != 3 && shape.size() != 4) || array.num_elements() == 0) {
    return fail(ErrorCode::kShape, location, "an array of shape ", shape_text(shape),
                " is neither event images, [N-1, y, x] or [cycles, N-1, "
                "y, x], nor a list of events, [events, 4] with the columns t, x, y, p; store one of these forms");
  }
  // No display shows more patterns than a camera has columns.
  constexpr size_t kMostTransitions = 16;
  if (shape[shape.size() - 3] > kMostTransitions && shape.back() <= kMostTransitions) {
    return fail(ErrorCode::kShape, location, "event images of shape ", shape_text(shape),
                " have their axes in another order; store [N-1, y, x] ",
                "or [cycles, N-1, y, x], as numpy.moveaxis(events, -1, -3) does");
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<int16_t> counts, to_counts(array, location));
  return split_cycles(counts, shape);
}

Result<void> check_codes(const Codes& codes, size_t transitions, const std::string& location) {
  if (codes.num_patterns == transitions + 1) return {};
  return fail(ErrorCode::kShape, location, "there are ", codes.num_patterns, " codes, but ", transitions,
              " event images need ", transitions + 1, "; give the codes that the events were recorded with");
}

Result<EventImageFile> from_arrays(const NpzArrays& arrays, const fs::path& path) {
  const auto found = arrays.find("events");
  if (found == arrays.end()) {
    return fail(ErrorCode::kNotFound, path,
                "the file contains no array \"events\"; add it and, if they are known, codes");
  }
  EventImageFile file;
  E2LF_ASSIGN_OR_RETURN(file.cycles, cycles_from_array(found->second, path.string() + ": events"));
  E2LF_ASSIGN_OR_RETURN(file.setup, setup_from_arrays(arrays, path.string()));
  if (file.setup.codes) {
    E2LF_RETURN_IF_ERROR(check_codes(*file.setup.codes, file.cycles.front().count, path.string() + ": codes"));
  }
  return file;
}

constexpr std::string_view kImagePrefix = "event_image_";

/// Lists the event images of a folder in order; their numbers must run from 0 without gaps.
Result<std::vector<fs::path>> list_images(const fs::path& folder) {
  std::vector<std::pair<size_t, fs::path>> found;
  std::error_code status;
  for (fs::directory_iterator entry(folder, status), end; !status && entry != end; entry.increment(status)) {
    const fs::path& path = entry->path();
    const std::string stem = path.stem().string();
    if (path.extension() != ".npy" || !stem.starts_with(kImagePrefix)) continue;
    const auto number = parse_number<size_t>(stem.substr(kImagePrefix.size()));
    if (!number) {
      return fail(ErrorCode::kFormat, path, "the name does not end in the number of an event image from 0; rename it");
    }
    found.emplace_back(*number, path);
  }
  if (status) return fail(ErrorCode::kIo, folder, "cannot list the folder: ", status.message());
  if (found.empty()) {
    return fail(
        ErrorCode::kNotFound, folder,
        "no event_image_*.npy in the folder; give a folder of event images (`e2lf simulate` generates them from a "
        "light field)");
  }
  std::ranges::sort(found);
  std::vector<fs::path> paths;
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i].first != i) {
      return fail(ErrorCode::kNotFound, folder, "event image ", i,
                  " is missing; the numbers must run from 0 without gaps");
    }
    paths.push_back(std::move(found[i].second));
  }
  return paths;
}

Result<EventImageFile> read_folder(const fs::path& folder) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<fs::path> paths, list_images(folder));
  EventImages cycle;
  cycle.count = paths.size();
  for (const fs::path& path : paths) {
    E2LF_ASSIGN_OR_RETURN(NpyArray array, read_npy(path));
    std::vector<size_t>& shape = array.shape;
    if (shape.size() == 3 && shape[2] == 1) shape.pop_back();
    if (shape.size() != 2 || array.num_elements() == 0) {
      return fail(ErrorCode::kShape, path, "an event image has shape ", shape_text(shape), "; expected [y, x]");
    }
    if (cycle.values.empty()) {
      cycle.height = shape[0];
      cycle.width = shape[1];
    } else if (shape[0] != cycle.height || shape[1] != cycle.width) {
      return fail(ErrorCode::kShape, path, "this event image has shape ", shape_text(shape), ", the first one ",
                  shape_text({cycle.height, cycle.width}), "; all must have one size");
    }
    E2LF_ASSIGN_OR_RETURN(const std::vector<int16_t> counts, to_counts(array, path.string()));
    cycle.values.insert(cycle.values.end(), counts.begin(), counts.end());
  }
  return EventImageFile{{std::move(cycle)}};
}

}  // namespace

Result<EventImageFile> read_event_images(const fs::path& path) {
  if (!is_present(path)) {
    return fail(ErrorCode::kNotFound, path, "there is no such file or folder; check the path");
  }
  if (is_folder(path)) return read_folder(path);
  const std::string extension = path.extension().string();
  if (extension == ".npz") {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, read_npz(path));
    return from_arrays(arrays, path);
  }
  if (extension == ".npy") {
    E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
    E2LF_ASSIGN_OR_RETURN(std::vector<EventImages> cycles, cycles_from_array(array, path.string()));
    return EventImageFile{std::move(cycles)};
  }
  return fail(ErrorCode::kUnsupported, path,
              "this is not a file of event images; use .npz, .npy or a folder of event_image_*.npy");
}

namespace {

constexpr const char* kImages = "images";
constexpr const char* kLensArray = "lens_array";

/// Returns the images of each cycle from an array [cycles, image, y, x].
Result<std::vector<CodedIntensities>> images_from_array(const NpyArray& array, const std::string& location) {
  const std::vector<size_t>& shape = array.shape;
  if (shape.size() != 4 || array.num_elements() == 0) {
    return fail(ErrorCode::kShape, location, "intensity images have shape ", shape_text(shape),
                "; expected [cycles, image, y, x]");
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, array.to_float(location));
  if (!std::ranges::all_of(values, [](float value) { return std::isfinite(value); })) {
    return fail(ErrorCode::kInvalidValue, location, "an intensity is not finite; correct the images");
  }
  return split_cycles(values, shape);
}

Result<void> check_hybrid(const EventImages& events, const CodedIntensities& images, const std::string& location) {
  if (images.count == 1 && images.height == events.height && images.width == events.width) return {};
  return fail(ErrorCode::kShape, location, "the intensity images of a cycle have shape ",
              shape_text({images.count, images.height, images.width}), ", the event images ",
              shape_text({events.count, events.height, events.width}),
              "; beside events there is one image of their size");
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
    E2LF_ASSIGN_OR_RETURN(EventImageFile events, from_arrays(arrays, path));
    if (events.cycles.size() != file.cycles.size()) {
      return fail(ErrorCode::kShape, location, file.cycles.size(), " cycles of images with ", events.cycles.size(),
                  " of events; give both for each cycle");
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
  Result<EventImageFile> events = EventImageFile();
  if (path.extension() == ".npz") {
    E2LF_ASSIGN_OR_RETURN(NpzArrays arrays, read_npz(path));
    if (holds_images(arrays)) return measurement_of_arrays(std::move(arrays), path);
    events = from_arrays(arrays, path);
  } else {
    events = read_event_images(path);
  }
  if (!events) return events.error();
  MeasurementFile file{{}, std::move(events->setup)};
  for (EventImages& cycle : events->cycles) file.cycles.emplace_back(std::move(cycle));
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
