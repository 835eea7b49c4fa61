// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/table/field.h"

namespace e2lf::recordings::table {

/// Which column holds which field, by Field.
using ColumnsOfFields = std::array<size_t, kNumFields>;

/// What is known of four columns before their values are looked at.
struct OrderHints {
  std::array<std::optional<Field>, kNumFields> named = {};  ///< by column; x, y, t, p in some order where none is
  size_t width = 0, height = 0;                             ///< of the sensor in px; 0 = not known
  std::string usual;                                        ///< the order where the values leave several, as "xypt"
};

struct OrderGuess {
  ColumnsOfFields columns = {};
  bool is_usual = false;  ///< the usual order, because the values leave several
};

/// Tells four columns of equal length apart by their values: polarities are of one code, coordinates are whole and on
/// the sensor, times do not fall or are no coordinates. Without names, y follows x. Some values may be damaged. Nothing
/// where the values leave several orders and none is usual, or none.
[[nodiscard]] std::optional<OrderGuess> find_order(std::span<const std::vector<double>> columns,
                                                   const OrderHints& hints);

}  // namespace e2lf::recordings::table
