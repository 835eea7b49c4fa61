// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/table_reader.h"

#include "e2lf/recordings/lone_events.h"
#include "e2lf/recordings/table/wrapped_times.h"
#include "e2lf/recordings/time_sort.h"

namespace e2lf::recordings::table {

std::unique_ptr<RecordingReader> make_table_reader(std::unique_ptr<EventBlocks> blocks, TimeUnit unit, bool is_seekable,
                                                   RecordingInfo info, const std::string& name,
                                                   const OpenOptions& options, TriggerFeed triggers) {
  blocks = make_unwrapped(std::move(blocks), unit);
  blocks = make_time_sorted(std::move(blocks), is_seekable, name);
  blocks = make_lone_events_told(std::move(blocks), name, options);
  return make_block_reader(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings::table
