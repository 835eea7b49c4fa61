// SPDX-License-Identifier: MIT
// Opens and creates RAW recordings of every encoding; declared in codecs.h.
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_reader.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_encoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings {
namespace {

template <typename Codec>
ReaderPtr make_reader(SourcePtr source, RawHeader header, const OpenOptions& options) {
  const std::string name = source->name();
  auto blocks = std::make_unique<RawBlocks<Codec>>(std::move(source), header.info, options);
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(header.info), name, options);
}

Result<ReaderPtr> open_evt21(SourcePtr source, RawHeader header, const OpenOptions& options) {
  using timed::Codec, timed::Encoding;
  constexpr size_t kLookedAtBytes = 4096;
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> words, source->fetch(kLookedAtBytes));
  return timed::find_byte_order(words, header.endianness) == Encoding::kEvt21Little
             ? make_reader<Codec<Encoding::kEvt21Little>>(std::move(source), std::move(header), options)
             : make_reader<Codec<Encoding::kEvt21Legacy>>(std::move(source), std::move(header), options);
}

}  // namespace

Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(RawHeader header, read_raw_header(*source, options));
  if (header.info.format == "evt2.1") return open_evt21(std::move(source), std::move(header), options);
  if (header.info.format == "evt2") {
    return make_reader<timed::Codec<timed::Encoding::kEvt2>>(std::move(source), std::move(header), options);
  }
  if (header.info.format == "evt4") return evt4::make_reader(std::move(source), std::move(header.info), options);
  return make_reader<evt3::Codec>(std::move(source), std::move(header), options);
}

Result<WriterPtr> create_evt2(SinkPtr sink, const RecordingInfo& info) {
  return create_raw_writer<timed::Evt2Encoder>(std::move(sink), info);
}

Result<WriterPtr> create_evt21(SinkPtr sink, const RecordingInfo& info) {
  return create_raw_writer<timed::Evt21Encoder>(std::move(sink), info);
}

Result<WriterPtr> create_evt3(SinkPtr sink, const RecordingInfo& info) {
  return create_raw_writer<evt3::Encoder>(std::move(sink), info);
}

Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info) {
  if (info.format == "evt2") return create_evt2(std::move(sink), info);
  return info.format == "evt2.1" ? create_evt21(std::move(sink), info) : create_evt3(std::move(sink), info);
}

}  // namespace e2lf::recordings
