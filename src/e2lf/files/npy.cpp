// SPDX-License-Identifier: MIT
#include "e2lf/files/npy.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <functional>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"

namespace e2lf {

size_t element_size(std::string_view code) {
  size_t size = 0;
  with_element_type(code, [&](auto type) { size = sizeof(type); });
  return size;
}

Result<std::vector<float>> elements_to_float(std::string_view code, std::span<const uint8_t> bytes,
                                             const std::string& name) {
  std::vector<float> values;
  const bool known = with_element_type(code, [&](auto type) {
    using T = decltype(type);
    values.resize(bytes.size() / sizeof(T));
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(load_element<T>(bytes.data() + i * sizeof(T)));
  });
  if (known) return values;
  return fail(ErrorCode::kUnsupported, name, "elements of type \"", code, "\" are not numbers; store plain numbers");
}

Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size, const std::string& location) {
  size_t size = item_size;
  bool empty = false;
  for (const size_t extent : shape) {
    empty = empty || extent == 0;
    if (__builtin_mul_overflow(size, std::max<size_t>(extent, 1), &size)) {
      return fail(ErrorCode::kFormat, location, "the shape is larger than any memory; the file is damaged");
    }
  }
  return empty ? 0 : size;
}

size_t NpyArray::num_elements() const {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

Result<std::vector<float>> NpyArray::to_float(const std::string& name) const {
  if (fields.empty()) return elements_to_float(type, bytes, name);
  return fail(ErrorCode::kUnsupported, name, "an array of records where plain numbers are expected; store one field");
}

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr size_t kMaxRank = 64;

constexpr size_t kMostHeaderBytes = size_t{1} << 20;

/// Returns the Python literal of which a header consists as JSON; tuples become lists.
std::string json_of_literal(std::string_view literal) {
  std::string json;
  char quote = '\0';
  for (const char c : literal) {
    if (quote != '\0') {
      if (c == quote) quote = '\0';
      json += quote == '\0' ? "\"" : c == '"' ? "\\\"" : std::string(1, c);
    } else if (c == '\'' || c == '"') {
      quote = c;
      json += '"';
    } else if (c == ')' || c == ']' || c == '}') {
      json.erase(json.find_last_not_of(" ,") + 1);  // a list may end with a comma
      json += c == ')' ? ']' : c;
    } else {
      json += c == '(' ? '[' : c == 'T' ? 't' : c == 'F' ? 'f' : c;  // True and False
    }
  }
  return json;
}

Error malformed_npy(const std::string& location, const std::string& what) {
  return fail(ErrorCode::kFormat, location, "not a numpy header (", what, "); save it again with numpy.save");
}

struct ElementCode {
  std::string type;  ///< without byte order
  size_t size = 0;
  bool big_endian = false;
  bool padding = false;
};

/// Parses a type code such as "<i2", "|u1" or ">f4". "|V3" denotes padding, which is allowed within records only.
Result<ElementCode> parse_code(const std::string& text, const std::string& location) {
  const bool has_order = !text.empty() && std::strchr("<>|=", text[0]) != nullptr;
  ElementCode code;
  code.type = text.substr(has_order ? 1 : 0);
  code.size = element_size(code.type);
  code.big_endian = has_order && text[0] == '>' && code.size > 1;
  if (code.size == 0 && code.type.size() > 1 && code.type[0] == 'V') {
    const char* end = code.type.data() + code.type.size();
    code.padding = std::from_chars(code.type.data() + 1, end, code.size).ptr == end;
  }
  if (code.size == 0 || code.type == "bf16") {
    const bool is_object = code.type == "O";
    return fail(ErrorCode::kUnsupported, location,
                is_object ? "the elements are Python objects, which are not read; save each array of numbers by its "
                            "name with numpy.savez"
                          : cat("elements of type \"", text, "\" are not supported; store plain numbers"));
  }
  return code;
}

void append_number(const ElementCode& code, NpyHeader& header) {
  if (code.big_endian) header.big_endian.push_back({header.array.item_size, code.size});
  header.array.item_size += code.size;
}

/// Reads [["x", "<u2"], ["", "|V2"], ...], where a name may be [title, name].
Result<void> read_record(const Json& fields, NpyHeader& header, const std::string& location) {
  for (const Json& field : fields) {
    if (!field.is_array() || field.size() < 2) return malformed_npy(location, "a field is not a tuple");
    const Json& name = field[0].is_array() && field[0].size() == 2 ? field[0][1] : field[0];
    if (!name.is_string()) return malformed_npy(location, "a field has no plain name");
    if (field.size() > 2 || !field[1].is_string()) {
      return fail(ErrorCode::kUnsupported, location, "field \"", name.get<std::string>(),
                  "\" is nested or an array; store plain fields");
    }
    E2LF_ASSIGN_OR_RETURN(const ElementCode code, parse_code(field[1].get<std::string>(), location));
    size_t record_size = 0;
    if (__builtin_add_overflow(header.array.item_size, code.size, &record_size)) {
      return malformed_npy(location, "the record is larger than any memory");
    }
    if (!code.padding) header.array.fields.push_back({name.get<std::string>(), code.type, header.array.item_size});
    append_number(code, header);
  }
  if (header.array.fields.empty()) return malformed_npy(location, "a record without fields");
  return {};
}

Result<void> read_descr(const Json& descr, NpyHeader& header, const std::string& location) {
  if (descr.is_array()) return read_record(descr, header, location);
  if (!descr.is_string()) return malformed_npy(location, "\"descr\" is neither text nor a list");
  E2LF_ASSIGN_OR_RETURN(const ElementCode code, parse_code(descr.get<std::string>(), location));
  if (code.padding) {
    return fail(ErrorCode::kUnsupported, location, "elements of type \"V", code.size,
                "\" are not numbers; store numbers");
  }
  header.array.type = code.type;
  append_number(code, header);
  return {};
}

Result<void> read_dictionary(std::string_view text, NpyHeader& header, const std::string& location) {
  const std::string literal = json_of_literal(text);
  if (is_nested_deeply(literal)) return malformed_npy(location, "the dictionary is nested too deeply");
  const Json json = Json::parse(literal, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || json.size() != 3 || !json.contains("descr") || !json.contains("fortran_order") ||
      !json.contains("shape")) {
    return malformed_npy(location, "no dictionary of descr, fortran_order and shape");
  }
  E2LF_RETURN_IF_ERROR(read_descr(json["descr"], header, location));
  const Json &order = json["fortran_order"], &shape = json["shape"];
  if (!order.is_boolean()) return malformed_npy(location, "\"fortran_order\" is neither True nor False");
  const bool are_sizes = shape.is_array() && shape.size() <= kMaxRank &&
                         std::all_of(shape.begin(), shape.end(), [](const Json& n) { return n.is_number_unsigned(); });
  if (!are_sizes) return malformed_npy(location, "\"shape\" is not a tuple of sizes");
  header.fortran_order = order.get<bool>();
  header.array.shape = shape.get<std::vector<size_t>>();
  return {};
}

std::string quoted(const std::string& text) {
  const char quote = text.find('\'') == std::string::npos ? '\'' : '"';
  return cat(quote, text, quote);
}

std::string code_text(const std::string& type) {
  return quoted((element_size(type) == 1 ? "|" : "<") + type);
}

std::string descr_text(const NpyArray& array) {
  if (array.fields.empty()) return code_text(array.type);
  std::string text;
  size_t offset = 0;
  const auto pad_to = [&](size_t end) {
    if (end > offset) text += cat("('', '|V", end - offset, "'), ");
  };
  for (const NpyField& field : array.fields) {
    pad_to(field.offset);
    text += cat("(", quoted(field.name), ", ", code_text(field.type), "), ");
    offset = field.offset + element_size(field.type);
  }
  pad_to(array.item_size);
  text.resize(text.size() - 2);
  return "[" + text + "]";
}

}  // namespace

Result<NpyHeader> parse_npy_header(std::span<const uint8_t> bytes, const std::string& name) {
  const Error truncated{ErrorCode::kTruncated, "the file ends within the numpy header; copy it again", name};
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMagic.size()));
  if (head != kMagic.substr(0, head.size())) return malformed_npy(name, "it does not begin with \\x93NUMPY");
  if (bytes.size() < 10) return truncated;
  const uint8_t version = bytes[6];
  if (version < 1 || version > 3) {
    return fail(ErrorCode::kUnsupported, name, "numpy format version ", int{version}, "; save it as version 1 to 3");
  }
  const size_t length_size = version == 1 ? 2 : 4;
  const size_t text_offset = kMagic.size() + 2 + length_size;
  if (bytes.size() < text_offset) return truncated;
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kMagic.size() + 2, length_size);
  if (length > bytes.size() - text_offset) return truncated;
  if (length > kMostHeaderBytes) return malformed_npy(name, "the header is too long");

  NpyHeader header;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + text_offset, length);
  const std::string location = cat(name, ": byte ", text_offset);
  E2LF_RETURN_IF_ERROR(read_dictionary(text, header, location));
  E2LF_ASSIGN_OR_RETURN(header.data_size, checked_byte_size(header.array.shape, header.array.item_size, location));
  header.data_offset = text_offset + length;
  return header;
}

std::vector<uint8_t> npy_header_bytes(const NpyArray& array) {
  std::string shape;
  for (const size_t extent : array.shape) shape += cat(shape.empty() ? "" : " ", extent, ",");
  if (array.shape.size() > 1) shape.pop_back();
  std::string text = cat("{'descr': ", descr_text(array), ", 'fortran_order': False, 'shape': (", shape, "), }");
  // The data begin at a multiple of 64 bytes, and the text ends with a newline. Long record types need version 2.
  const size_t version = text.size() + 80 > 0xFFFF ? 2 : 1;
  const size_t length_size = version == 1 ? 2 : 4;
  const size_t used = kMagic.size() + 2 + length_size + text.size() + 1;
  text += std::string((64 - used % 64) % 64, ' ') + "\n";

  std::vector<uint8_t> bytes(kMagic.begin(), kMagic.end());
  bytes.push_back(static_cast<uint8_t>(version));
  bytes.push_back(0);
  for (size_t i = 0; i < length_size; ++i) bytes.push_back(static_cast<uint8_t>(text.size() >> (8 * i)));
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

namespace {

void reverse_big_endian(const NpyHeader& header, std::vector<uint8_t>& bytes) {
  for (size_t item = 0; item < bytes.size(); item += header.array.item_size) {
    for (const NpyHeader::Number& number : header.big_endian) {
      const auto begin = bytes.begin() + static_cast<ptrdiff_t>(item + number.offset);
      std::reverse(begin, begin + static_cast<ptrdiff_t>(number.size));
    }
  }
}

/// Reorders column-major items (the first index runs fastest) to row-major order.
std::vector<uint8_t> fortran_to_c(const NpyArray& array, const std::vector<uint8_t>& bytes) {
  std::vector<uint8_t> ordered(bytes.size());
  std::vector<size_t> index(array.shape.size(), 0);
  std::vector<size_t> strides(array.shape.size());
  size_t stride = array.item_size;
  for (size_t axis = 0; axis < strides.size(); ++axis) {
    strides[axis] = stride;
    stride *= array.shape[axis];
  }
  size_t source = 0;
  for (size_t target = 0; target < ordered.size(); target += array.item_size) {
    std::memcpy(ordered.data() + target, bytes.data() + source, array.item_size);
    // Advance the row-major index; the last axis runs fastest.
    for (size_t axis = index.size(); axis-- > 0;) {
      source += strides[axis];
      if (++index[axis] < array.shape[axis]) break;
      source -= strides[axis] * index[axis];
      index[axis] = 0;
    }
  }
  return ordered;
}

}  // namespace

Result<NpyArray> decode_npy(std::span<const uint8_t> bytes, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(bytes, name));
  const std::span<const uint8_t> data = bytes.subspan(header.data_offset);
  if (data.size() != header.data_size) {
    const bool truncated = data.size() < header.data_size;
    return Error{truncated ? ErrorCode::kTruncated : ErrorCode::kFormat,
                 cat("the header of shape ", shape_text(header.array.shape), " needs ", header.data_size,
                     " bytes of data, the file has ", data.size(), "; ",
                     truncated ? "copy it again" : "store one array in each file"),
                 name};
  }
  header.array.bytes.assign(data.begin(), data.end());
  if (!header.big_endian.empty()) reverse_big_endian(header, header.array.bytes);
  if (header.fortran_order) header.array.bytes = fortran_to_c(header.array, header.array.bytes);
  return std::move(header.array);
}

std::vector<uint8_t> encode_npy(const NpyArray& array) {
  E2LF_REQUIRE(array.bytes.size() == array.num_elements() * array.item_size, "the shape does not fit the bytes");
  std::vector<uint8_t> bytes = npy_header_bytes(array);
  bytes.insert(bytes.end(), array.bytes.begin(), array.bytes.end());
  return bytes;
}

Result<NpyArray> read_npy(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return decode_npy(bytes, path.string());
}

Result<NpyArray> peek_npy(const std::filesystem::path& path) {
  constexpr size_t kMostPrefixBytes = 12;
  E2LF_ASSIGN_OR_RETURN(const auto head, read_head(path, kMostPrefixBytes + kMostHeaderBytes));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(head, path.string()));
  return std::move(header.array);
}

Result<void> write_npy(const std::filesystem::path& path, const NpyArray& array) {
  return write_file(path, encode_npy(array));
}

}  // namespace e2lf
