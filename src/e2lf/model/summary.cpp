// SPDX-License-Identifier: MIT
#include "e2lf/model/summary.h"

#include <algorithm>
#include <optional>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

/// Returns nothing if the receptive field is the whole image.
std::optional<size_t> receptive_field_px(const Network& network) {
  const size_t radius = receptive_radius(network);
  return radius == kWholeImage ? std::nullopt : std::optional(2 * radius + 1);
}

Json codes_summary(const capture::Codes& codes) {
  Json efficiency = Json::array();
  for (const float share : capture::light_efficiency(codes)) efficiency.push_back(json_number(share));
  return {{"binary", capture::is_binary(codes)}, {"light_efficiency", std::move(efficiency)}};
}

/// Formats a number as "948,352".
std::string grouped(size_t number) {
  std::string text = std::to_string(number);
  for (size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

}  // namespace

Json network_summary(const Network& network) {
  const auto field_px = receptive_field_px(network);
  return {{"type", to_json(network)["type"]},
          {"layers", network.layers.size()},
          {"parameters", num_parameters(network)},
          {"macs_per_pixel", macs_per_pixel(network)},
          {"receptive_field_px", field_px ? Json(*field_px) : Json()},
          {"size_multiple_px", size_multiple(network)}};
}

void append_field(std::string& text, std::string label, const std::string& value) {
  label.resize(18, ' ');
  text += label + value + '\n';
}

void append_network(std::string& text, const Network& network) {
  const auto field_px = receptive_field_px(network);
  append_field(text, "network",
               cat(network.layers.size(), " layers, ", grouped(num_parameters(network)), " parameters"));
  append_field(text, "multiply-adds",
               cat(grouped(static_cast<size_t>(macs_per_pixel(network))), " per pixel",
                   field_px ? "" : ", without those of pairs of pixels"));
  append_field(text, "receptive field", field_px ? cat(*field_px, " x ", *field_px, " px") : "the whole image");
}

void append_origin(std::string& text, const Json& provenance) {
  append_field(text, "provenance", provenance.empty() ? "none" : "as follows");
  for (const auto& [key, value] : provenance.items()) {
    append_field(text, "  " + key, value.is_string() ? value.get<std::string>() : json_line(value));
  }
}

Json summary_json(const Model& model) {
  Json json = header_to_json(model);
  json["measurement"] = capture::measurement_name(model.measurement());
  json["network"] = network_summary(model.network);
  json["codes"] = model.codes ? codes_summary(*model.codes) : Json();
  // The provenance comes last.
  json.erase("provenance");
  json["provenance"] = model.provenance;
  return json;
}

std::string summary_text(const Model& model) {
  const capture::SensorConstants& constants = model.constants;
  std::vector<std::string> inputs;
  for (const InputGroup& group : model.input) inputs.push_back(cat(group.scale, " * ", input_kind_name(group.kind)));

  std::string text;
  append_field(text, "name", model.name);
  append_field(text, "patterns", cat(model.num_patterns, model.black_first ? ", black first" : ""));
  append_field(text, "views", cat(model.views_y, " x ", model.views_x));
  append_field(text, "measurement", capture::measurement_name(model.measurement()));
  append_field(text, "event model", model.event_model);
  append_field(text, "constants",
               cat("eps ", constants.eps, ", tau ", constants.tau, ", sigma_w ", constants.sigma_w, ", sigma_z ",
                   constants.sigma_z));
  append_field(text, "input", join(inputs));
  append_network(text, model.network);
  const auto& [bfloat16_db, int16_db] = model.precision_loss;
  append_field(text, "loss of precision",
               cat("bfloat16 ", bfloat16_db ? cat(*bfloat16_db, " dB") : "not checked", ", int16 ",
                   int16_db ? cat(*int16_db, " dB") : "not checked"));
  append_origin(text, model.provenance);
  append_field(text, "codes", model.codes ? "as follows, each with its light efficiency" : "none");
  if (model.codes) text += '\n' + capture::codes_text(*model.codes);
  return text;
}

}  // namespace e2lf::model
