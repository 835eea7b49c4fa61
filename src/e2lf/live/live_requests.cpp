// SPDX-License-Identifier: MIT
#include "e2lf/live/live_requests.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_picture.h"

namespace e2lf::live {
namespace {

template <typename T>
std::optional<T> number(const Parameters& parameters, const std::string& name) {
  const auto found = parameters.find(name);
  if (found == parameters.end()) return std::nullopt;
  const auto value = parse_number<T>(found->second);
  if constexpr (std::is_floating_point_v<T>) {
    if (value && !std::isfinite(*value)) return std::nullopt;
  }
  return value;
}

void append(const lightfield::ByteImage& image, std::string& body) {
  body.append(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size());
}

Response framed(const Json& header, std::initializer_list<const lightfield::ByteImage*> images) {
  const std::string text = header.dump();
  Response answer{200, "application/octet-stream", {}};
  for (int byte = 0; byte < 4; ++byte) answer.body += static_cast<char>(text.size() >> (8 * byte) & 0xFFU);
  answer.body += text;
  for (const lightfield::ByteImage* image : images) append(*image, answer.body);
  return answer;
}

RenderSettings settings_of(const Parameters& parameters) {
  RenderSettings settings;
  settings.x = number<float>(parameters, "x").value_or(settings.x);
  settings.y = number<float>(parameters, "y").value_or(settings.y);
  settings.focus = number<float>(parameters, "focus").value_or(settings.focus);
  settings.radius = number<float>(parameters, "radius").value_or(settings.radius);
  settings.row = number<uint32_t>(parameters, "row");
  settings.column = number<uint32_t>(parameters, "column");
  return settings;
}

/// Adds to the header of a picture or a map of which cycle it is, and sends it with the images.
Response framed(Json header, const FieldReport& field, std::initializer_list<const lightfield::ByteImage*> images) {
  header.update({{"cycle", field.cycle},
                 {"cycles", field.cycles},
                 {"fused_cycles", field.fused_cycles},
                 {"size", size_name(field.level.size)},
                 {"latency_s", field.latency_s},
                 {"reconstruct_s", field.reconstruct_s}});
  return framed(header, images);
}

Response picture(Session& session, const Parameters& parameters) {
  constexpr std::chrono::milliseconds kPatience{250};
  const auto shown =
      session.picture(settings_of(parameters), number<uint64_t>(parameters, "after").value_or(0), kPatience);
  if (!shown) return {204, "text/plain", ""};
  const Picture& seen = shown->picture;
  return framed({{"serial", shown->serial},
                 {"width", seen.image.width},
                 {"height", seen.image.height},
                 {"row_epi", {seen.row_epi.width, seen.row_epi.height}},
                 {"column_epi", {seen.column_epi.width, seen.column_epi.height}},
                 {"field", shown->field.serial}},
                shown->field, {&seen.image, &seen.row_epi, &seen.column_epi});
}

/// Appends disparities as the page reads them.
void append_disparities(const lightfield::Image& disparity, std::string& body) {
  constexpr int kUnknown = -32768;
  for (const float value : disparity.pixels) {
    const float milli = std::clamp(1000.0F * value, -32767.0F, 32767.0F);
    const auto bits = static_cast<unsigned>(std::isfinite(value) ? static_cast<int>(std::lround(milli)) : kUnknown);
    body += static_cast<char>(bits & 0xFFU);
    body += static_cast<char>(bits >> 8U & 0xFFU);
  }
}

Response depth_map(Session& session, const Parameters& parameters) {
  constexpr std::chrono::milliseconds kPatience{250};
  const auto shown = session.depth(number<uint64_t>(parameters, "after").value_or(0), kPatience);
  if (!shown) return {204, "text/plain", ""};
  const depth::DisparityRange range = depth::shown_range(shown->disparity, shown->confidence);
  Response answer = framed({{"serial", shown->field.serial},
                            {"width", shown->disparity.width},
                            {"height", shown->disparity.height},
                            {"range", {range.least, range.most}},
                            {"view", {session.model().views_y / 2, session.model().views_x / 2}}},
                           shown->field, {});
  append_disparities(shown->disparity, answer.body);
  append(lightfield::to_bytes(shown->confidence), answer.body);
  append(lightfield::to_bytes(shown->picture), answer.body);
  return answer;
}

Response fused(Session& session) {
  const auto cycles = session.fused_cycles();
  if (!cycles) return {204, "text/plain", ""};
  // The number of an exponential mean reaches almost twice that of a mean over as many cycles.
  const size_t most = 2 * session.reader().most_fused() - 1;
  return framed({{"width", cycles->width}, {"height", cycles->height}, {"most", most}}, {&*cycles});
}

Response events(Session& session) {
  const auto seen = session.reader().preview().take();
  if (!seen) return {204, "text/plain", ""};
  Json header = {{"width", seen->image.width},
                 {"height", seen->image.height},
                 {"events", seen->events},
                 {"sharpness", seen->sharpness}};
  if (seen->cycle) {
    header["cycle"] = seen->cycle->number;
    header["cycle_sharpness"] = seen->cycle->sharpness;
  }
  return framed(header, {&seen->image});
}

Response disparity(Session& session, const Parameters& parameters) {
  const auto place = [&](const char* name) { return number<float>(parameters, name).value_or(0.0F); };
  const auto found = session.disparity_at(place("x"), place("y"));
  if (!found) return {204, "text/plain", ""};
  return {200, "application/json", Json{{"disparity", *found}}.dump()};
}

Response refuse(const Error& error) {
  return {409, "text/plain", error.text()};
}

std::optional<Response> command(Session& session, const std::string& name, const Parameters& parameters) {
  if (name == "record") {
    Recorder& recorder = session.reader().recorder();
    const bool is_on = number<int>(parameters, "on").value_or(0) != 0;
    if (const auto done = is_on ? recorder.begin() : recorder.end(); !done) return refuse(done.error());
  } else if (name == "average") {
    const size_t cycles = number<size_t>(parameters, "cycles").value_or(1);
    session.reader().set_average(std::clamp<size_t>(cycles, 1, kMostCycles));
  } else if (name == "fuse") {
    session.reader().set_fusing(number<int>(parameters, "on").value_or(0) != 0);
  } else if (name == "size") {
    const auto to = parameters.find("to");
    const auto size = choice_of(to == parameters.end() ? "" : to->second, kPictureSizes, "size", "size");
    if (!size) return refuse(size.error());
    session.set_size(*size);
  } else if (name == "brightness") {
    session.measure_tone();
  } else {
    return std::nullopt;
  }
  return Response();
}

}  // namespace

std::optional<Response> answer(Session& session, bool is_command, const std::string& name,
                               const Parameters& parameters) {
  if (is_command) return command(session, name, parameters);
  if (name == "picture") return picture(session, parameters);
  if (name == "depth") return depth_map(session, parameters);
  if (name == "fused") return fused(session);
  if (name == "events") return events(session);
  if (name == "disparity") return disparity(session, parameters);
  return std::nullopt;
}

Json statistics(Session& session) {
  Json json = session.json();
  json["recording"] = session.reader().recorder().json();
  return json;
}

}  // namespace e2lf::live
