// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/report.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

#include "e2lf/base/text.h"

namespace e2lf::calibrate {
namespace {

/// Text as printf writes it.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  std::array<char, 256> buffer;
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(buffer.data(), buffer.size(), pattern, arguments);
  va_end(arguments);
  return buffer.data();
}

size_t count(const Calibration& calibration, PixelState state) {
  return static_cast<size_t>(std::count(calibration.states.begin(), calibration.states.end(), state));
}

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += format("%6.2f", value);
  return text;
}

std::string constants_text(const Calibration& calibration) {
  std::string text = format("%-26s %10s   %s\n", "constant", "value", "95 % range");
  for (const Estimate& each : calibration.estimates) {
    text += format("%-26s %10.4g   ", each.key.c_str(), each.value);
    text += each.is_determined ? format("%.4g to %.4g\n", each.low, each.high) : "kept: the data do not determine it\n";
  }
  return text;
}

std::string agreement_text(const std::vector<Agreement>& agreements, bool with_place) {
  if (agreements.empty()) return "";
  const auto column = [&](const char* title, size_t entries) {
    const int width = static_cast<int>(6 * entries);
    return format("  %*s |%*s", width, title, width, "model");
  };
  const Moments& moments = agreements.front().measured;
  std::string text = with_place ? format("%6s %6s", "x", "y") : "";
  text += format("%7s %8s %6s %6s", "E1+E2", "samples", "TV", "chance");
  text += column("mean", moments.mean.size()) + column("deviation", moments.deviation.size()) +
          column("correlation", moments.correlation.size()) + "\n";
  for (const Agreement& each : agreements) {
    if (with_place) text += format("%6.2f %6.2f", each.x, each.y);
    text += format("%7.2f %8.0f %6.3f %6.3f", each.brightness, each.samples, each.total_variation, each.chance);
    const auto pair = [&](const std::vector<double>& measured, const std::vector<double>& simulated) {
      text += "  " + numbers(measured) + " |" + numbers(simulated);
    };
    pair(each.measured.mean, each.simulated.mean);
    pair(each.measured.deviation, each.simulated.deviation);
    pair(each.measured.correlation, each.simulated.correlation);
    text += "\n";
  }
  return text;
}

Json moments_json(const Moments& moments) {
  return {{"mean", moments.mean}, {"deviation", moments.deviation}, {"correlation", moments.correlation}};
}

Json agreements_json(const std::vector<Agreement>& agreements) {
  Json list = Json::array();
  for (const Agreement& each : agreements) {
    list.push_back({{"brightness", each.brightness},
                    {"x", each.x},
                    {"y", each.y},
                    {"samples", each.samples},
                    {"total_variation", each.total_variation},
                    {"chance", each.chance},
                    {"measured", moments_json(each.measured)},
                    {"simulated", moments_json(each.simulated)}});
  }
  return list;
}

double mean_total_variation(const AgreementReport& report) {
  double sum = 0.0;
  for (const Agreement& each : report.rows) sum += each.total_variation;
  return report.rows.empty() ? 0.0 : sum / static_cast<double>(report.rows.size());
}

}  // namespace

std::string report_text(const Calibration& calibration, bool with_places) {
  std::string text = constants_text(calibration);
  text +=
      format("\n%zu flat pixels; %zu hot and %zu dead of %zu\n\n", calibration.flat_pixels,
             count(calibration, PixelState::kHot), count(calibration, PixelState::kDead), calibration.states.size());
  text += agreement_text(calibration.agreement.rows, false);
  text += format("mean total variation %.3f (first guess: %.3f)\n", mean_total_variation(calibration.agreement),
                 mean_total_variation(calibration.first_agreement));
  if (with_places) text += "\n" + agreement_text(calibration.agreement.places, true);
  return text;
}

Json report_json(const Calibration& calibration) {
  Json constants = Json::array();
  for (const Estimate& each : calibration.estimates) {
    constants.push_back({{"key", each.key},
                         {"value", each.value},
                         {"low", each.low},
                         {"high", each.high},
                         {"is_determined", each.is_determined}});
  }
  return {{"constants", constants},
          {"warnings", calibration.warnings},
          {"pixels",
           {{"flat", calibration.flat_pixels},
            {"hot", count(calibration, PixelState::kHot)},
            {"dead", count(calibration, PixelState::kDead)},
            {"all", calibration.states.size()}}},
          {"rows", agreements_json(calibration.agreement.rows)},
          {"places", agreements_json(calibration.agreement.places)},
          {"first_guess", {{"rows", agreements_json(calibration.first_agreement.rows)}}}};
}

Json camera_json(const Calibration& calibration) {
  Json json = capture::to_json(calibration.camera);
  for (const Estimate& each : calibration.estimates) {
    if (!json["constants"].contains(each.key)) continue;
    json["constants"][each.key]["source"] = each.is_determined ? "e2lf calibrate" : "kept from the first guess";
  }
  if (json.contains("transmission")) json["transmission"]["source"] = "e2lf calibrate";
  return json;
}

}  // namespace e2lf::calibrate
