// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"

#include <cstddef>

namespace e2lf::recordings::hdf5_events {

Handle event_type() {
  const LibraryLock lock;
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(EventRecord)), H5Tclose);
  H5Tinsert(type.get(), "x", offsetof(EventRecord, x), H5T_STD_U16LE);
  H5Tinsert(type.get(), "y", offsetof(EventRecord, y), H5T_STD_U16LE);
  H5Tinsert(type.get(), "p", offsetof(EventRecord, p), H5T_STD_I16LE);
  H5Tinsert(type.get(), "t", offsetof(EventRecord, t), H5T_STD_I64LE);
  return type;
}

Handle trigger_type() {
  const LibraryLock lock;
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(TriggerRecord)), H5Tclose);
  H5Tinsert(type.get(), "p", offsetof(TriggerRecord, p), H5T_STD_I16LE);
  H5Tinsert(type.get(), "t", offsetof(TriggerRecord, t), H5T_STD_I64LE);
  H5Tinsert(type.get(), "id", offsetof(TriggerRecord, id), H5T_STD_I16LE);
  return type;
}

Handle index_type() {
  const LibraryLock lock;
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(IndexRecord)), H5Tclose);
  H5Tinsert(type.get(), "id", offsetof(IndexRecord, id), H5T_STD_U64LE);
  H5Tinsert(type.get(), "ts", offsetof(IndexRecord, ts), H5T_STD_I64LE);
  return type;
}

void columns_from_records(const EventRecord* records, size_t count, EventColumns& events, size_t begin) {
  for (size_t i = 0; i < count; ++i) {
    const EventRecord& record = records[i];
    events.x[begin + i] = record.x;
    events.y[begin + i] = record.y;
    events.p[begin + i] = record.p > 0;
    events.t[begin + i] = record.t;
  }
}

}  // namespace e2lf::recordings::hdf5_events
