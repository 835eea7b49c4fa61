// custom_codec FILE.bin OUT.raw
// Adds an event format and converts a file of this format to a RAW recording. The format consists of little-endian
// records of 12 bytes: t in us (8 bytes), x (2), and y with the polarity in its upper bit (2).
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <e2lf/recordings/convert.h>
#include <e2lf/recordings/event_blocks.h>
#include <e2lf/recordings/open/registry.h>

namespace {

using namespace e2lf;
using namespace e2lf::recordings;

constexpr size_t kRecordBytes = 12, kBlockRecords = 4096;

/// Reads blocks of records. RecordingReader adds batches, the order of time and the check of the coordinates.
class Records final : public EventBlocks {
 public:
  explicit Records(SourcePtr source) : source_(std::move(source)) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    // A live source would wait until a whole block has arrived.
    const size_t wanted = source_->seekable() ? kBlockRecords * kRecordBytes : kRecordBytes;
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(wanted));
    const size_t records = std::min(bytes.size() / kRecordBytes, kBlockRecords);
    for (size_t i = 0; i < records; ++i) {
      const uint8_t* record = bytes.data() + i * kRecordBytes;
      int64_t t_us = 0;
      uint16_t x = 0, y = 0;
      std::memcpy(&t_us, record, 8);
      std::memcpy(&x, record + 8, 2);
      std::memcpy(&y, record + 10, 2);
      block.events.push_back({x, static_cast<uint16_t>(y & 0x7FFF), static_cast<uint8_t>(y >> 15), t_us});
    }
    if (records == 0 && !bytes.empty()) summary.add(Violation::kTruncated, source_->position());
    source_->consume(records * kRecordBytes);
    return records > 0;
  }

  Result<void> seek_before(int64_t) override { return source_->seek(0); }

 private:
  SourcePtr source_;
};

Result<std::unique_ptr<RecordingReader>> open_records(SourcePtr source, const OpenOptions& options) {
  const RecordingInfo info = {.format = "records", .width = 640, .height = 480, .header = {}};
  const std::string name = source->name();
  return std::make_unique<RecordingReader>(std::make_unique<Records>(std::move(source)), info, name, options);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  Codec codec;
  codec.name = "records";
  codec.extensions = {".bin"};
  codec.open = open_records;
  add_codec(codec);
  const auto reader = open_recording(arguments[1]);
  const auto report = reader ? convert_recording(**reader, arguments[2]) : Result<ConvertReport>(reader.error());
  if (!report) {
    std::fprintf(stderr, "%s\n", report.error().text().c_str());
    return 1;
  }
  std::printf("%llu events\n", static_cast<unsigned long long>(report->events));
  return 0;
}
