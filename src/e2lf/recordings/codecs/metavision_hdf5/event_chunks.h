// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::hdf5_events {

/// Reads /CD/events in blocks. ECF chunks are fetched in their stored form and decoded here, several in parallel; all
/// others are decoded by the HDF5 library.
class EventChunks final : public EventBlocks {
 public:
  /// Opens the events. Fails as open_dataset() does, and with kMissingDependency for a filter that neither e2lf nor the
  /// library has.
  [[nodiscard]] static Result<BlocksPtr> open(hid_t file, const std::string& location, int threads);

  /// Reads the next block. A chunk that cannot be decoded is counted as kBadRecord and skipped. In a damaged chunk,
  /// events that are later than the first time of the next chunk are dropped (kTimeJump).
  [[nodiscard]] Result<bool> next(EventBatch& block, DecodeSummary& summary) override;

  /// Seeks to the last chunk whose first event is before t_us.
  [[nodiscard]] Result<void> seek_before(int64_t t_us) override;

 private:
  struct Chunk {
    uint64_t index = 0;
    size_t count = 0;  ///< expected number of events
    bool is_stored_raw = false;
    std::vector<uint8_t> bytes;
    std::optional<int64_t> first_us;  ///< empty if the chunk is too short to have one
    std::optional<Error> error;
  };

  [[nodiscard]] Result<Chunk> fetch(uint64_t index) const;
  [[nodiscard]] Result<std::vector<Chunk>> fetch_block();
  static void decode(Chunk& chunk, EventColumns& events, size_t begin);
  void decode_block(std::vector<Chunk>& chunks, const std::vector<size_t>& begins, EventColumns& events) const;
  void keep_believable(const Chunk& chunk, const Chunk* after, size_t begin, size_t end, EventColumns& events,
                       DecodeSummary& summary) const;
  [[nodiscard]] Result<bool> next_records(EventColumns& events);

  DatasetShape shape_;
  std::string location_;
  int threads_ = 1;
  bool is_direct_ = false;  ///< whether chunks are ECF or uncompressed records
  bool is_cut_untold_ = false;
  uint64_t next_event_ = 0;
  std::optional<Chunk> ahead_;  ///< fetched in advance for its first time
  std::vector<EventRecord> records_;
};

}  // namespace e2lf::recordings::hdf5_events
