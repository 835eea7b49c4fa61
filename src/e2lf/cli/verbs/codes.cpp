// SPDX-License-Identifier: MIT
// e2lf codes: show; render, which writes the images for an aperture display; play (codes_play.cpp)
#include "e2lf/capture/patterns/codes.h"

#include <algorithm>
#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/display_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::ByteImage;
namespace {

Json codes_json(const capture::Codes& codes) {
  return {{"num_patterns", codes.num_patterns},
          {"views", {codes.views_y, codes.views_x}},
          {"black_first", capture::is_black_first(codes)},
          {"binary", capture::is_binary(codes)},
          {"light_efficiency", capture::light_efficiency(codes)}};
}

void print_codes(const capture::Codes& codes) {
  std::printf("%zu patterns of %zux%zu, %s, %s\n%s\nlight efficiency:", codes.num_patterns, codes.views_y,
              codes.views_x, capture::is_black_first(codes) ? "black first" : "NOT black first",
              capture::is_binary(codes) ? "binary" : "not binary", capture::codes_text(codes).c_str());
  for (const float efficiency : capture::light_efficiency(codes)) {
    std::printf(" %.1f %%", 100.0 * static_cast<double>(efficiency));
  }
  std::printf("\n");
}

int run_codes_show(const std::vector<std::string>& arguments) {
  Verb verb("codes show", "Show the aperture patterns of a model or a file of codes.", "e2lf codes show -m e2lf-n4");
  CodesSource source;
  std::filesystem::path output;
  add_codes_options(verb.app(), source);
  verb.app().add_option("-o,--output", output, "also write the patterns to this file (.json, .npy, .npz), for --codes");
  return verb.run(arguments, [&]() -> Result<void> {
    RunRecord record(verb);
    E2LF_ASSIGN_OR_RETURN(const pipeline::KnownCodes known, load_codes(source, record));
    if (!output.empty()) {
      E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(output, verb));
      E2LF_RETURN_IF_ERROR(capture::write_codes(file.path(), known.codes));
      E2LF_RETURN_IF_ERROR(file.commit());
    }
    if (verb.common().json) {
      std::printf("%s", json_text(codes_json(known.codes)).c_str());
    } else {
      print_codes(known.codes);
    }
    return {};
  });
}

struct RenderArguments {
  DisplayFlags display;
  fs::path output;
  unsigned bits = 8;
};

std::string file_of_frame(const cycles::Schedule& schedule, size_t number) {
  std::string name = schedule.patterns[number].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return cat("frame_", number < 10 ? "0" : "", number, "_", name, ".png");
}

/// Returns thumbnails of all frames in one image, in which flips and rotations can be checked.
ByteImage sheet_of(const std::vector<ByteImage>& frames) {
  constexpr size_t kColumns = 4, kWidth = 320, kGap = 4;
  const size_t height = std::max<size_t>(1, frames.front().height * kWidth / frames.front().width);
  const size_t columns = std::min(kColumns, frames.size()), rows = (frames.size() + columns - 1) / columns;
  ByteImage sheet(columns * (kWidth + kGap) - kGap, rows * (height + kGap) - kGap, 1);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), uint8_t{96});
  for (size_t i = 0; i < frames.size(); ++i) {
    const ByteImage& frame = frames[i];
    for (size_t y = 0; y < height; ++y) {
      const size_t to = (i / columns * (height + kGap) + y) * sheet.width + i % columns * (kWidth + kGap);
      for (size_t x = 0; x < kWidth; ++x) {
        sheet.pixels[to + x] = frame.pixels[y * frame.height / height * frame.width + x * frame.width / kWidth];
      }
    }
  }
  return sheet;
}

/// Returns the table for a program that controls the display: each frame with its start and its duration.
std::string csv_of(const cycles::Schedule& schedule) {
  std::string text = "index,file,name,begin_us,duration_us,event_image\n";
  int64_t begin_us = 0;
  for (size_t i = 0; i < schedule.size(); ++i) {
    const cycles::ScheduledPattern& pattern = schedule.patterns[i];
    text += cat(i, ',', file_of_frame(schedule, i), ',', csv_cell(pattern.name), ',', begin_us, ',',
                pattern.duration_us, ',', pattern.image ? std::to_string(*pattern.image) : "", '\n');
    begin_us += pattern.interval_us();
  }
  return text;
}

Result<void> check_depth(const RenderArguments& arguments, const capture::Codes& codes) {
  if (arguments.bits == 8 || capture::is_binary(codes)) return {};
  return fail(ErrorCode::kInvalidValue, "--bits",
              "the patterns contain values between 0 and 1, which one bit cannot represent; use 8");
}

Result<void> render(const RenderArguments& arguments, const Verb& verb) {
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const DisplaySequence sequence, display_sequence(arguments.display, record));
  E2LF_RETURN_IF_ERROR(check_depth(arguments, sequence.codes));
  const std::vector<ByteImage>& frames = sequence.frames;
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder, open_output_folder(arguments.output, verb));
  for (size_t i = 0; i < frames.size(); ++i) {
    E2LF_ASSIGN_OR_RETURN(const auto bytes, arguments.bits == 1 ? lightfield::encode_bilevel_png(frames[i])
                                                                : lightfield::encode_png(frames[i]));
    E2LF_RETURN_IF_ERROR(write_file(folder.path() / file_of_frame(sequence.schedule, i), bytes));
  }
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "schedule.json", cycles::schedule_text(sequence.schedule)));
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "schedule.csv", csv_of(sequence.schedule)));
  E2LF_RETURN_IF_ERROR(capture::write_codes(folder.path() / "codes.json", sequence.codes));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder.path() / "contact_sheet.png", sheet_of(frames)));
  record.end_step("render");
  E2LF_RETURN_IF_ERROR(commit(folder, record));
  if (!verb.common().quiet) {
    std::printf("%zu frames of %zux%zu px in %s: look at contact_sheet.png; schedule.json is for --schedule\n",
                frames.size(), frames.front().width, frames.front().height, arguments.output.c_str());
  }
  return {};
}

int run_codes_render(const std::vector<std::string>& arguments) {
  Verb verb("codes render", "Make the images that an aperture display shows, and their schedule.",
            "e2lf codes render -m e2lf-n4 -o out/display --flip-x --bits 1");
  RenderArguments render_arguments;
  CLI::App& app = verb.app();
  add_display_options(app, render_arguments.display);
  app.add_option("-o,--output", render_arguments.output, "folder to write")->required();
  app.add_option("--bits", render_arguments.bits, "bits per pixel: 1 or 8")
      ->check(CLI::IsMember({1, 8}))
      ->capture_default_str();
  return verb.run(arguments, [&] { return render(render_arguments, verb); });
}

}  // namespace

int run_codes(const std::vector<std::string>& arguments) {
  return run_subverb("codes",
                     {{"show", "print patterns, black-first check and light efficiency", run_codes_show},
                      {"render", "make the images and the schedule for an aperture display", run_codes_render},
                      {"play", "show the patterns on a display of this computer", run_codes_play}},
                     arguments);
}

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
