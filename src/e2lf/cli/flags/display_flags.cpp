// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/display_flags.h"

#include "e2lf/program/option_values.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {

void add_display_options(CLI::App& app, DisplayFlags& flags) {
  capture::DisplayLayout& layout = flags.layout;
  add_codes_options(app, flags.codes);
  const OptionGroup group(app, kDisplayOptions);
  app.add_option("--width", layout.width_px, "width of the display, px")->capture_default_str();
  app.add_option("--height", layout.height_px, "height of the display, px")->capture_default_str();
  app.add_option("--cell", layout.cell_px, "width and height of an aperture cell, px")->capture_default_str();
  app.add_option("--offset-x", layout.offset_x_px, "offset of the aperture from the centre to the right, px");
  app.add_option("--offset-y", layout.offset_y_px, "offset of the aperture from the centre downwards, px");
  app.add_option("--rotate", flags.rotation_deg, "rotation of the patterns, clockwise, degrees")
      ->check(CLI::IsMember({0, 90, 180, 270}))
      ->capture_default_str();
  app.add_flag("--flip-x", layout.flip_x, "mirror the patterns left to right, before the rotation");
  app.add_flag("--flip-y", layout.flip_y, "mirror the patterns top to bottom, before the rotation");
  app.add_flag("--no-inverses", flags.no_inverses, "omit the inverse patterns that the paper's display needs");
  add_count(app, "--duration-us", flags.duration_us, 1, INT64_MAX, "duration of each pattern, with --no-inverses");
}

Result<DisplaySequence> display_sequence(const DisplayFlags& flags, RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(const pipeline::KnownCodes known, load_codes(flags.codes, record));
  DisplaySequence sequence;
  sequence.codes = capture::codes_of_whole_cycle(known.codes).value_or(known.codes);
  // The inverses come first, as the paper's display requires.
  std::vector<capture::Codes> parts = {sequence.codes};
  if (flags.no_inverses) {
    sequence.schedule = cycles::plain_schedule(sequence.codes.num_patterns, flags.duration_us);
  } else {
    sequence.schedule = cycles::paper_schedule(sequence.codes.num_patterns);
    parts.insert(parts.begin(), capture::complement(sequence.codes));
  }
  sequence.schedule.codes = sequence.codes;
  capture::DisplayLayout layout = flags.layout;
  layout.quarter_turns = flags.rotation_deg / 90;
  for (const capture::Codes& part : parts) {
    for (size_t n = 0; n < part.num_patterns; ++n) {
      E2LF_ASSIGN_OR_RETURN(capture::DisplayFrame frame, capture::render_pattern(part, n, layout));
      lightfield::ByteImage picture(frame.width_px, frame.height_px, 1);
      picture.pixels = std::move(frame.pixels);
      sequence.frames.push_back(std::move(picture));
    }
  }
  return sequence;
}

}  // namespace e2lf::cli
