// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "e2lf/base/text.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kMaxSide = 2048;  // x and y have 11 bits

using Size = std::pair<size_t, size_t>;  // width and height

/// Returns the sensor size of old cameras, whose files do not state it.
std::optional<Size> size_of_system(const std::string& system_id) {
  if (system_id == "48" || system_id == "49" || system_id == "50") return Size{1280, 720};
  if (system_id == "21" || system_id == "28" || system_id == "40") return Size{640, 480};
  if (system_id == "59") return Size{320, 320};
  return std::nullopt;
}

/// The content of the key `format`: "EVT3;height=720;width=1280;endianness=little", where all but the first part are
/// optional.
struct FormatKey {
  std::string codec;
  std::optional<size_t> width, height;
  std::string endianness;
};

Result<FormatKey> parse_format(std::string_view text, const Error& bad_size) {
  FormatKey key;
  const std::string_view encoding = trimmed(text.substr(0, text.find(';')));
  for (const RawEncoding& known : kRawEncodings) {
    if (encoding == known.format || encoding == cat("EVT", known.version)) key.codec = known.codec;
  }
  if (key.codec.empty()) {
    return fail(ErrorCode::kUnsupported, bad_size.location, "the encoding ", encoding,
                " is not supported; record as EVT2, EVT2.1, EVT3 or EVT4");
  }
  while (text.find(';') != std::string_view::npos) {
    text.remove_prefix(text.find(';') + 1);
    const std::string_view field = text.substr(0, text.find(';'));
    const size_t equals = field.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = trimmed(field.substr(0, equals));
    const std::string_view value = trimmed(field.substr(equals + 1));
    if (name == "endianness") key.endianness = value;
    if (name != "width" && name != "height") continue;
    const auto side = parse_side(value, kMaxSide);
    if (!side) return bad_size;
    (name == "width" ? key.width : key.height) = *side;
  }
  return key;
}

/// Sets format, size and byte order from the keys. Precedence: format, then evt and geometry, then system_ID.
Result<void> interpret(RawHeader& header, const std::string& name) {
  RecordingInfo& info = header.info;
  const Error bad_size{ErrorCode::kFormat, cat("the header gives a size that is not 1 to ", kMaxSide, "; repair it"),
                       cat(name, ": header")};
  Size size;
  if (const auto geometry = info.find("geometry")) {
    const auto parsed = parse_geometry(*geometry, kMaxSide);
    if (!parsed) return bad_size;
    size = *parsed;
  }
  if (const auto version = info.find("evt")) {
    for (const RawEncoding& known : kRawEncodings) {
      if (*version == known.version) info.format = known.codec;
    }
    if (info.format.empty()) {
      return fail(ErrorCode::kUnsupported, bad_size.location, "EVT ", *version,
                  " is not supported; record as EVT2, EVT2.1, EVT3 or EVT4");
    }
  }
  if (const auto endianness = info.find("endianness")) header.endianness = *endianness;
  if (const auto format = info.find("format")) {
    E2LF_ASSIGN_OR_RETURN(const FormatKey key, parse_format(*format, bad_size));
    const Size stated{key.width.value_or(size.first), key.height.value_or(size.second)};
    if ((size != Size() && stated != size) || (!info.format.empty() && key.codec != info.format)) {
      return fail(ErrorCode::kFormat, bad_size.location,
                  "the keys of the header contradict each other (format, evt, geometry); repair it");
    }
    size = stated;
    info.format = key.codec;
    if (!key.endianness.empty()) header.endianness = key.endianness;
  }
  if (const auto system = info.find("system_ID"); system && size == Size()) {
    size = size_of_system(*system).value_or(Size());
  }
  std::tie(info.width, info.height) = size;
  return {};
}

bool is_rewritten_key(const std::string& key) {
  return key == "evt" || key == "format" || key == "geometry" || key == "endianness" || key == "end";
}

}  // namespace

Result<RawHeader> parse_raw_header(std::span<const uint8_t> bytes, bool ended, const std::string& name) {
  auto lines = parse_percent_header(as_text(bytes), ended);
  if (!lines) return fail(ErrorCode::kTruncated, name, "the header is incomplete; read more of it");
  RawHeader header;
  header.num_bytes = lines->num_bytes;
  header.info.header = std::move(lines->keys);
  E2LF_RETURN_IF_ERROR(interpret(header, name));
  return header;
}

Result<RawHeader> read_raw_header(ByteSource& source, const OpenOptions& options) {
  std::span<const uint8_t> bytes;
  Result<RawHeader> header = RawHeader();
  bool ended = false;
  do {
    const size_t wanted = bytes.size() + 1;
    E2LF_ASSIGN_OR_RETURN(bytes, source.fetch(wanted));
    ended = bytes.size() < wanted;
    header = parse_raw_header(bytes, ended, source.name());
  } while (!header && header.error().code == ErrorCode::kTruncated && !ended);
  if (!header) return header;
  source.consume(header->num_bytes);

  RecordingInfo& info = header->info;
  if (!options.format.empty() && options.format != "raw") {
    if (!info.format.empty() && info.format != options.format) {
      return fail(ErrorCode::kInvalidValue, source.name(), "the file states that its format is ", info.format, ", not ",
                  options.format, "; leave the option out");
    }
    info.format = options.format;
  }
  if (info.format.empty()) {
    return Error{ErrorCode::kFormat, "the file does not state how its events are encoded; give the format, e.g. evt3",
                 source.name(), "event_format"};
  }
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, source.name()));
  if (std::max(info.width, info.height) > kMaxSide) {
    return fail(ErrorCode::kInvalidValue, "", "a RAW recording is at most ", kMaxSide, " pixels wide and high");
  }
  return header;
}

bool is_raw_header(std::span<const uint8_t> head) {
  const auto header = parse_raw_header(head, /*ended=*/true, "");
  if (!header) return header.error().code == ErrorCode::kFormat || header.error().code == ErrorCode::kUnsupported;
  const RecordingInfo& info = header->info;
  return !info.format.empty() || info.find("system_ID") || info.find("integrator_name");
}

std::string raw_header_text(const RecordingInfo& info) {
  const RawEncoding* encoding = &kRawEncodings.back();
  for (const RawEncoding& known : kRawEncodings) {
    if (info.format == known.codec) encoding = &known;
  }
  std::string text;
  const auto add = [&text](const std::string& key, const std::string& value) {
    text += cat("% ", key, " ", value, "\n");
  };
  // The vendor's software selects a plugin by these keys.
  constexpr std::array<std::array<const char*, 2>, 4> kDefaults = {{{"camera_integrator_name", "Prophesee"},
                                                                    {"integrator_name", "Prophesee"},
                                                                    {"plugin_integrator_name", "Prophesee"},
                                                                    {"plugin_name", "hal_plugin_prophesee"}}};
  for (const auto& [key, value] : kDefaults) {
    if (!info.find(key)) add(key, value);
  }
  for (const auto& [key, value] : info.header) {
    const bool is_plain = !key.empty() && std::all_of(key.begin(), key.end(), is_key_character);
    if (is_plain && !is_rewritten_key(key)) add(key, header_text(value));
  }
  const bool is_evt21 = info.format == "evt2.1";
  const std::string endianness = info.find("endianness") == "legacy" ? "legacy" : "little";
  add("evt", encoding->version);
  add("format", cat(encoding->format, is_evt21 ? cat(";endianness=", endianness) : "", ";height=", info.height,
                    ";width=", info.width));
  add("geometry", cat(info.width, "x", info.height));
  return text + "% end\n";
}

}  // namespace e2lf::recordings
