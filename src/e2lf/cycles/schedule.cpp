// SPDX-License-Identifier: MIT
#include "e2lf/cycles/schedule.h"

#include <algorithm>

#include "e2lf/base/choice.h"
#include "e2lf/base/text.h"
#include "e2lf/files/options.h"

namespace e2lf::cycles {
namespace {

constexpr int64_t kPaperOverheadUs = 592;

constexpr Choice<BurstSign> kSigns[] = {{"any", BurstSign::kAny}, {"on", BurstSign::kOn}, {"off", BurstSign::kOff}};

}  // namespace

size_t Schedule::num_images() const {
  size_t count = 0;
  for (const ScheduledPattern& pattern : patterns) count += pattern.image.has_value();
  return count;
}

int64_t Schedule::cycle_us() const {
  int64_t sum_us = 0;
  for (const ScheduledPattern& pattern : patterns) sum_us += pattern.interval_us();
  return sum_us;
}

size_t Schedule::first_image_pattern() const {
  const auto is_first = [](const ScheduledPattern& pattern) { return pattern.image == size_t{0}; };
  return static_cast<size_t>(std::ranges::find_if(patterns, is_first) - patterns.begin());
}

size_t Schedule::first_of_cycle() const {
  const auto has_image = [](const ScheduledPattern& pattern) { return pattern.image.has_value(); };
  const auto first = std::ranges::find_if(patterns, has_image);
  return first == patterns.end() || first->image == size_t{0} ? 0 : first_image_pattern() % size();
}

Schedule paper_schedule(size_t num_codes) {
  E2LF_REQUIRE(num_codes >= 2, "a cycle needs two coding patterns at least");
  Schedule schedule;
  for (const bool inverse : {true, false}) {
    for (size_t i = 0; i < num_codes; ++i) {
      ScheduledPattern pattern;
      pattern.name = cat(inverse ? "inverse a" : "a", i + 1);
      pattern.duration_us = i == 0 ? 15000 : 10000;
      pattern.overhead_us = kPaperOverheadUs;
      if (!inverse && i > 0) pattern.image = i - 1;
      // a1 is black, so its inverse is white.
      if (i == 0) pattern.sign = inverse ? BurstSign::kOn : BurstSign::kOff;
      if (i == 1) pattern.sign = inverse ? BurstSign::kOff : BurstSign::kOn;
      schedule.patterns.push_back(pattern);
    }
  }
  return schedule;
}

Schedule plain_schedule(size_t num_codes, int64_t duration_us) {
  E2LF_REQUIRE(num_codes >= 2 && duration_us >= 1, "a cycle needs two patterns at least, shown for a time");
  Schedule schedule;
  for (size_t i = 0; i < num_codes; ++i) {
    ScheduledPattern pattern;
    pattern.name = cat("a", i + 1);
    pattern.duration_us = duration_us;
    if (i > 0) pattern.image = i - 1;
    schedule.patterns.push_back(pattern);
  }
  return schedule;
}

Schedule with_all_transitions(Schedule schedule) {
  const size_t first = schedule.first_image_pattern();
  for (size_t i = 0; i < schedule.size(); ++i) schedule.patterns[(first + i) % schedule.size()].image = i;
  return schedule;
}

Result<void> validate(const Schedule& schedule, const std::string& location) {
  constexpr int64_t kLongestUs = 1'800'000'000;
  const size_t first = schedule.first_of_cycle();
  size_t images = 0;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const ScheduledPattern& pattern = schedule.patterns[(first + i) % schedule.size()];
    if (std::max(pattern.duration_us, pattern.overhead_us) > kLongestUs) {
      return fail(ErrorCode::kInvalidValue, location, "pattern \"", pattern.name,
                  "\" lasts longer than half an hour; state its duration in us");
    }
    if (pattern.duration_us < 1 || pattern.overhead_us < 0) {
      return fail(ErrorCode::kInvalidValue, location, "pattern \"", pattern.name,
                  "\" is not shown for a positive time");
    }
    if (pattern.image && *pattern.image != images++) {
      return fail(ErrorCode::kInvalidValue, location, "images must be numbered 0, 1, ... in the order of the patterns");
    }
  }
  if (images > 0) return {};
  return fail(ErrorCode::kInvalidValue, location, "no pattern's events are used; give a pattern an \"image\"");
}

Result<Schedule> parse_schedule(const std::string& text, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const Json json, parse_json(text, name));
  if (json.contains(Json::json_pointer("/patterns/0/0"))) {
    return fail(ErrorCode::kInvalidValue, name,
                "the file contains patterns, not their times; give it as the patterns, and as the schedule the "
                "schedule.json that `e2lf codes render` writes beside the images of the patterns")
        .about("codes");
  }
  Schedule schedule;
  OptionReader reader(json, name + ": $");
  reader.list("patterns", schedule.patterns, [](ScheduledPattern& pattern, OptionReader& visit) {
    E2LF_VISIT(pattern, visit, name, duration_us, overhead_us, image);
    visit.choice("sign", pattern.sign, kSigns);
  });
  std::optional<std::string> views;
  const Json& codes = reader.read("views", views).child("codes");
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (views) {
    E2LF_ASSIGN_OR_RETURN(schedule.views, capture::orientation_from_name(*views, reader.child_location("views")));
  }
  if (!codes.is_null()) {
    E2LF_ASSIGN_OR_RETURN(schedule.codes, capture::codes_from_json(codes, cat(name, ": $.codes")));
  }
  E2LF_RETURN_IF_ERROR(validate(schedule, name));
  return schedule;
}

Result<Schedule> read_schedule(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_file(path));
  return parse_schedule(std::string(bytes.begin(), bytes.end()), path.string());
}

std::string schedule_text(const Schedule& schedule) {
  Json patterns = Json::array();
  for (const ScheduledPattern& pattern : schedule.patterns) {
    Json json = {{"name", pattern.name},
                 {"duration_us", pattern.duration_us},
                 {"overhead_us", pattern.overhead_us},
                 {"sign", word_of(pattern.sign, kSigns)}};
    if (pattern.image) json["image"] = *pattern.image;
    patterns.push_back(std::move(json));
  }
  Json json = {{"patterns", std::move(patterns)}};
  if (schedule.views) json["views"] = capture::orientation_name(*schedule.views);
  if (schedule.codes) json["codes"] = capture::codes_to_json(*schedule.codes);
  return json_text(json);
}

namespace {

Result<ShownPattern> shown_pattern(std::string name, size_t num_codes) {
  const std::string prefix = "inverse ";
  ShownPattern shown;
  shown.is_inverse = name.starts_with(prefix);
  std::string rest = shown.is_inverse ? name.substr(prefix.size()) : name;
  if (rest == "black") rest = "a1";
  const auto number = rest.starts_with('a') ? parse_number<size_t>(rest.substr(1)) : std::nullopt;
  if (number && *number >= 1 && *number <= num_codes) {
    shown.code = *number - 1;
    return shown;
  }
  return fail(ErrorCode::kInvalidValue, "", "the schedule's pattern \"", name,
              "\" is not one of the codes; call it a1 ... a", num_codes, ", or inverse a1 ... inverse a", num_codes);
}

}  // namespace

Result<std::vector<ShownPattern>> shown_patterns(const Schedule& schedule, size_t num_codes) {
  std::vector<ShownPattern> shown;
  for (const ScheduledPattern& pattern : schedule.patterns) {
    E2LF_ASSIGN_OR_RETURN(shown.emplace_back(), shown_pattern(pattern.name, num_codes));
  }
  const size_t images = schedule.num_images();
  if (shown.empty() || (images + 1 != num_codes && images != schedule.size())) {
    return fail(ErrorCode::kInvalidValue, "", "the schedule makes ", images, " event images, ", num_codes,
                " codes make ", num_codes - 1, "; use a schedule for these codes");
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
