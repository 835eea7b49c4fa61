// SPDX-License-Identifier: MIT
// Reads Metavision HDF5; declared in codecs.h.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstring>

#include "e2lf/base/text.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::hdf5_events {
namespace {

constexpr uint64_t kTriggerBlock = 4096;

class TriggerDataset final : public TriggerSource {
 public:
  TriggerDataset(DatasetShape shape, std::string location) : shape_(std::move(shape)), location_(std::move(location)) {}

  Result<bool> next(std::vector<Trigger>& block, DecodeSummary&) override {
    const uint64_t count = std::min(kTriggerBlock, shape_.length - next_);
    if (count == 0) return false;
    records_.resize(count);
    E2LF_RETURN_IF_ERROR(read_elements(shape_, trigger_type().get(), next_, count, records_.data(), location_));
    for (const TriggerRecord& record : records_) {
      block.push_back({record.t, static_cast<uint16_t>(record.id), static_cast<uint8_t>(record.p > 0)});
    }
    next_ += count;
    return true;
  }

  Result<void> rewind() override {
    next_ = 0;
    return {};
  }

 private:
  DatasetShape shape_;
  std::string location_;
  uint64_t next_ = 0;
  std::vector<TriggerRecord> records_;
};

/// "1280x720".
void parse_geometry(const std::string& text, RecordingInfo& info) {
  size_t width = 0, height = 0;
  const char* const end = text.data() + text.size();
  const auto [after_width, width_error] = std::from_chars(text.data(), end, width);
  if (width_error != std::errc() || after_width == end || *after_width != 'x') return;
  if (std::from_chars(after_width + 1, end, height).ec != std::errc()) return;
  if (width == 0 || height == 0 || width > 65536 || height > 65536) return;
  info.width = width;
  info.height = height;
}

RecordingInfo read_info(hid_t file) {
  RecordingInfo info{.format = "hdf5"};
  info.header = read_text_attributes(file);
  parse_geometry(info.find("geometry").value_or(""), info);
  return info;
}

std::atomic<OpenLayout>& other_layout() {
  static std::atomic<OpenLayout> layout = nullptr;
  return layout;
}

}  // namespace

void add_layout(OpenLayout open) {
  other_layout() = open;
}

bool detect(std::span<const uint8_t> head) {
  constexpr uint8_t kMagic[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
  // MATLAB files begin with another text.
  for (const size_t begin : {size_t{0}, size_t{512}, size_t{1024}, size_t{2048}}) {
    const bool has_room = head.size() >= begin + sizeof(kMagic);
    if (has_room && std::memcmp(head.data() + begin, kMagic, sizeof(kMagic)) == 0) return true;
  }
  return false;
}

Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options) {
  const LibraryLock lock;
  const std::string name = source->name();
  // The data sets keep the file open.
  E2LF_ASSIGN_OR_RETURN(const Handle file, open_file(*source));
  RecordingInfo info = read_info(file.get());
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));

  if (H5Lexists(file.get(), "CD", H5P_DEFAULT) <= 0) {
    if (const OpenLayout open_other = other_layout()) return open_other(file.get(), std::move(info), *source, options);
    return Error{ErrorCode::kNotFound, "the file has no events in CD/events (Metavision); check what it contains",
                 name};
  }
  E2LF_RETURN_IF_ERROR(refuse_table_options(options, "hdf5", name));
  E2LF_ASSIGN_OR_RETURN(BlocksPtr blocks, open_event_chunks(file.get(), name, options.threads));
  TriggersPtr triggers;
  if (auto shape = open_dataset(file.get(), "EXT_TRIGGER/events", name)) {
    triggers = std::make_unique<TriggerDataset>(*std::move(shape), name + ": EXT_TRIGGER/events");
  }
  return make_block_reader(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

Result<void> recover(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(path));
  E2LF_ASSIGN_OR_RETURN(const auto reader, open(std::move(source), {}));
  EventBatch batch;
  E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
  if (more) return {};
  return Error{ErrorCode::kFormat, "no event was written before the end; record to .raw", path.string()};
}

}  // namespace e2lf::recordings::hdf5_events
