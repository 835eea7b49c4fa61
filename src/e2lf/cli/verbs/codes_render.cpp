// SPDX-License-Identifier: MIT
// e2lf codes render: images for an aperture display
#include <algorithm>
#include <cstdio>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/capture/patterns/display.h"
#include "e2lf/capture/patterns/whole_cycle.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/formats/bitmap.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::BitDepth;
using lightfield::ByteImage;
namespace {

struct RenderArguments {
  CodesSource codes;
  fs::path output;
  capture::DisplayLayout layout;
  unsigned rotation_deg = 0;
  std::string format = "png";
  unsigned bits = 8;
  bool no_inverses = false;
  int64_t duration_us = 10000;
};

/// One image of a cycle, in the order of the schedule.
struct NamedFrame {
  std::string file;
  ByteImage picture;
};

/// The patterns of the schedule, preceded by their inverses as the paper's display requires, unless inverses are
/// omitted.
struct Sequence {
  cycles::Schedule schedule;
  std::vector<capture::Codes> parts;  ///< one after another
};

Sequence sequence_of(const RenderArguments& arguments, const capture::Codes& codes) {
  if (arguments.no_inverses) return {cycles::plain_schedule(codes.num_patterns, arguments.duration_us), {codes}};
  return {cycles::paper_schedule(codes.num_patterns), {capture::complement(codes), codes}};
}

Result<std::vector<NamedFrame>> render_frames(const RenderArguments& arguments, const Sequence& sequence) {
  std::vector<NamedFrame> frames;
  for (const capture::Codes& part : sequence.parts) {
    for (size_t n = 0; n < part.num_patterns; ++n) {
      E2LF_ASSIGN_OR_RETURN(capture::DisplayFrame frame, capture::render_pattern(part, n, arguments.layout));
      std::string name = sequence.schedule.patterns[frames.size()].name;
      std::replace(name.begin(), name.end(), ' ', '_');
      ByteImage picture(frame.width_px, frame.height_px, 1);
      picture.pixels = std::move(frame.pixels);
      frames.push_back({cat("frame_", frames.size() < 10 ? "0" : "", frames.size(), "_", name, ".", arguments.format),
                        std::move(picture)});
    }
  }
  return frames;
}

/// Returns a sheet with all frames side by side, which shows whether flips and rotations are correct.
ByteImage sheet_of(const std::vector<NamedFrame>& frames) {
  constexpr size_t kColumns = 4, kWidth = 320, kGap = 4;
  const ByteImage& first = frames.front().picture;
  const size_t height = std::max<size_t>(1, first.height * kWidth / first.width);
  const size_t columns = std::min(kColumns, frames.size()), rows = (frames.size() + columns - 1) / columns;
  ByteImage sheet(columns * (kWidth + kGap) - kGap, rows * (height + kGap) - kGap, 1);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), uint8_t{96});
  for (size_t i = 0; i < frames.size(); ++i) {
    const ByteImage& frame = frames[i].picture;
    for (size_t y = 0; y < height; ++y) {
      const size_t to = (i / columns * (height + kGap) + y) * sheet.width + i % columns * (kWidth + kGap);
      for (size_t x = 0; x < kWidth; ++x) {
        sheet.pixels[to + x] = frame.pixels[y * frame.height / height * frame.width + x * frame.width / kWidth];
      }
    }
  }
  return sheet;
}

/// Returns the table for a program that drives the display: the frame, its start in the cycle, and its duration.
std::string csv_of(const cycles::Schedule& schedule, const std::vector<NamedFrame>& frames) {
  std::string text = "index,file,name,begin_us,duration_us,event_image\n";
  int64_t begin_us = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    const cycles::ScheduledPattern& pattern = schedule.patterns[i];
    text += cat(i, ',', frames[i].file, ',', pattern.name, ',', begin_us, ',', pattern.duration_us, ',',
                pattern.image ? std::to_string(*pattern.image) : "", '\n');
    begin_us += pattern.interval_us();
  }
  return text;
}

Result<void> write_frame(const fs::path& folder, const NamedFrame& frame, const RenderArguments& arguments) {
  const BitDepth depth = arguments.bits == 1 ? BitDepth::k1 : BitDepth::k8;
  if (arguments.format == "bmp") return write_file(folder / frame.file, encode_grey_bmp(frame.picture, depth));
  E2LF_ASSIGN_OR_RETURN(const auto bytes, encode_grey_png(frame.picture, depth));
  return write_file(folder / frame.file, bytes);
}

Result<void> check_depth(const RenderArguments& arguments, const capture::Codes& codes) {
  if (arguments.bits == 8 || capture::is_binary(codes)) return {};
  return Error{ErrorCode::kInvalidValue,
               "the patterns contain values between 0 and 1, which one bit cannot represent; use 8", "--bits"};
}

Result<void> render(const RenderArguments& arguments, const Verb& verb) {
  RunRecord record("codes render");
  E2LF_ASSIGN_OR_RETURN(pipeline::KnownCodes known, load_codes(arguments.codes, record));
  known.codes = capture::codes_of_whole_cycle(known.codes).value_or(known.codes);
  E2LF_RETURN_IF_ERROR(check_depth(arguments, known.codes));
  const Sequence sequence = sequence_of(arguments, known.codes);
  E2LF_ASSIGN_OR_RETURN(const auto frames, render_frames(arguments, sequence));
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder,
                        open_output_folder(arguments.output, {.inputs = {arguments.codes.model, arguments.codes.codes},
                                                              .overwrite = verb.common().overwrite}));
  for (const NamedFrame& frame : frames) E2LF_RETURN_IF_ERROR(write_frame(folder.path(), frame, arguments));
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "schedule.json", cycles::schedule_text(sequence.schedule)));
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "schedule.csv", csv_of(sequence.schedule, frames)));
  E2LF_RETURN_IF_ERROR(capture::write_codes(folder.path() / "codes.json", known.codes));
  E2LF_RETURN_IF_ERROR(lightfield::write_png(folder.path() / "contact_sheet.png", sheet_of(frames)));
  record.end_step("render");
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  E2LF_RETURN_IF_ERROR(folder.commit(std::move(about)));
  if (!verb.common().quiet) {
    std::printf("%zu frames of %zux%zu px in %s: look at contact_sheet.png; schedule.json is for --schedule\n",
                frames.size(), arguments.layout.width_px, arguments.layout.height_px, arguments.output.c_str());
  }
  return {};
}

}  // namespace

int run_codes_render(const std::vector<std::string>& arguments) {
  Verb verb("codes render", "Make the images that an aperture display shows, and their schedule.",
            "e2lf codes render -m e2lf-n4 -o out/display --flip-x --bits 1");
  RenderArguments render_arguments;
  capture::DisplayLayout& layout = render_arguments.layout;
  CLI::App& app = verb.app();
  add_codes_options(app, render_arguments.codes);
  app.add_option("-o,--output", render_arguments.output, "folder to write")->required();
  app.add_option("--width", layout.width_px, "of the display, px")->capture_default_str();
  app.add_option("--height", layout.height_px, "of the display, px")->capture_default_str();
  app.add_option("--cell", layout.cell_px, "width and height of an aperture cell, px")->capture_default_str();
  app.add_option("--offset-x", layout.offset_x_px, "offset of the aperture from the centre to the right, px");
  app.add_option("--offset-y", layout.offset_y_px, "offset of the aperture from the centre downwards, px");
  app.add_option("--rotate", render_arguments.rotation_deg, "rotation of the patterns, clockwise, degrees")
      ->check(CLI::IsMember({0, 90, 180, 270}))
      ->capture_default_str();
  app.add_flag("--flip-x", layout.flip_x, "mirror the patterns left to right, before the rotation");
  app.add_flag("--flip-y", layout.flip_y, "mirror the patterns top to bottom, before the rotation");
  app.add_option("--format", render_arguments.format, "png or bmp")
      ->check(CLI::IsMember({"png", "bmp"}))
      ->capture_default_str();
  app.add_option("--bits", render_arguments.bits, "per pixel: 1 or 8")
      ->check(CLI::IsMember({1, 8}))
      ->capture_default_str();
  app.add_flag("--no-inverses", render_arguments.no_inverses,
               "omit the inverse patterns that the paper's display needs");
  app.add_option("--duration-us", render_arguments.duration_us, "duration of each pattern, with --no-inverses")
      ->check(whole_number(1))
      ->capture_default_str();
  return verb.run(arguments, [&] {
    layout.quarter_turns = render_arguments.rotation_deg / 90;
    return render(render_arguments, verb);
  });
}

}  // namespace e2lf::cli
