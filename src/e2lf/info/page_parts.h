// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/marks.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/recordings/event_counters.h"
#include "e2lf/report/chart.h"
#include "e2lf/report/page.h"

/// Parts of pages that several reports share.
namespace e2lf::info {

/// Draws the event images of a cycle side by side: grey for no event, towards red for ON events, towards blue for OFF
/// events, with full colour at the 99 % quantile of the counts.
[[nodiscard]] lightfield::Image event_picture(const capture::EventImages& images);

/// Adds images to a page, each with its caption; images wider than `most_width` are reduced. Fails as encode_png()
/// does.
struct NamedImage {
  lightfield::Image image;
  std::string caption;
};
[[nodiscard]] Result<void> add_pictures(const std::vector<NamedImage>& images, size_t most_width, report::Page& page);

/// The marks and cycles that were found in a recording, for its chart.
struct FoundCycles {
  std::vector<cycles::Mark> marks;  ///< triggers or bursts
  std::vector<cycles::Cycle> cycles;
};

/// Returns a chart of the event rate over time in ms and million events/s, ON above the axis and OFF below, with a tick
/// for each mark, and with each cycle's number, confidence and shaded slices. Of a long recording, the first kMaxDrawn
/// marks and cycles are drawn.
[[nodiscard]] report::LineChart rate_chart(const recordings::EventRate& rate, const FoundCycles& found = {});
inline constexpr size_t kMaxDrawn = 2000;

}  // namespace e2lf::info
