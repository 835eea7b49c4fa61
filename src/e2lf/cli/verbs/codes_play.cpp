// SPDX-License-Identifier: MIT
// e2lf codes play: shows the patterns on a display of this computer
#include <SDL2/SDL.h>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/display_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

namespace {

Error graphics_error(const std::string& what) {
  return fail(ErrorCode::kIo, "display", what, " (", SDL_GetError(), "); check DISPLAY and the graphics driver");
}

/// A full-screen window on a display of this computer.
class Screen {
 public:
  using Clock = std::chrono::steady_clock;

  /// Opens a window that covers a display, counted from 0. Fails with kNotFound (no such display) and kIo (no
  /// graphics).
  [[nodiscard]] static Result<std::unique_ptr<Screen>> open(int display) {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) return graphics_error("no display is available");
    auto screen = std::make_unique<Screen>();
    const int count = SDL_GetNumVideoDisplays();
    if (display >= count) {
      return fail(ErrorCode::kNotFound, "--display", "there is no display ", display, "; give a number from 0 to ",
                  count - 1);
    }
    if (SDL_GetDesktopDisplayMode(display, &screen->mode_) != 0) return graphics_error("the display mode is unknown");
    const auto place = static_cast<int>(SDL_WINDOWPOS_CENTERED_DISPLAY(static_cast<unsigned>(display)));
    screen->window_ = SDL_CreateWindow("e2lf codes play", place, place, screen->mode_.w, screen->mode_.h,
                                       SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS);
    if (screen->window_ == nullptr) return graphics_error("no window can be opened on the display");
    if (SDL_GetWindowDisplayIndex(screen->window_) != display) {
      return fail(
          ErrorCode::kIo, "--display",
          "the display server shows the window on another display, as servers with several screens do; join the "
          "displays to one desktop (xrandr)");
    }
    SDL_ShowCursor(SDL_DISABLE);
    screen->renderer_ = SDL_CreateRenderer(screen->window_, -1, SDL_RENDERER_PRESENTVSYNC);
    if (screen->renderer_ == nullptr) screen->renderer_ = SDL_CreateRenderer(screen->window_, -1, 0);
    if (screen->renderer_ == nullptr) return graphics_error("the display cannot be drawn to");
    SDL_RendererInfo info{};
    const bool is_known = SDL_GetRendererInfo(screen->renderer_, &info) == 0;
    // The software renderer only simulates a refresh.
    screen->is_synchronised_ =
        is_known && (info.flags & SDL_RENDERER_PRESENTVSYNC) != 0 && (info.flags & SDL_RENDERER_SOFTWARE) == 0;
    if (!screen->is_synchronised_) SDL_RenderSetVSync(screen->renderer_, 0);
    return screen;
  }
  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  ~Screen() {
    for (SDL_Texture* const texture : textures_) SDL_DestroyTexture(texture);
    if (renderer_ != nullptr) SDL_DestroyRenderer(renderer_);
    if (window_ != nullptr) SDL_DestroyWindow(window_);
    SDL_Quit();
  }

  [[nodiscard]] size_t width_px() const { return static_cast<size_t>(mode_.w); }
  [[nodiscard]] size_t height_px() const { return static_cast<size_t>(mode_.h); }
  [[nodiscard]] double refresh_us() const {
    constexpr int kUsualHz = 60;
    return 1e6 / (mode_.refresh_rate > 0 ? mode_.refresh_rate : kUsualHz);
  }

  /// Returns true if show() waits for the refresh of the display; otherwise, it returns immediately.
  [[nodiscard]] bool is_synchronised() const { return is_synchronised_; }

  /// Loads grey pictures that have the size of the display. Fails with kIo.
  [[nodiscard]] Result<void> load(const std::vector<lightfield::ByteImage>& pictures) {
    for (const lightfield::ByteImage& picture : pictures) {
      SDL_Texture* const texture = SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STATIC,
                                                     static_cast<int>(picture.width), static_cast<int>(picture.height));
      if (texture == nullptr) return graphics_error("a pattern cannot be loaded");
      textures_.push_back(texture);
      std::vector<uint32_t> colours;
      colours.reserve(picture.pixels.size());
      for (const uint8_t grey : picture.pixels) colours.push_back(0xFF000000U | grey * 0x010101U);
      const int row_bytes = static_cast<int>(picture.width * sizeof(uint32_t));
      if (SDL_UpdateTexture(texture, nullptr, colours.data(), row_bytes) != 0) {
        return graphics_error("a pattern cannot be loaded");
      }
    }
    return {};
  }

  /// Shows one of the pictures from the next refresh on, with a white or black square of `corner_px` in the lower right
  /// corner. Returns the time at which it was shown. Fails with kIo.
  [[nodiscard]] Result<Clock::time_point> show(size_t picture, int corner_px, bool is_corner_white) {
    if (SDL_RenderCopy(renderer_, textures_[picture], nullptr, nullptr) != 0) {
      return graphics_error("a pattern cannot be shown");
    }
    if (corner_px > 0) {
      const uint8_t grey = is_corner_white ? 255 : 0;
      const SDL_Rect corner = {mode_.w - corner_px, mode_.h - corner_px, corner_px, corner_px};
      SDL_SetRenderDrawColor(renderer_, grey, grey, grey, 255);
      SDL_RenderFillRect(renderer_, &corner);
    }
    SDL_RenderPresent(renderer_);
    return Clock::now();
  }

  /// Returns true if the user closed the window or pressed Escape.
  [[nodiscard]] static bool is_closed() {
    bool is_closed = false;
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) {
      is_closed =
          is_closed || event.type == SDL_QUIT || (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_ESCAPE);
    }
    return is_closed;
  }

 private:
  SDL_DisplayMode mode_{};
  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  bool is_synchronised_ = false;
  std::vector<SDL_Texture*> textures_;
};

using Clock = Screen::Clock;

struct PlayArguments {
  DisplayFlags display;  ///< a width or height of 0 means that of the display
  fs::path output;
  int screen = 0, blink_px = 0;
  std::optional<int64_t> period_us;
  uint64_t cycles = 0;  ///< 0 = until the user ends it
};

struct Flip {
  uint64_t cycle = 0;
  size_t pattern = 0;
  Clock::time_point shown;
  uint64_t missed = 0;  ///< number of refreshes without a picture before the next pattern
};

int64_t us_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration_cast<std::chrono::microseconds>(to - from).count();
}

/// Shows one picture per refresh, and records when the patterns changed.
class Player {
 public:
  Player(const PlayArguments& arguments, Screen& screen, const cycles::Schedule& schedule)
      : arguments_(arguments), screen_(screen) {
    for (const cycles::ScheduledPattern& pattern : schedule.patterns) {
      const auto wanted_us = static_cast<double>(arguments.period_us.value_or(pattern.interval_us()));
      refreshes_.push_back(static_cast<size_t>(std::max(1.0, std::round(wanted_us / screen.refresh_us()))));
      const double shown_us = static_cast<double>(refreshes_.back()) * screen.refresh_us();
      if (std::abs(shown_us - wanted_us) > std::abs(most_off_us_ - off_wanted_us_)) {
        most_off_us_ = shown_us;
        off_wanted_us_ = wanted_us;
      }
    }
  }

  /// Returns a message if the refresh rate does not permit the stated durations; otherwise, an empty text.
  [[nodiscard]] std::string period_text() const {
    constexpr double kTolerance = 0.01;
    if (std::abs(most_off_us_ - off_wanted_us_) <= kTolerance * off_wanted_us_) return "";
    return cat("a pattern of ", std::lround(off_wanted_us_), " us is shown for ", std::lround(most_off_us_),
               " us, because the display refreshes every ", std::lround(screen_.refresh_us()),
               " us; choose a multiple of this with --period-us");
  }

  [[nodiscard]] const std::vector<size_t>& refreshes() const { return refreshes_; }
  [[nodiscard]] const std::vector<Flip>& flips() const { return flips_; }
  /// Returns the time at which the last pattern ended.
  [[nodiscard]] Clock::time_point end() const { return last_shown_; }
  [[nodiscard]] uint64_t missed() const { return missed_; }

  /// Shows the cycles. Returns early, after a complete cycle, if a stop is requested or the user closes the screen.
  Result<void> play() {
    for (uint64_t cycle = 0; arguments_.cycles == 0 || cycle < arguments_.cycles; ++cycle) {
      if (stop_requested() || screen_.is_closed()) break;
      for (size_t pattern = 0; pattern < refreshes_.size(); ++pattern) {
        for (size_t refresh = 0; refresh < refreshes_[pattern]; ++refresh) {
          E2LF_RETURN_IF_ERROR(show(pattern, refresh));
          if (refresh == 0) flips_.push_back({cycle, pattern, last_shown_, 0});
        }
      }
    }
    // Showing the first picture of another cycle ends the last pattern.
    return flips_.empty() ? Result<void>() : show(0, 0);
  }

 private:
  Result<void> show(size_t pattern, size_t refresh) {
    const auto refresh_time = std::chrono::nanoseconds(static_cast<int64_t>(screen_.refresh_us() * 1e3));
    if (!screen_.is_synchronised() && !flips_.empty()) {
      due_ += refresh_time;
      std::this_thread::sleep_until(due_);
    }
    const bool is_white = 2 * refresh < refreshes_[pattern];
    E2LF_ASSIGN_OR_RETURN(const Clock::time_point shown, screen_.show(pattern, arguments_.blink_px, is_white));
    if (flips_.empty()) {
      due_ = shown;
    } else {
      const double passed = static_cast<double>(us_between(last_shown_, shown)) / screen_.refresh_us();
      const auto missed = static_cast<uint64_t>(std::max(0.0, std::round(passed) - 1));
      flips_.back().missed += missed;
      missed_ += missed;
      if (missed > 0) due_ = shown;  // do not try to catch up
    }
    last_shown_ = shown;
    return {};
  }

  const PlayArguments& arguments_;
  Screen& screen_;
  std::vector<size_t> refreshes_;
  std::vector<Flip> flips_;
  Clock::time_point last_shown_, due_;
  uint64_t missed_ = 0;
  double most_off_us_ = 0, off_wanted_us_ = 0;  ///< actual and stated duration of the pattern with the largest change
};

std::string csv_of(const Player& player, const cycles::Schedule& schedule) {
  std::string text = "cycle,index,name,shown_us,duration_us,missed_refreshes\n";
  const std::vector<Flip>& flips = player.flips();
  for (size_t i = 0; i < flips.size(); ++i) {
    const Clock::time_point next = i + 1 < flips.size() ? flips[i + 1].shown : player.end();
    text += cat(flips[i].cycle, ',', flips[i].pattern, ',', csv_cell(schedule.patterns[flips[i].pattern].name), ',',
                us_between(flips.front().shown, flips[i].shown), ',', us_between(flips[i].shown, next), ',',
                flips[i].missed, '\n');
  }
  return text;
}

/// Returns the schedule with the mean measured durations of the patterns, without those that missed a refresh.
cycles::Schedule shown_schedule(const Player& player, cycles::Schedule schedule) {
  std::vector<int64_t> sums(schedule.size(), 0), counts(schedule.size(), 0);
  const std::vector<Flip>& flips = player.flips();
  for (size_t i = 0; i < flips.size(); ++i) {
    if (flips[i].missed > 0) continue;
    sums[flips[i].pattern] += us_between(flips[i].shown, i + 1 < flips.size() ? flips[i + 1].shown : player.end());
    ++counts[flips[i].pattern];
  }
  for (size_t i = 0; i < schedule.size(); ++i) {
    if (counts[i] > 0) schedule.patterns[i].duration_us = std::max<int64_t>(1, sums[i] / counts[i]);
    if (counts[i] > 0) schedule.patterns[i].overhead_us = 0;
  }
  return schedule;
}

Result<void> play(PlayArguments arguments, const Verb& verb) {
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder, open_output_folder(arguments.output, verb));
  E2LF_ASSIGN_OR_RETURN(const std::unique_ptr<Screen> screen, Screen::open(arguments.screen));
  capture::DisplayLayout& layout = arguments.display.layout;
  if (layout.width_px == 0) layout.width_px = screen->width_px();
  if (layout.height_px == 0) layout.height_px = screen->height_px();
  E2LF_ASSIGN_OR_RETURN(const DisplaySequence sequence, display_sequence(arguments.display, record));
  E2LF_RETURN_IF_ERROR(screen->load(sequence.frames));
  if (!screen->is_synchronised()) {
    log_warning(
        "the graphics driver does not synchronise with the refresh of the display; the times of the patterns are those "
        "of the computer's clock, and pictures may be torn");
  }
  Player player(arguments, *screen, sequence.schedule);
  if (const std::string text = player.period_text(); !text.empty()) log_warning(text);
  E2LF_RETURN_IF_ERROR(player.play());
  if (player.flips().empty()) return fail(ErrorCode::kCancelled, "", "stopped before the first pattern was shown");
  record.end_step("play");
  const uint64_t cycles = player.flips().back().cycle + 1;
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "flips.csv", csv_of(player, sequence.schedule)));
  const cycles::Schedule shown = shown_schedule(player, sequence.schedule);
  E2LF_RETURN_IF_ERROR(write_file(folder.path() / "schedule.json", cycles::schedule_text(shown)));
  const Json json = {{"cycles", cycles},
                     {"refresh_us", screen->refresh_us()},
                     {"is_synchronised", screen->is_synchronised()},
                     {"refreshes", player.refreshes()},
                     {"missed_refreshes", player.missed()}};
  record.note("shown", json);
  E2LF_RETURN_IF_ERROR(commit(folder, record));
  if (player.missed() > 0) {
    log_warning(cat(player.missed(),
                    " refreshes were missed, so that patterns were shown for too long; flips.csv lists "
                    "them. Close other programs, or show patterns for longer (--period-us)"));
  }
  print_result(verb.common(), json,
               cat(cycles, " cycles shown; the times are in ", arguments.output.string(),
                   ", whose schedule.json can be given to --schedule\n"));
  return {};
}

}  // namespace

int run_codes_play(const std::vector<std::string>& arguments) {
  Verb verb("codes play", "Show the patterns on a display of this computer, and log when each was shown.",
            "e2lf codes play -m e2lf-n4 -o out/shown --display 1 --period-us 16667");
  PlayArguments play_arguments;
  play_arguments.display.layout.width_px = play_arguments.display.layout.height_px = 0;
  CLI::App& app = verb.app();
  add_display_options(app, play_arguments.display);
  app.add_option("-o,--output", play_arguments.output, "folder for the times and the schedule")->required();
  add_count(app, "--display", play_arguments.screen, 0, INT64_MAX, "number of the display, from 0");
  app.add_option("--period-us", play_arguments.period_us,
                 "duration of each pattern, rounded to refreshes of the display; default: that of the schedule")
      ->check(whole_number(1));
  app.add_option("--cycles", play_arguments.cycles, "number of cycles, 0 = until Escape or Ctrl-C")
      ->capture_default_str();
  add_count(app, "--blink", play_arguments.blink_px, 0, 4096,
            "width of a square in the lower right corner that is white in the first half of each pattern, for a "
            "photodiode, px; 0 = none");
  verb.stop_gently();
  return verb.run(arguments, [&] { return play(play_arguments, verb); });
}

}  // namespace e2lf::cli
