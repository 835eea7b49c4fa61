// SPDX-License-Identifier: MIT
#include "e2lf/files/safetensors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>

#include "e2lf/base/choice.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"

namespace e2lf {
namespace {

constexpr size_t kLengthSize = 8;
constexpr const char* kMetadata = "__metadata__";

/// The names of the types, with their codes in files/npy.h.
constexpr Choice<std::string_view> kTypes[] = {
    {"F32", "f4"}, {"F16", "f2"}, {"BF16", "bf16"}, {"F64", "f8"}, {"U8", "u1"},  {"I8", "i1"},  {"I16", "i2"},
    {"U16", "u2"}, {"I32", "i4"}, {"U32", "u4"},    {"I64", "i8"}, {"U64", "u8"}, {"BOOL", "b1"}};

Error malformed(const std::string& location, const std::string& what) {
  return fail(ErrorCode::kFormat, location, what, "; save the file again");
}

/// Parses the header as JSON. A duplicate key would hide one of its tensors, so it is rejected.
Result<Json> parse_header(std::string_view text, const std::string& name) {
  const std::string location = name + ": header";
  if (is_nested_deeply(text)) return malformed(location, "the header is nested too deeply");
  std::set<std::string> keys;
  std::string twice;
  const auto watch_keys = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth == 1 && event == Json::parse_event_t::key && !keys.insert(value.get<std::string>()).second) {
      twice = value.get<std::string>();
    }
    return true;
  };
  const Json header = Json::parse(text, watch_keys, /*allow_exceptions=*/false);
  if (!header.is_object()) return malformed(location, "the header is not a JSON object");
  if (!twice.empty()) return malformed(location, cat("\"", twice, "\" is there twice"));
  return header;
}

Result<void> read_metadata(const Json& json, const std::string& name, Safetensors& file) {
  const std::string location = name + ": __metadata__";
  if (!json.is_object()) return malformed(location, "the metadata is not a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) return malformed(location, cat("\"", key, "\" is not text"));
    file.metadata[key] = value.get<std::string>();
  }
  return {};
}

bool is_list_of_sizes(const Json& json) {
  return json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& n) { return n.is_number_unsigned(); });
}

struct Range {
  size_t begin = 0, end = 0;
  std::string location;
};

/// Reads the entry of one tensor, without its bytes, from a file with `data_size` bytes of data.
Result<Range> read_entry(const Json& json, uint64_t data_size, const std::string& location, Tensor& tensor) {
  if (!json.is_object() || json.size() != 3 || !json.contains("dtype") || !json.contains("shape") ||
      !json.contains("data_offsets")) {
    return malformed(location, "expected just dtype, shape and data_offsets");
  }
  if (!json["dtype"].is_string()) return malformed(location, "dtype is not text");
  const auto name = json["dtype"].get<std::string>();
  const auto code = choice_of(name, kTypes);
  if (!code) return fail(ErrorCode::kUnsupported, location, "dtype \"", name, "\" is not supported; save it as F32");
  tensor.type = *code;
  tensor.item_size = element_size(*code);
  if (!is_list_of_sizes(json["shape"])) return malformed(location, "shape is not a list of sizes");
  if (!is_list_of_sizes(json["data_offsets"]) || json["data_offsets"].size() != 2) {
    return malformed(location, "data_offsets is not a begin and an end");
  }
  tensor.shape = json["shape"].get<std::vector<size_t>>();
  const Range range{json["data_offsets"][0].get<size_t>(), json["data_offsets"][1].get<size_t>(), location};
  E2LF_ASSIGN_OR_RETURN(const size_t size, checked_byte_size(tensor.shape, tensor.item_size, location));
  if (range.begin > range.end || range.end - range.begin != size) {
    return malformed(location, cat("data_offsets [", range.begin, ", ", range.end, ") do not hold the ", size,
                                   " bytes of shape ", shape_text(tensor.shape)));
  }
  if (range.end > data_size) {
    return fail(ErrorCode::kTruncated, location, "its data end at byte ", range.end, " of ", data_size,
                " there are; copy the file again");
  }
  return range;
}

/// Reads the metadata and the entries of all tensors, without their bytes, from a file with `data_size` bytes of data.
/// Returns where the data of each tensor are.
Result<std::map<std::string, Range>> read_entries(const Json& header, uint64_t data_size, const std::string& name,
                                                  Safetensors& file) {
  std::map<std::string, Range> ranges;
  for (const auto& [key, value] : header.items()) {
    if (key == kMetadata) {
      E2LF_RETURN_IF_ERROR(read_metadata(value, name, file));
    } else {
      E2LF_ASSIGN_OR_RETURN(ranges[key], read_entry(value, data_size, cat(name, ": ", key), file.tensors[key]));
    }
  }
  return ranges;
}

/// Checks that the tensors cover the data without holes or overlaps, as the format requires.
Result<void> check_cover(const std::map<std::string, Range>& of_tensors, size_t data_size, const std::string& name) {
  std::vector<Range> ranges;
  for (const auto& [key, range] : of_tensors) ranges.push_back(range);
  std::sort(ranges.begin(), ranges.end(),
            [](const Range& a, const Range& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
  size_t position = 0;
  for (const Range& range : ranges) {
    if (range.begin != position) {
      return malformed(range.location, cat("its data ", range.begin < position ? "overlap" : "leave a hole after",
                                           " those of another tensor at byte ", std::min(position, range.begin)));
    }
    position = range.end;
  }
  if (position != data_size) {
    return malformed(name, cat("the last ", data_size - position, " bytes belong to no tensor"));
  }
  return {};
}

/// Returns the length of the header of a file of `size` bytes that begins with `bytes`.
Result<uint64_t> header_length(std::span<const uint8_t> bytes, uint64_t size, const std::string& name) {
  if (bytes.size() < kLengthSize) {
    return fail(ErrorCode::kTruncated, name, "the file ends within its first 8 bytes; copy it again");
  }
  uint64_t length = 0;
  std::memcpy(&length, bytes.data(), kLengthSize);
  if (length <= size - kLengthSize) return length;
  if (bytes.front() == '{' || bytes.front() == '[') {
    return fail(ErrorCode::kFormat, name, "this is a JSON file, not a model; give a .safetensors file");
  }
  return fail(ErrorCode::kTruncated, name, "a header of ", length, " bytes is larger than the file (", size,
              " bytes); copy it again, or give a .safetensors file");
}

}  // namespace

std::string type_name(const Tensor& tensor) {
  return word_of<std::string_view>(tensor.type, kTypes);
}

Tensor make_bfloat16_tensor(std::vector<size_t> shape, std::span<const float> values) {
  Tensor tensor{"bf16", {}, sizeof(uint16_t), std::move(shape), {}};
  E2LF_REQUIRE(tensor.num_elements() == values.size(), "the shape does not fit the values");
  for (const float value : values) {
    const auto bits = std::bit_cast<uint32_t>(value);
    // This adds half of the discarded range, minus one if the kept part is even, so that ties round to even. NaN keeps
    // its upper bits.
    const uint32_t rounded = std::isnan(value) ? bits : bits + 0x7FFFU + ((bits >> 16U) & 1U);
    tensor.bytes.push_back(static_cast<uint8_t>(rounded >> 16U));
    tensor.bytes.push_back(static_cast<uint8_t>(rounded >> 24U));
  }
  return tensor;
}

Result<const Tensor*> Safetensors::find(const std::string& name, const std::string& file) const {
  const auto found = tensors.find(name);
  if (found != tensors.end()) return &found->second;
  std::vector<std::string> names;
  for (const auto& entry : tensors) names.push_back(entry.first);
  return fail(ErrorCode::kNotFound, file, "there is no tensor \"", name, "\"; ", suggestion(name, names));
}

Result<Safetensors> decode_safetensors(std::span<const uint8_t> bytes, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const uint64_t length, header_length(bytes, bytes.size(), name));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + kLengthSize, length);
  E2LF_ASSIGN_OR_RETURN(const Json header, parse_header(text, name));
  const auto data = bytes.subspan(kLengthSize + length);

  Safetensors file;
  E2LF_ASSIGN_OR_RETURN(const auto ranges, read_entries(header, data.size(), name, file));
  E2LF_RETURN_IF_ERROR(check_cover(ranges, data.size(), name));
  for (const auto& [key, range] : ranges) {
    const auto content = data.subspan(range.begin, range.end - range.begin);
    file.tensors[key].bytes.assign(content.begin(), content.end());
  }
  return file;
}

std::vector<uint8_t> encode_safetensors(const Safetensors& file) {
  // Wide elements come first, so that every tensor is aligned to its element size.
  std::vector<std::pair<std::string, const Tensor*>> order;
  for (const auto& [name, tensor] : file.tensors) order.emplace_back(name, &tensor);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second->item_size > b.second->item_size; });

  Json header = Json::object();
  if (!file.metadata.empty()) header[kMetadata] = file.metadata;
  size_t offset = 0;
  for (const auto& [name, tensor] : order) {
    E2LF_REQUIRE(tensor->bytes.size() == tensor->num_elements() * tensor->item_size,
                 "the shape of " + name + " does not fit its bytes");
    const size_t end = offset + tensor->bytes.size();
    header[name] = {{"dtype", type_name(*tensor)}, {"shape", tensor->shape}, {"data_offsets", {offset, end}}};
    offset = end;
  }
  std::string text = header.dump(-1, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace);
  text.resize((text.size() + 7) / 8 * 8, ' ');

  std::vector<uint8_t> bytes(kLengthSize + text.size() + offset);
  const uint64_t length = text.size();
  std::memcpy(bytes.data(), &length, kLengthSize);
  uint8_t* target = std::copy(text.begin(), text.end(), bytes.data() + kLengthSize);
  for (const auto& [name, tensor] : order) target = std::copy(tensor->bytes.begin(), tensor->bytes.end(), target);
  return bytes;
}

Result<Safetensors> read_safetensors(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_safetensors(bytes, path.string());
}

Result<Safetensors> read_safetensors_header(const std::filesystem::path& path, const std::string& tensor_name) {
  const std::string name = path.string();
  E2LF_ASSIGN_OR_RETURN(const auto start, read_head(path, kLengthSize));
  std::error_code error;
  const uint64_t size = std::max<uint64_t>(start.size(), std::filesystem::file_size(path, error));
  if (error) return fail(ErrorCode::kIo, path, "its size is unknown (", error.message(), "); give a regular file");
  E2LF_ASSIGN_OR_RETURN(const uint64_t length, header_length(start, size, name));
  E2LF_ASSIGN_OR_RETURN(const auto head, read_head(path, kLengthSize + length));
  const std::string_view text(reinterpret_cast<const char*>(head.data()) + kLengthSize, head.size() - kLengthSize);
  E2LF_ASSIGN_OR_RETURN(const Json header, parse_header(text, name));
  Safetensors file;
  E2LF_ASSIGN_OR_RETURN(const auto ranges, read_entries(header, size - kLengthSize - length, name, file));
  const auto wanted = ranges.find(tensor_name);
  if (wanted == ranges.end()) return file;
  const Range& range = wanted->second;
  Tensor& tensor = file.tensors[tensor_name];
  tensor.bytes.resize(range.end - range.begin);
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(kLengthSize + length + range.begin));
  in.read(reinterpret_cast<char*>(tensor.bytes.data()), static_cast<std::streamsize>(tensor.bytes.size()));
  if (in) return file;
  return fail(ErrorCode::kIo, path, "cannot be read; check its permissions");
}

Result<void> write_safetensors(const std::filesystem::path& path, const Safetensors& file) {
  return write_file(path, encode_safetensors(file));
}

}  // namespace e2lf
