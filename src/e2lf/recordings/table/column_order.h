// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/table/column_names.h"

namespace e2lf::recordings::table {

/// The index of the column of each field, by Field.
using ColumnsOfFields = std::array<size_t, kNumFields>;

/// Prior knowledge about four columns, before their values are inspected.
struct OrderHints {
  std::array<std::optional<Field>, kNumFields> named =
      {};                        ///< by column; if none is named, they are x, y, t and p in unknown order
  size_t width = 0, height = 0;  ///< size of the sensor, px; 0 = unknown
  std::string usual;             ///< the order to use if the values permit several, e.g. "xypt"
};

struct OrderGuess {
  ColumnsOfFields columns = {};
  bool is_usual = false;  ///< whether the usual order was used because the values permit several
};

/// Determines the order of four columns of equal length from their values: polarities use one convention
/// (0/1 or -1/1), coordinates are integers on the sensor, and times never decrease or cannot be coordinates. If no
/// column is named, y must be the column right after x. A few damaged values are tolerated. Returns nothing if the
/// values permit no order, or several of which none is the usual one.
[[nodiscard]] std::optional<OrderGuess> find_order(std::span<const std::vector<double>> columns,
                                                   const OrderHints& hints);

}  // namespace e2lf::recordings::table
