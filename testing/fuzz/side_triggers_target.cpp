// SPDX-License-Identifier: MIT
// The target of the side file of triggers: the input is one.
#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/side_triggers.h"
#include "require.h"
#include "testing/chunked_source.h"

namespace {

using namespace e2lf::recordings;

std::vector<Trigger> read(SourcePtr source) {
  const auto reader = std::make_unique<RecordingReader>(nullptr, RecordingInfo(), "triggers", OpenOptions(),
                                                        make_side_triggers(std::move(source)));
  const auto all = read_all(*reader);
  return all ? all->triggers : std::vector<Trigger>();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using e2lf::fuzz::require;
  const std::vector<Trigger> triggers = read(make_memory_source(std::span(data, size)));
  for (size_t i = 1; i < triggers.size(); ++i) require(triggers[i].t >= triggers[i - 1].t, "triggers are sorted");
  for (const Trigger& trigger : triggers) require(trigger.p <= 1, "an edge is 0 or 1");
  const auto live = read(
      std::make_unique<ChunkedSource>(std::vector<uint8_t>(data, data + size), std::vector<size_t>(), 1 + size % 300));
  require(live == triggers, "a live source gives the same triggers");
  return 0;
}
