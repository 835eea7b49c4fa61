// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/screen.h"

#include <SDL2/SDL.h>

#include "e2lf/base/text.h"

namespace e2lf::cli {
namespace {

Error graphics_error(const std::string& what) {
  return {ErrorCode::kIo, cat(what, " (", SDL_GetError(), "); check DISPLAY and the graphics driver"), "display"};
}

}  // namespace

struct Screen::Parts {
  Parts() = default;
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() {
    for (SDL_Texture* const texture : textures) SDL_DestroyTexture(texture);
    if (renderer != nullptr) SDL_DestroyRenderer(renderer);
    if (window != nullptr) SDL_DestroyWindow(window);
    SDL_Quit();
  }

  SDL_DisplayMode mode{};
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  bool is_synchronised = false;
  std::vector<SDL_Texture*> textures;
};

Screen::Screen(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Screen::Screen(Screen&& other) noexcept = default;
Screen::~Screen() = default;

Result<Screen> Screen::open(int display) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return graphics_error("no display is available");
  auto parts = std::make_unique<Parts>();
  const int count = SDL_GetNumVideoDisplays();
  if (display >= count) {
    return Error{ErrorCode::kNotFound, cat("there is no display ", display, "; give a number from 0 to ", count - 1),
                 "--display"};
  }
  if (SDL_GetDesktopDisplayMode(display, &parts->mode) != 0) return graphics_error("the display mode is unknown");
  const auto place = static_cast<int>(SDL_WINDOWPOS_CENTERED_DISPLAY(static_cast<unsigned>(display)));
  parts->window = SDL_CreateWindow("e2lf codes play", place, place, parts->mode.w, parts->mode.h,
                                   SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS);
  if (parts->window == nullptr) return graphics_error("no window can be opened on the display");
  if (SDL_GetWindowDisplayIndex(parts->window) != display) {
    return Error{ErrorCode::kIo,
                 "the display server shows the window on another display, as servers with several screens do; join the "
                 "displays to one desktop (xrandr)",
                 "--display"};
  }
  SDL_ShowCursor(SDL_DISABLE);
  parts->renderer = SDL_CreateRenderer(parts->window, -1, SDL_RENDERER_PRESENTVSYNC);
  if (parts->renderer == nullptr) parts->renderer = SDL_CreateRenderer(parts->window, -1, 0);
  if (parts->renderer == nullptr) return graphics_error("the display cannot be drawn to");
  SDL_RendererInfo info{};
  const bool is_known = SDL_GetRendererInfo(parts->renderer, &info) == 0;
  // The software renderer only simulates a refresh.
  parts->is_synchronised =
      is_known && (info.flags & SDL_RENDERER_PRESENTVSYNC) != 0 && (info.flags & SDL_RENDERER_SOFTWARE) == 0;
  if (!parts->is_synchronised) SDL_RenderSetVSync(parts->renderer, 0);
  return Screen(std::move(parts));
}

size_t Screen::width_px() const {
  return static_cast<size_t>(parts_->mode.w);
}

size_t Screen::height_px() const {
  return static_cast<size_t>(parts_->mode.h);
}

double Screen::refresh_us() const {
  constexpr int kUsualHz = 60;
  return 1e6 / (parts_->mode.refresh_rate > 0 ? parts_->mode.refresh_rate : kUsualHz);
}

bool Screen::is_synchronised() const {
  return parts_->is_synchronised;
}

Result<void> Screen::load(const std::vector<lightfield::ByteImage>& pictures) {
  for (const lightfield::ByteImage& picture : pictures) {
    SDL_Texture* const texture = SDL_CreateTexture(parts_->renderer, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STATIC,
                                                   static_cast<int>(picture.width), static_cast<int>(picture.height));
    if (texture == nullptr) return graphics_error("a pattern cannot be loaded");
    parts_->textures.push_back(texture);
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

Result<Screen::Clock::time_point> Screen::show(size_t picture, int corner_px, bool is_corner_white) {
  SDL_Renderer* const renderer = parts_->renderer;
  if (SDL_RenderCopy(renderer, parts_->textures[picture], nullptr, nullptr) != 0) {
    return graphics_error("a pattern cannot be shown");
  }
  if (corner_px > 0) {
    const uint8_t grey = is_corner_white ? 255 : 0;
    const SDL_Rect corner = {parts_->mode.w - corner_px, parts_->mode.h - corner_px, corner_px, corner_px};
    SDL_SetRenderDrawColor(renderer, grey, grey, grey, 255);
    SDL_RenderFillRect(renderer, &corner);
  }
  SDL_RenderPresent(renderer);
  return Clock::now();
}

bool Screen::is_closed() {
  bool is_closed = false;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    is_closed =
        is_closed || event.type == SDL_QUIT || (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_ESCAPE);
  }
  return is_closed;
}

}  // namespace e2lf::cli
