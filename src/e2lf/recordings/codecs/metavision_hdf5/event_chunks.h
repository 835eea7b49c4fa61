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

/// Reads /CD/events block by block. ECF chunks are fetched as stored and decoded here, several at once; anything else
/// goes through the HDF5 library.
class EventChunks final : public EventBlocks {
 public:
  /// Fails like open_dataset, and with kMissingDependency for a filter that neither we nor the library have.
  [[nodiscard]] static Result<std::unique_ptr<EventBlocks>> open(hid_t file, const std::string& location, int threads);

  /// A chunk that cannot be decoded is counted as kBadRecord and skipped; of a damaged chunk, events later than the
  /// next chunk's first time are dropped (kTimeJump).
  [[nodiscard]] Result<bool> next(EventBatch& block, DecodeSummary& summary) override;

  /// Goes to the last chunk whose first event is before t_us.
  [[nodiscard]] Result<void> seek_before(int64_t t_us) override;

 private:
  struct Chunk {
    uint64_t index = 0;
    size_t count = 0;  ///< events it should hold
    bool is_stored_raw = false;
    std::vector<uint8_t> bytes;
    std::optional<int64_t> first_us;  ///< nothing when too short to have one
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
  bool is_direct_ = false;  ///< chunks are ECF or plain records
  bool is_cut_untold_ = false;
  uint64_t next_event_ = 0;
  std::optional<Chunk> ahead_;  ///< fetched to know its first time
  std::vector<EventRecord> records_;
};

}  // namespace e2lf::recordings::hdf5_events
