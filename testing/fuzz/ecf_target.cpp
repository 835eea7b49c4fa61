// SPDX-License-Identifier: MIT
// The target of ECF: the input is a compressed chunk of events.
#include <vector>

#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"
#include "e2lf/recordings/event.h"
#include "require.h"

namespace {

using e2lf::recordings::EventColumns;
namespace ecf = e2lf::recordings::ecf;

e2lf::Result<EventColumns> decode(std::span<const uint8_t> chunk) {
  E2LF_ASSIGN_OR_RETURN(const size_t count, ecf::event_count(chunk));
  EventColumns events;
  events.resize(count);
  E2LF_RETURN_IF_ERROR(ecf::decode(chunk, {events.x, events.y, events.p, events.t}));
  return events;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto events = decode({data, size});
  if (!events || events->empty()) return 0;
  using e2lf::fuzz::require;
  for (size_t i = 0; i < events->size(); ++i) {
    require(events->p[i] <= 1 && events->t[i] >= 0, "polarities are 0 or 1 and times are not negative");
    require(i == 0 || events->t[i] >= events->t[i - 1], "time never runs backwards");
  }
  const ecf::ChunkColumns columns = {events->x, events->y, events->p, events->t};
  if (!ecf::can_encode(columns)) return 0;
  std::vector<uint8_t> again(ecf::max_encoded_size(events->size()));
  again.resize(ecf::encode(columns, again));
  const auto back = decode(again);
  require(back.ok() && *back == *events, "events come back as encoded");
  return 0;
}
