// SPDX-License-Identifier: MIT
// Reads AEDAT 2; declared in codecs.h.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/aedat/text_header.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::recordings::aedat {
namespace {

constexpr std::string_view kVersionLine = "#!AER-DAT2.0";
constexpr size_t kRecordBytes = 8;
constexpr size_t kBlockRecords = size_t{1} << 15;

/// Returns true if a record is the beginning of kVersionLine.
bool begins_header(const uint8_t* record) {
  return std::memcmp(record, kVersionLine.data(), kRecordBytes) == 0;
}

uint32_t load_big_endian(const uint8_t* bytes) {
  return __builtin_bswap32(load_le<uint32_t>(bytes));
}

/// The layout of the bits of an address, for one kind of camera.
struct AddressBits {
  uint32_t impossible;  ///< bits that are always zero
  uint32_t no_event;    ///< frames and inertial data
  uint32_t external;    ///< an edge at the external input
  uint32_t x_shift, x_mask, y_shift, y_mask, p_shift;
  bool on_is_zero;
};
constexpr AddressBits kDvs128 = {0x7FFF0000, 0, 0x80008000, 1, 0x7F, 8, 0x7F, 0, true};
constexpr AddressBits kDavis = {0, 0x80000000, 0x400, 12, 0x3FF, 22, 0x1FF, 11, false};

/// The number of the camera in the low bits of an event of a DAVIS, if several were recorded to one file.
constexpr uint32_t kCameraMask = 0xF;

/// The low bits of an external event of a DAVIS; other values are rising edges or pulses.
constexpr uint32_t kFallingEdge = 2, kEdgeMask = 0x7;

class Aedat2Blocks final : public EventBlocks {
 public:
  /// If there are several cameras, `camera` is the number of the one that is read, and `has_chosen` states whether it
  /// was selected; otherwise, events of others are counted.
  Aedat2Blocks(SourcePtr source, const AddressBits& bits, size_t width, size_t height, uint32_t camera, bool has_chosen)
      : source_(std::move(source)),
        bits_(bits),
        width_(width),
        height_(height),
        camera_(camera),
        has_chosen_(has_chosen),
        header_bytes_(source_->position()) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    begins_recording_ = false;
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kRecordBytes));
    const size_t count = std::min(bytes.size() / kRecordBytes, kBlockRecords);
    if (count == 0) {
      if (!bytes.empty()) summary.add(Violation::kTruncated, source_->position());
      source_->consume(bytes.size());
      return false;
    }
    // A recording that was appended with its header.
    if (begins_header(bytes.data())) {
      E2LF_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(*source_));
      if (header.bytes == 0) {
        summary.add_dropped(Violation::kBadRecord, source_->position());
        source_->consume(kRecordBytes);
      }
      clock_ = {};
      begins_recording_ = true;
      return true;
    }
    for (size_t i = 0; i < count; ++i) {
      const uint8_t* const record = &bytes[i * kRecordBytes];
      if (begins_header(record)) {
        source_->consume(i * kRecordBytes);
        return true;
      }
      if ((load_big_endian(record) & bits_.impossible) == 0) {
        append(record, block, summary);
      } else {
        summary.add_dropped(Violation::kBadRecord, source_->position() + i * kRecordBytes);
      }
    }
    source_->consume(count * kRecordBytes);
    return true;
  }

  bool begins_recording() const override { return begins_recording_; }

  Result<void> seek_before(int64_t) override {
    clock_ = {};
    return source_->seek(header_bytes_);
  }

 private:
  void append(const uint8_t* record, EventBatch& block, DecodeSummary& summary) {
    const uint32_t address = load_big_endian(record);
    if ((address & bits_.no_event) != 0) return;
    const int64_t t_us = clock_(load_big_endian(record + 4));
    if ((address & bits_.external) != 0) {
      const bool is_falling = !bits_.on_is_zero && (address & kEdgeMask) == kFallingEdge;
      block.triggers.push_back({t_us, 0, static_cast<uint8_t>(!is_falling)});
      return;
    }
    if (!bits_.on_is_zero && (address & kCameraMask) != camera_) {
      summary.other_streams += has_chosen_ ? 0 : 1;
      return;
    }
    // A column or row beyond the sensor remains outside it.
    const uint32_t x = address >> bits_.x_shift & bits_.x_mask, y = address >> bits_.y_shift & bits_.y_mask;
    const bool is_on = (address >> bits_.p_shift & 1) != (bits_.on_is_zero ? 1 : 0);
    block.events.push_back({x < width_ ? static_cast<uint16_t>(width_ - 1 - x) : uint16_t{UINT16_MAX},
                            y < height_ ? static_cast<uint16_t>(height_ - 1 - y) : uint16_t{UINT16_MAX},
                            static_cast<uint8_t>(is_on), t_us});
  }

  SourcePtr source_;
  AddressBits bits_;
  size_t width_, height_;
  uint32_t camera_;
  bool has_chosen_;
  uint64_t header_bytes_;
  TimeUnwrapper<32> clock_;
  bool begins_recording_ = false;
};

struct Camera {
  RecordingInfo info;
  AddressBits bits = kDavis;
  uint32_t number = 0;  ///< of several cameras, the one that is read
};

/// What the addresses of some records show about a camera that the header does not name.
struct AddressExtent {
  uint32_t x_end = 0, y_end = 0;  ///< columns and rows, read as those of a DAVIS
  uint32_t high_bits = 0;         ///< bits that the addresses of a DVS128 do not have
  uint16_t cameras = 0;           ///< bit i: there are events of camera i

  void add(std::span<const uint8_t> records) {
    for (size_t i = 0; (i + 1) * kRecordBytes <= records.size(); ++i) {
      const uint32_t address = load_big_endian(&records[i * kRecordBytes]);
      high_bits |= address & kDvs128.impossible;
      if ((address & (kDavis.no_event | kDavis.external)) != 0) continue;
      x_end = std::max(x_end, (address >> kDavis.x_shift & kDavis.x_mask) + 1);
      y_end = std::max(y_end, (address >> kDavis.y_shift & kDavis.y_mask) + 1);
      cameras = static_cast<uint16_t>(cameras | 1U << (address & kCameraMask));
    }
  }

  /// Returns the smallest known camera with these addresses.
  [[nodiscard]] const char* model() const {
    if (high_bits == 0) return "DVS128";
    if (x_end <= 240 && y_end <= 180) return "DAVIS240";
    return x_end <= 346 && y_end <= 260 ? "DAVIS346" : "DAVIS640";
  }
};

/// Inspects the first records, or all of them, and returns to the first one.
Result<AddressExtent> inspect_addresses(ByteSource& source, bool all) {
  AddressExtent extent;
  const uint64_t begin = source.position();
  E2LF_ASSIGN_OR_RETURN(auto bytes, source.fetch(kDetectBytes));
  extent.add(bytes.first(std::min(bytes.size(), kDetectBytes)));
  if (!all) return extent;
  while (bytes.size() >= kRecordBytes) {
    const size_t count = bytes.size() / kRecordBytes * kRecordBytes;
    extent.add(bytes.first(count));
    source.consume(count);
    E2LF_ASSIGN_OR_RETURN(bytes, source.fetch(kRecordBytes));
  }
  E2LF_RETURN_IF_ERROR(source.seek(begin));
  return extent;
}

Result<Camera> find_camera(ByteSource& source, const TextHeader& header, const OpenOptions& options) {
  Camera camera;
  RecordingInfo& info = camera.info;
  info.format = "aedat2";
  std::string chip = header.find("AEChip:").value_or("");
  if (!chip.empty()) info.header.emplace_back("AEChip", chip);
  if (const auto created = header.find("created")) info.header.emplace_back("created", *created);
  // The size of the sensor mirrors columns and rows, so that it is never guessed from a part of the addresses.
  const bool is_named = find_camera_model(chip).has_value(), is_given = options.width != 0 && options.height != 0;
  if (!is_named && !is_given && !source.seekable()) {
    return Error{ErrorCode::kInvalidValue, "the header names no known camera; give the size of the sensor",
                 source.name(), Setting::kSensorSize};
  }
  E2LF_ASSIGN_OR_RETURN(const AddressExtent extent, inspect_addresses(source, /*all=*/!is_named && !is_given));
  if (!is_named) chip = extent.model();
  if (!is_named && !is_given) {
    info.assumptions.push_back(
        {cat("the header names no known camera; a ", chip, " is the smallest with all of its ", "addresses"),
         Setting::kSensorSize});
  }
  const CameraModel model = *find_camera_model(chip);
  camera.bits = model.is_davis ? kDavis : kDvs128;
  if (is_named || !is_given) {
    info.width = model.width;
    info.height = model.height;
  }
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, source.name()));
  if (!model.is_davis) return camera;
  std::vector<NamedStream> cameras;
  for (uint32_t number = 0; number <= kCameraMask; ++number) {
    if ((extent.cameras >> number & 1) != 0) cameras.push_back({cat(number), "", ""});
  }
  if (cameras.empty()) return camera;
  size_t chosen = 0;
  if (cameras.size() > 1) {
    E2LF_ASSIGN_OR_RETURN(chosen, choose_stream(cameras, options, source.name(), info));
  }
  for (uint32_t number = 0, seen = 0; number <= kCameraMask; ++number) {
    if ((extent.cameras >> number & 1) != 0 && seen++ == chosen) camera.number = number;
  }
  return camera;
}

}  // namespace

bool detect_aedat2(std::span<const uint8_t> head) {
  return as_text(head).starts_with(kVersionLine);
}

Result<ReaderPtr> open_aedat2(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(*source));
  if (header.lines.empty() || !("#" + header.lines[0]).starts_with(kVersionLine)) {
    return Error{ErrorCode::kFormat, cat("this is not an AEDAT 2 recording, whose first line is ", kVersionLine), name};
  }
  E2LF_ASSIGN_OR_RETURN(Camera camera, find_camera(*source, header, options));
  auto blocks = std::make_unique<Aedat2Blocks>(std::move(source), camera.bits, camera.info.width, camera.info.height,
                                               camera.number, !options.stream.empty());
  return make_block_reader(std::move(blocks), std::move(camera.info), name, options);
}

}  // namespace e2lf::recordings::aedat
