// SPDX-License-Identifier: MIT
#include "e2lf/cycles/shown_pattern.h"

#include <algorithm>
#include <charconv>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::cycles {
namespace {

Result<ShownPattern> shown_pattern(std::string name, size_t num_codes) {
  const std::string prefix = "inverse ";
  ShownPattern shown;
  shown.is_inverse = name.starts_with(prefix);
  std::string rest = shown.is_inverse ? name.substr(prefix.size()) : name;
  if (rest == "black") rest = "a1";
  size_t number = 0;
  const char* const end = rest.data() + rest.size();
  const bool is_code = rest.starts_with('a') && std::from_chars(rest.data() + 1, end, number).ptr == end;
  if (is_code && number >= 1 && number <= num_codes) {
    shown.code = number - 1;
    return shown;
  }
  return Error{ErrorCode::kInvalidValue,
               cat("the schedule's pattern \"", name, "\" is not one of the codes; call it a1 ... a", num_codes,
                   ", or inverse a1 ... inverse a", num_codes),
               ""};
}

}  // namespace

Result<std::vector<ShownPattern>> shown_patterns(const Schedule& schedule, size_t num_codes) {
  std::vector<ShownPattern> shown;
  for (const ScheduledPattern& pattern : schedule.patterns) {
    E2LF_ASSIGN_OR_RETURN(shown.emplace_back(), shown_pattern(pattern.name, num_codes));
  }
  const size_t images = schedule.num_images();
  if (shown.empty() || (images + 1 != num_codes && images != schedule.size())) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the schedule makes ", images, " event images, ", num_codes, " codes make ", num_codes - 1,
                     "; use a schedule for these codes"),
                 ""};
  }
  return shown;
}

std::optional<capture::Codes> codes_of_images(const capture::Codes& codes, const Schedule& schedule) {
  const capture::Codes shown_codes = capture::codes_of_whole_cycle(codes).value_or(codes);
  const size_t images = schedule.num_images(), size = schedule.size();
  if (images + 1 == shown_codes.num_patterns) return shown_codes;
  const auto shown = shown_patterns(schedule, shown_codes.num_patterns);
  if (!shown) return std::nullopt;
  const capture::Codes inverses = capture::complement(shown_codes);
  capture::Codes result(images + 1, codes.views_y, codes.views_x);
  // The first pattern is the one before that of the first image.
  for (size_t i = 0; i <= images; ++i) {
    const ShownPattern& pattern = (*shown)[(schedule.first_image_pattern() + size - 1 + i) % size];
    const auto values = (pattern.is_inverse ? inverses : shown_codes).pattern(pattern.code);
    std::copy(values.begin(), values.end(), result.pattern(i).begin());
  }
  return result;
}

Schedule paper_schedule_of(const capture::Codes& codes) {
  const auto shown = capture::codes_of_whole_cycle(codes);
  return shown ? with_all_transitions(paper_schedule(shown->num_patterns)) : paper_schedule(codes.num_patterns);
}

}  // namespace e2lf::cycles
