// SPDX-License-Identifier: MIT
#include "e2lf/formats/dat/dat_format.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::dat {
namespace {

size_t number_or_zero(const std::optional<std::string>& text) {
  size_t value = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), value);
  return value > 65536 ? 0 : value;
}

constexpr uint64_t kMaxProbes = 256;

/// Number of records before the position that are also read, so that plausibility is judged as in a complete scan.
constexpr uint64_t kMargin = 64;

/// A record and its full time.
struct Probe {
  uint64_t record = 0;
  int64_t t_us = 0;
};

class Search {
 public:
  Search(ByteSource& source, uint64_t header_bytes, uint64_t num_records)
      : source_(source), header_bytes_(header_bytes), num_records_(num_records) {}

  Result<Place> run(int64_t t_us) {
    E2LF_ASSIGN_OR_RETURN(const int64_t first_us, low_at(0));
    Probe low{0, first_us};
    if (first_us >= t_us) return Place();
    const uint64_t stride = std::max(kMinStride / 16, num_records_ / kMaxProbes);
    // All of them, because the times before the position alone do not show whether they are plausible.
    Probe last = low, high{num_records_, INT64_MAX};
    while (last.record + stride < num_records_) {
      E2LF_ASSIGN_OR_RETURN(const Probe next, probe(last.record + stride, last));
      if (next.t_us - last.t_us > kMaxStepUs) return Place();
      if (next.t_us < t_us) low = next;
      if (next.t_us >= t_us && high.record == num_records_) high = next;
      last = next;
    }
    E2LF_ASSIGN_OR_RETURN(low, bisect(low, high, t_us));
    return Place{low.record - std::min(low.record, kMargin), TimeUnwrapper<32>(low.t_us)};
  }

 private:
  /// Returns the median of the clock's low bits of some records.
  Result<int64_t> low_at(uint64_t record) {
    E2LF_RETURN_IF_ERROR(source_.seek(header_bytes_ + record * kRecordBytes));
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_.fetch(kTimesPerProbe * kRecordBytes));
    const size_t count = std::min(kTimesPerProbe, bytes.size() / kRecordBytes);
    if (count == 0) return Error{ErrorCode::kIo, "the file became shorter while it was read", source_.name()};
    std::vector<int64_t> times(count);
    for (size_t i = 0; i < count; ++i) times[i] = load_le<uint32_t>(&bytes[i * kRecordBytes]);
    return median(std::move(times));
  }

  /// Reads a record after another one.
  Result<Probe> probe(uint64_t record, const Probe& before) {
    E2LF_ASSIGN_OR_RETURN(const int64_t low, low_at(record));
    return Probe{record, before.t_us + static_cast<uint32_t>(low - before.t_us)};
  }

  Result<Probe> bisect(Probe low, Probe high, int64_t t_us) {
    while (high.record - low.record > 1) {
      E2LF_ASSIGN_OR_RETURN(const Probe middle, probe(low.record + (high.record - low.record) / 2, low));
      // Damaged; what is known so far is sufficient.
      if (middle.t_us > high.t_us || middle.t_us - low.t_us > kMaxStepUs) break;
      (middle.t_us < t_us ? low : high) = middle;
    }
    return low;
  }

  ByteSource& source_;
  uint64_t header_bytes_;
  uint64_t num_records_;
};

}  // namespace

std::optional<Header> parse_header(std::span<const uint8_t> head) {
  auto lines = parse_percent_header(as_text(head), /*ended=*/true);
  if (!lines || lines->keys.empty() || head.size() < lines->num_bytes + 2) return std::nullopt;
  Header header;
  header.info.format = "dat";
  header.info.header = std::move(lines->keys);
  header.bytes = lines->num_bytes + 2;
  if (header.info.find("evt") || header.info.find("format")) return std::nullopt;
  header.type = head[lines->num_bytes];
  const bool known = header.type == kTypeEvent2d || header.type == kTypeCd || header.type == kTypeTrigger;
  if (!known || head[lines->num_bytes + 1] != kRecordBytes) return std::nullopt;
  if (const auto version = number_or_zero(header.info.find("Version")); version != 0) {
    header.version = static_cast<int>(version);
  }
  header.info.width = number_or_zero(header.info.find("Width"));
  header.info.height = number_or_zero(header.info.find("Height"));
  return header;
}

std::string make_header(const RecordingInfo& info, uint8_t type) {
  std::string text = cat("% Data file containing ", type == kTypeTrigger ? "external trigger" : "CD", " events.\n");
  text += "% Version 2\n";
  if (const auto date = info.find("date")) text += cat("% Date ", header_text(*date), "\n");
  if (info.height != 0) text += cat("% Height ", info.height, "\n");
  if (info.width != 0) text += cat("% Width ", info.width, "\n");
  text += "% end\n";
  text += static_cast<char>(type);
  text += static_cast<char>(kRecordBytes);
  return text;
}

Result<Place> find_place_before(ByteSource& source, uint64_t header_bytes, int64_t t_us) {
  const uint64_t size = source.size().value_or(0);
  const uint64_t num_records = size > header_bytes ? (size - header_bytes) / kRecordBytes : 0;
  // A file that is read in one step is not searched faster.
  if (num_records <= kMinStride) return Place();
  return Search(source, header_bytes, num_records).run(t_us);
}

}  // namespace e2lf::recordings::dat
