// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/event_image_io.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"

namespace e2lf::capture {
namespace {

namespace fs = std::filesystem;

/// Returns the position of an element as its indices, "[0, 2, 14, 7]".
std::string place_of(size_t element, const std::vector<size_t>& shape) {
  std::vector<size_t> place(shape.size());
  for (size_t axis = shape.size(); axis-- > 0; element /= shape[axis]) place[axis] = element % shape[axis];
  return shape_text(place);
}

/// Fails if floating-point numbers are not integers, naming the first one.
Result<void> check_whole(const NpyArray& array, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, array.to_float(location));
  const auto is_finite = [](float value) { return std::isfinite(value); };
  const auto infinite = std::find_if_not(values.begin(), values.end(), is_finite);
  const auto index_of = [&](auto found) { return static_cast<size_t>(found - values.begin()); };
  if (infinite != values.end()) {
    const auto count = values.size() - static_cast<size_t>(std::count_if(values.begin(), values.end(), is_finite));
    return Error{ErrorCode::kInvalidValue,
                 cat(count, count == 1 ? " count is" : " counts are", " not finite (NaN or infinity), the first is ",
                     *infinite, " at ", place_of(index_of(infinite), array.shape),
                     "; event images contain integers, so replace these values"),
                 location};
  }
  const auto part = std::find_if(values.begin(), values.end(), [](float value) { return value != std::trunc(value); });
  if (part == values.end()) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("the count ", *part, " at ", place_of(index_of(part), array.shape),
                   " is not a whole number; event images contain sums of signed events, so undo their scaling"),
               location};
}

/// Converts `array` to int16; any value that is not an integer within int16 is an error.
Result<std::vector<int16_t>> to_counts(const NpyArray& array, const std::string& location) {
  if (array.type.starts_with('f')) E2LF_RETURN_IF_ERROR(check_whole(array, location));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> rough, array.to_float(location));
  // In unsigned numbers of 8 to 64 bits, -1 is the largest value, so values beyond half of it were negative.
  const bool is_unsigned = array.type.starts_with('u');
  const auto half = static_cast<float>(std::ldexp(0.5, static_cast<int>(8 * array.item_size)));
  std::vector<int16_t> counts(rough.size());
  for (size_t i = 0; i < rough.size(); ++i) {
    if (is_unsigned && rough[i] >= half) {
      return Error{ErrorCode::kInvalidValue,
                   cat("the counts are of an unsigned type (", array.type, "), in which -1 became ", rough[i], " at ",
                       place_of(i, array.shape), "; store them as int16"),
                   location};
    }
    if (rough[i] < std::numeric_limits<int16_t>::min() || rough[i] > std::numeric_limits<int16_t>::max()) {
      return Error{ErrorCode::kInvalidValue,
                   cat("the event count ", rough[i], " at ", place_of(i, array.shape),
                       " does not fit int16; is this an event image?"),
                   location};
    }
    counts[i] = static_cast<int16_t>(rough[i]);
  }
  return counts;
}

/// Returns the cycles of an array [cycles, N-1, y, x] or [N-1, y, x].
Result<std::vector<EventImages>> cycles_from_array(const NpyArray& array, const std::string& location) {
  const std::vector<size_t>& shape = array.shape;
  if ((shape.size() != 3 && shape.size() != 4) || array.num_elements() == 0) {
    return Error{ErrorCode::kShape,
                 cat("an array of shape ", shape_text(shape),
                     " is neither event images, [N-1, y, x] or [cycles, N-1, "
                     "y, x], nor a list of events, [events, 4] with the columns t, x, y, p; store one of these forms"),
                 location};
  }
  // No display shows more patterns than a camera has columns.
  constexpr size_t kMostTransitions = 16;
  if (shape[shape.size() - 3] > kMostTransitions && shape.back() <= kMostTransitions) {
    return Error{
        ErrorCode::kShape,
        cat("event images of shape ", shape_text(shape), " have their axes in another order; store [N-1, y, x] ",
            "or [cycles, N-1, y, x], as numpy.moveaxis(events, -1, -3) does"),
        location};
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<int16_t> counts, to_counts(array, location));
  const size_t num_cycles = shape.size() == 4 ? shape[0] : 1;
  const size_t axis = shape.size() - 3;
  std::vector<EventImages> cycles(num_cycles);
  const size_t cycle_size = counts.size() / num_cycles;
  for (size_t i = 0; i < num_cycles; ++i) {
    EventImages& cycle = cycles[i];
    cycle.count = shape[axis];
    cycle.height = shape[axis + 1];
    cycle.width = shape[axis + 2];
    const auto begin = counts.begin() + static_cast<ptrdiff_t>(i * cycle_size);
    cycle.values.assign(begin, begin + static_cast<ptrdiff_t>(cycle_size));
  }
  return cycles;
}

Result<void> check_codes(const Codes& codes, size_t transitions, const std::string& location) {
  if (codes.num_patterns == transitions + 1) return {};
  return Error{ErrorCode::kShape,
               cat("there are ", codes.num_patterns, " codes, but ", transitions, " event images need ",
                   transitions + 1, "; give the codes that the events were recorded with"),
               location};
}

Result<EventImageFile> from_arrays(const NpzArrays& arrays, const fs::path& path) {
  const auto found = arrays.find("events");
  if (found == arrays.end()) {
    return Error{ErrorCode::kNotFound, "the file contains no array \"events\"; add it and, if they are known, codes",
                 path.string()};
  }
  EventImageFile file;
  E2LF_ASSIGN_OR_RETURN(file.cycles, cycles_from_array(found->second, path.string() + ": events"));
  E2LF_ASSIGN_OR_RETURN(file.setup, setup_from_arrays(arrays, path.string()));
  if (file.setup.codes) {
    E2LF_RETURN_IF_ERROR(check_codes(*file.setup.codes, file.cycles.front().count, path.string() + ": codes"));
  }
  return file;
}

/// Returns the K of event_image_0000K.npy, or nothing for other names.
std::optional<size_t> image_number(const fs::path& path) {
  const std::string stem = path.stem().string(), prefix = "event_image_";
  if (path.extension() != ".npy" || !stem.starts_with(prefix)) return std::nullopt;
  size_t number = 0;
  const char* end = stem.data() + stem.size();
  const auto parsed = std::from_chars(stem.data() + prefix.size(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return number;
}

/// Lists the event images of a folder in order; their numbers must run from 0 without gaps.
Result<std::vector<fs::path>> list_images(const fs::path& folder) {
  std::vector<std::pair<size_t, fs::path>> found;
  std::error_code status;
  for (fs::directory_iterator entry(folder, status), end; !status && entry != end; entry.increment(status)) {
    if (const auto number = image_number(entry->path())) found.emplace_back(*number, entry->path());
  }
  if (status) return Error{ErrorCode::kIo, cat("cannot list the folder: ", status.message()), folder.string()};
  if (found.empty()) {
    return Error{
        ErrorCode::kNotFound,
        "no event_image_*.npy in the folder; give a folder of event images (`e2lf simulate` generates them from a "
        "light field)",
        folder.string()};
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> paths;
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i].first != i) {
      return Error{ErrorCode::kNotFound,
                   cat("event image ", i, " is missing; the numbers must run from 0 without gaps"), folder.string()};
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
      return Error{ErrorCode::kShape, cat("an event image has shape ", shape_text(shape), "; expected [y, x]"),
                   path.string()};
    }
    if (cycle.values.empty()) {
      cycle.height = shape[0];
      cycle.width = shape[1];
    } else if (shape[0] != cycle.height || shape[1] != cycle.width) {
      return Error{ErrorCode::kShape,
                   cat("this event image has shape ", shape_text(shape), ", the first one ",
                       shape_text({cycle.height, cycle.width}), "; all must have one size"),
                   path.string()};
    }
    E2LF_ASSIGN_OR_RETURN(const std::vector<int16_t> counts, to_counts(array, path.string()));
    cycle.values.insert(cycle.values.end(), counts.begin(), counts.end());
  }
  return EventImageFile{{std::move(cycle)}};
}

}  // namespace

Result<EventImageFile> read_event_images(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) {
    return Error{ErrorCode::kNotFound, "there is no such file or folder; check the path", path.string()};
  }
  if (fs::is_directory(path, status)) return read_folder(path);
  const std::string extension = path.extension().string();
  if (extension == ".npz") {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, read_npz(path));
    return from_arrays(arrays, path);
  }
  if (extension == ".mat") {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, read_event_arrays_mat(path));
    return from_arrays(arrays, path);
  }
  if (extension == ".npy") {
    E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
    E2LF_ASSIGN_OR_RETURN(std::vector<EventImages> cycles, cycles_from_array(array, path.string()));
    return EventImageFile{std::move(cycles)};
  }
  return Error{ErrorCode::kUnsupported,
               "this is not a file of event images; use .npz, .npy, .mat or a folder of event_image_*.npy",
               path.string()};
}

Result<void> write_event_images(const fs::path& path, const EventImageFile& file) {
  E2LF_REQUIRE(!file.cycles.empty(), "writing event images needs at least one cycle");
  E2LF_ASSIGN_OR_RETURN(EventImageWriter writer, EventImageWriter::create(path));
  writer.keep(file.setup);
  for (const EventImages& cycle : file.cycles) E2LF_RETURN_IF_ERROR(writer.add(cycle));
  return writer.finish();
}

namespace {

// Largest decompressed size of a variable.
constexpr uint64_t kMostMatBytes = uint64_t{2} << 30;

/// Transposes images [..., x, y] to [..., y, x]; `rows` and `columns` are those of the result.
std::vector<uint8_t> transposed(std::span<const uint8_t> bytes, size_t rows, size_t columns, size_t each) {
  std::vector<uint8_t> out(bytes.size());
  const size_t image = rows * columns * each;
  for (size_t begin = 0; image > 0 && begin < bytes.size(); begin += image) {
    for (size_t y = 0; y < rows; ++y) {
      for (size_t x = 0; x < columns; ++x) {
        std::copy_n(bytes.data() + begin + (x * rows + y) * each, each, out.data() + begin + (y * columns + x) * each);
      }
    }
  }
  return out;
}

/// Returns whether `count` is the product of the extents, which may overflow.
bool fills(size_t count, const std::vector<size_t>& extents) {
  for (const size_t extent : extents) {
    if (extent == 0 || count % extent != 0) return false;
    count /= extent;
  }
  return count == 1;
}

Result<NpyArray> to_numpy(const MatArray& array, const std::string& location) {
  const std::string type = numpy_code(array.storage);
  const size_t bytes = element_size(type);
  const bool is_numeric = array.array_class >= static_cast<uint8_t>(MatClass::kDouble) &&
                          array.array_class <= static_cast<uint8_t>(MatClass::kUint32);
  if (!is_numeric || array.complex || bytes == 0) {
    return Error{ErrorCode::kUnsupported,
                 "the array does not contain real numbers of 8 to 32 bits, single or double; convert it", location};
  }
  const std::vector<size_t>& extents = array.extents;
  if (extents.size() < 2 || array.data.size() % bytes != 0 || !fills(array.data.size() / bytes, extents)) {
    return Error{ErrorCode::kFormat, cat("the numbers do not fill ", shape_text(extents), "; save the file again"),
                 location};
  }
  NpyArray numbers;
  numbers.type = type;
  numbers.item_size = bytes;
  // The first axis is the fastest one in MATLAB and the slowest in numpy.
  numbers.shape.assign(extents.rbegin(), extents.rend());
  std::swap(numbers.shape[extents.size() - 1], numbers.shape[extents.size() - 2]);
  numbers.bytes = transposed(array.data, extents[0], extents[1], bytes);
  // MATLAB stores signed numbers without a sign if none is negative, so this does not indicate a lost sign.
  const auto array_class = static_cast<MatClass>(array.array_class);
  const bool is_unsigned =
      array_class == MatClass::kUint8 || array_class == MatClass::kUint16 || array_class == MatClass::kUint32;
  if (is_unsigned || numbers.type[0] != 'u') return numbers;
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> values, numbers.to_float(location));
  return make_npy<float>(numbers.shape, values);
}

}  // namespace

Result<NpzArrays> read_event_arrays_mat(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  NpzArrays arrays;
  for (const char* name : {"events", "codes", "camera", "views", "findings"}) {
    const std::string location = cat(path.string(), ": ", name);
    const auto found = find_mat_array(bytes, name, kMostMatBytes, location);
    if (!found && found.error().code == ErrorCode::kNotFound) continue;
    if (!found) return found.error();
    E2LF_ASSIGN_OR_RETURN(arrays[name], to_numpy(*found, location));
  }
  // MATLAB drops trailing axes of size 1, but keeps at least two.
  if (const auto events = arrays.find("events"); events != arrays.end() && events->second.shape.size() == 2) {
    std::vector<size_t>& shape = events->second.shape;
    constexpr size_t kFields = 5;  // of an event: t, x, y, p and perhaps another
    if (std::min(shape[0], shape[1]) <= kFields && std::max(shape[0], shape[1]) > 16) {
      return Error{ErrorCode::kShape,
                   cat("an array of shape ", shape_text(shape),
                       " is a list of events rather than an event image; write it as .csv with the columns t, x, y, p"),
                   cat(path.string(), ": events")};
    }
    shape.insert(shape.begin(), 1);
  }
  for (const char* name : {"camera", "views", "findings"}) {
    if (const auto text = arrays.find(name); text != arrays.end()) text->second.shape = {text->second.num_elements()};
  }
  return arrays;
}

}  // namespace e2lf::capture
