// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings::text {

enum class Field { kX, kY, kP, kT };

/// How the lines of a text recording are to be read.
struct Layout {
  std::array<Field, 4> order = {Field::kX, Field::kY, Field::kP, Field::kT};
  bool is_seconds = false;  ///< times have a decimal point
  size_t width = 0;
  size_t height = 0;
  size_t header_bytes = 0;  ///< where the events begin
  bool has_events = false;  ///< there is one at least
};

inline constexpr std::array<Field, 4> kCsvOrder = {Field::kX, Field::kY, Field::kP, Field::kT};
inline constexpr std::array<Field, 4> kTxtOrder = {Field::kT, Field::kX, Field::kY, Field::kP};

/// Finds the layout from the first lines: a line of names if there is one, otherwise t x y p where the first number has
/// a decimal point and x,y,p,t where it has none. Nothing when the first line of data is not four numbers, or when
/// there is none and no line tells the size either.
[[nodiscard]] std::optional<Layout> find_layout(std::span<const uint8_t> head);

/// Reads one line, without its end, as an event. False when it is not one.
[[nodiscard]] bool parse_line(std::string_view line, const Layout& layout, Event& event);

}  // namespace e2lf::recordings::text
