// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/raw_codec.h"

#include "e2lf/recordings/codecs/prophesee_raw/evt2/evt2_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt2/evt2_encoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt21/evt21_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt21/evt21_encoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_encoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt4/evt4_reader.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_reader.h"

namespace e2lf::recordings {
namespace {

template <WordCodec Codec>
ReaderPtr make_reader(SourcePtr source, RawHeader header, const OpenOptions& options) {
  return std::make_unique<RawReader<Codec>>(std::move(source), std::move(header), options);
}

Result<ReaderPtr> open_evt21(SourcePtr source, RawHeader header, const OpenOptions& options) {
  constexpr size_t kLookedAtBytes = 4096;
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> words, source->fetch(kLookedAtBytes));
  const evt21::ByteOrder order = evt21::find_byte_order(words, header.endianness);
  return order == evt21::ByteOrder::kLittle
             ? make_reader<evt21::Codec<evt21::ByteOrder::kLittle>>(std::move(source), std::move(header), options)
             : make_reader<evt21::Codec<evt21::ByteOrder::kLegacy>>(std::move(source), std::move(header), options);
}

}  // namespace

Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(RawHeader header, read_raw_header(*source, options));
  if (header.info.format == "evt2.1") return open_evt21(std::move(source), std::move(header), options);
  if (header.info.format == "evt2") return make_reader<evt2::Codec>(std::move(source), std::move(header), options);
  if (header.info.format == "evt4") return evt4::make_reader(std::move(source), std::move(header.info), options);
  return make_reader<evt3::Codec>(std::move(source), std::move(header), options);
}

Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info) {
  if (info.format == "evt2") return evt2::create(std::move(sink), info);
  if (info.format == "evt2.1") return evt21::create(std::move(sink), info);
  return evt3::create(std::move(sink), info);
}

}  // namespace e2lf::recordings
