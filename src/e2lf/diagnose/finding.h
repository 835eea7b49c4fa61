// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

/// What may be wrong with a rig: judgements of what the pipeline produced, each with its remedy.
namespace e2lf::diagnose {

enum class Severity {
  kNote,     ///< the result is probably right; the user should know about an assumption
  kWarning,  ///< the result is doubtful
  kError,    ///< the result is wrong
};
[[nodiscard]] const char* severity_name(Severity severity);  ///< "note", "warning", "error"

/// One judgement about a rig or its recording.
struct Finding {
  std::string code;  ///< a stable name, such as "polarity-inverted"; docs/recordings.md lists them
  Severity severity = Severity::kWarning;
  std::string message;      ///< what was found, with its figures, without a full stop
  std::string remedy;       ///< what to do about it
  Json figures = {};        ///< the figures of the message for programs
  std::string option = {};  ///< the name of the option that remedies it, such as "invert_polarity", or empty

  /// Returns this finding about an option.
  [[nodiscard]] Finding about(std::string name) &&;
};
using Findings = std::vector<Finding>;

/// Returns true if a finding has this code.
[[nodiscard]] bool contains(const Findings& findings, const std::string& code);
/// Returns true if a finding is a warning or an error.
[[nodiscard]] bool has_doubt(const Findings& findings);

/// Returns "code: message; remedy (option)".
[[nodiscard]] std::string text_of(const Finding& finding);

/// Logs each finding as "name: code: message; remedy".
void log_findings(const std::string& name, const Findings& findings);

/// Converts findings to [{"code", "severity", "message", "remedy", "option", "figures"}, ...].
[[nodiscard]] Json to_json(const Findings& findings);
/// Converts the text of this JSON back, as capture::RecordedSetup::findings stores it, and ignores what is not of this
/// form.
[[nodiscard]] Findings findings_from_text(const std::string& text);

}  // namespace e2lf::diagnose
