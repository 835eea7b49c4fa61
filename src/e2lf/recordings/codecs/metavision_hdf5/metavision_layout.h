// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/hdf5/library.h"
#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings::hdf5_events {

using e2lf::hdf5::DatasetShape, e2lf::hdf5::Handle, e2lf::hdf5::LibraryLock, e2lf::hdf5::open_dataset,
    e2lf::hdf5::read_elements;

inline constexpr H5Z_filter_t kEcfFilter = 0x8ECF;
inline constexpr uint64_t kChunkEvents = 16384;
inline constexpr int64_t kIndexPeriodUs = 2000;

/// Records as stored in the file; their padding is that of the compiler, as in the vendor's library.
struct EventRecord {
  uint16_t x = 0, y = 0;
  int16_t p = 0;
  int64_t t = 0;
};
struct TriggerRecord {
  int16_t p = 0;
  int64_t t = 0;
  int16_t id = 0;
};
struct IndexRecord {
  uint64_t id = 0;
  int64_t ts = 0;
};
static_assert(sizeof(EventRecord) == 16 && sizeof(TriggerRecord) == 24 && sizeof(IndexRecord) == 16);

/// Return the HDF5 compound types of the records.
[[nodiscard]] Handle event_type();
[[nodiscard]] Handle trigger_type();
[[nodiscard]] Handle index_type();

}  // namespace e2lf::recordings::hdf5_events
