// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/cycle_input.h"

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/file_kind.h"

namespace e2lf::cli {

Error by_flag(Error error, const std::filesystem::path& input) {
  constexpr std::pair<const char*, const char*> kFlags[] = {{"", nullptr},
                                                            {"camera", "--camera"},
                                                            {"cycles", "--cycles-per-field"},
                                                            {"invert_polarity", "--invert-polarity"},
                                                            {"max_cycles", "--max-cycles"},
                                                            {"passes", "--passes"}};
  for (const auto& [option, flag] : kFlags) {
    if (error.location != option) continue;
    error.location = flag != nullptr ? flag : input.string();
    const size_t it = flag != nullptr ? error.message.find("leave it out") : std::string::npos;
    if (it != std::string::npos) error.message.replace(it, 12, cat("leave ", flag, " out"));
    break;
  }
  return error;
}

Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                              size_t cycles_per_field, const Verb& verb, ConfidenceWatch& confidence) {
  pipeline::CycleInputOptions options{.cycles_per_field = cycles_per_field,
                                      .max_cycles = flags.max_cycles,
                                      .is_strict = flags.recording.is_strict,
                                      .invert_polarity = flags.invert_polarity};
  options.on_cycle = [&confidence](const cycles::Cycle& cycle, cycles::CycleSource source) {
    confidence.add(cycle, source);
  };
  const auto named = [&](Result<pipeline::CycleInput> opened) -> Result<pipeline::CycleInput> {
    if (!opened) return by_flag(opened.error(), input);
    return opened;
  };
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(input));
  if (kind == FileKind::kRecording) {
    E2LF_ASSIGN_OR_RETURN(cycles::CycleReader reader, open_cycles(input, flags));
    return named(pipeline::CycleInput::create(std::move(reader), std::move(options)));
  }
  if (kind != FileKind::kEventImages && kind != FileKind::kImages) {
    return other_kind_error(input, kind, "a recording or event images");
  }
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kCycleOptions, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(capture::MeasurementFile file, capture::read_measurements(input));
  return named(pipeline::CycleInput::create(std::move(file), std::move(options)));
}

CycleFlags wanted_cycles(CycleFlags flags, const pipeline::MethodChoice& choice) {
  if (choice.model) {
    flags.num_wanted = choice.model->num_patterns;
  } else if (choice.codes) {
    flags.num_wanted = choice.codes->num_patterns;
  }
  const auto codes = choice.codes || !choice.model ? choice.codes : choice.model->codes;
  if (codes && codes->num_patterns >= 2) {
    flags.usual_patterns = capture::codes_of_whole_cycle(*codes).value_or(*codes).num_patterns;
  }
  return flags;
}

}  // namespace e2lf::cli
