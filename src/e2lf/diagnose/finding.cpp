// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/finding.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/choice.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"

namespace e2lf::diagnose {
namespace {

constexpr Choice<Severity> kSeverities[] = {
    {"note", Severity::kNote}, {"warning", Severity::kWarning}, {"error", Severity::kError}};

std::string text_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

const char* severity_name(Severity severity) {
  return word_of(severity, kSeverities);
}

Finding Finding::about(std::string name) && {
  option = std::move(name);
  return std::move(*this);
}

bool contains(const Findings& findings, const std::string& code) {
  return std::ranges::any_of(findings, [&](const Finding& finding) { return finding.code == code; });
}

bool has_doubt(const Findings& findings) {
  return std::ranges::any_of(findings, [](const Finding& finding) { return finding.severity != Severity::kNote; });
}

std::string text_of(const Finding& finding) {
  return cat(finding.code, ": ", finding.message, "; ", finding.remedy, option_hint(finding.option));
}

void log_findings(const std::string& name, const Findings& findings) {
  for (const Finding& finding : findings) {
    const std::string text = cat(name, ": ", text_of(finding));
    finding.severity == Severity::kNote ? log_info(text) : log_warning(text);
  }
}

Json to_json(const Findings& findings) {
  Json json = Json::array();
  for (const Finding& finding : findings) {
    json.push_back({{"code", finding.code},
                    {"severity", severity_name(finding.severity)},
                    {"message", finding.message},
                    {"remedy", finding.remedy},
                    {"option", finding.option},
                    {"figures", finding.figures}});
  }
  return json;
}

Findings findings_from_text(const std::string& text) {
  Findings findings;
  const Json json = parse_json(text, "findings").value_or(Json());
  for (const Json& each : json.is_array() ? json : Json::array()) {
    if (!each.is_object()) continue;
    Finding finding{
        .code = text_at(each, "code"), .message = text_at(each, "message"), .remedy = text_at(each, "remedy")};
    finding.severity = choice_of(text_at(each, "severity"), kSeverities).value_or(Severity::kWarning);
    finding.figures = each.value("figures", Json());
    finding.option = text_at(each, "option");
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace e2lf::diagnose
