// SPDX-License-Identifier: MIT
#include "e2lf/model/summary.h"

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::model {
namespace {

Json codes_summary(const capture::Codes& codes) {
  Json efficiency = Json::array();
  for (const float share : capture::light_efficiency(codes)) efficiency.push_back(json_number(share));
  return {{"binary", capture::is_binary(codes)}, {"light_efficiency", std::move(efficiency)}};
}

}  // namespace

Json network_summary(const Network& network) {
  const size_t radius = receptive_radius(network);
  return {{"type", to_json(network)["type"]},
          {"layers", network.layers.size()},
          {"parameters", num_parameters(network)},
          {"macs_per_pixel", macs_per_pixel(network)},
          {"receptive_field_px", radius == kWholeImage ? Json() : Json(2 * radius + 1)},
          {"size_multiple_px", size_multiple(network)}};
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

}  // namespace e2lf::model
