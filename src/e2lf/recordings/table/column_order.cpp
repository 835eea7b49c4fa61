// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/column_order.h"

#include <algorithm>
#include <cmath>

#include "e2lf/recordings/table/polarity.h"

namespace e2lf::recordings::table {
namespace {

/// Share of the values of a column that may be damaged.
constexpr double kMaxDamaged = 0.1;
/// Columns that decrease this rarely may be times out of order; coordinates decrease more often than kFallsOften.
constexpr double kFallsRarely = 0.1, kFallsOften = 0.25;
/// No sensor is wider (px).
constexpr size_t kWidestSensor = 8192;
/// Fewer rows may increase by chance.
constexpr size_t kFewRows = 8;

/// Returns the share of values that cannot be coordinates below a limit.
double share_beyond(const std::vector<double>& values, size_t limit) {
  const double most = limit == 0 ? 65536.0 : static_cast<double>(limit);
  const auto beyond = std::count_if(values.begin(), values.end(), [most](double value) {
    return !(value >= 0) || value >= most || value != std::trunc(value);
  });
  return static_cast<double>(beyond) / static_cast<double>(values.size());
}

bool are_polarities(const std::vector<double>& values) {
  const double share = static_cast<double>(guess_polarity(values).explained) / static_cast<double>(values.size());
  return share >= 1 - kMaxDamaged;
}

struct Steps {
  double share_falling = 0;
  bool rises = false;
};

Steps steps_of(const std::vector<double>& values) {
  size_t falls = 0, rises = 0;
  for (size_t i = 1; i < values.size(); ++i) {
    falls += values[i] < values[i - 1];
    rises += values[i] > values[i - 1];
  }
  return {static_cast<double>(falls) / static_cast<double>(values.size()), rises > 0};
}

/// Returns the orders that the names permit.
std::vector<ColumnsOfFields> orders_of(const OrderHints& hints) {
  const bool has_names =
      std::any_of(hints.named.begin(), hints.named.end(), [](const auto& field) { return field.has_value(); });
  std::vector<ColumnsOfFields> orders;
  ColumnsOfFields order = {0, 1, 2, 3};
  do {
    bool fits = has_names ? order[of(Field::kX)] < order[of(Field::kY)] || hints.named[order[of(Field::kX)]] ||
                                hints.named[order[of(Field::kY)]]
                          : order[of(Field::kX)] + 1 == order[of(Field::kY)];
    for (size_t field = 0; field < kNumFields; ++field) {
      for (size_t column = 0; column < kNumFields; ++column) {
        if (hints.named[column] == static_cast<Field>(field)) fits = fits && order[field] == column;
      }
    }
    if (fits) orders.push_back(order);
  } while (std::next_permutation(order.begin(), order.end()));
  return orders;
}

std::string letters_of(const ColumnsOfFields& order) {
  std::string letters(kNumFields, ' ');
  for (size_t field = 0; field < kNumFields; ++field) letters[order[field]] = kFieldLetters[field];
  return letters;
}

/// Keeps the `orders` for which `keep` is true, unless it is true for none.
template <typename Keep>
void narrow(std::vector<ColumnsOfFields>& orders, const Keep& keep) {
  std::vector<ColumnsOfFields> kept;
  std::copy_if(orders.begin(), orders.end(), std::back_inserter(kept), keep);
  if (!kept.empty()) orders = std::move(kept);
}

}  // namespace

std::optional<OrderGuess> find_order(std::span<const std::vector<double>> columns, const OrderHints& hints) {
  std::vector<ColumnsOfFields> orders = orders_of(hints);
  const size_t rows = columns[0].size();
  std::array<Steps, kNumFields> steps;
  std::array<bool, kNumFields> is_polarity{};
  for (size_t i = 0; i < kNumFields && rows > 0; ++i) {
    steps[i] = steps_of(columns[i]);
    is_polarity[i] = are_polarities(columns[i]);
  }
  // Among few events, a single one outside the sensor has too much weight.
  const size_t width = rows < kFewRows ? 0 : hints.width, height = rows < kFewRows ? 0 : hints.height;
  const auto fits = [&](const ColumnsOfFields& order, size_t most_x, size_t most_y) {
    return share_beyond(columns[order[of(Field::kX)]], most_x) <= kMaxDamaged &&
           share_beyond(columns[order[of(Field::kY)]], most_y) <= kMaxDamaged;
  };
  std::erase_if(orders, [&](const ColumnsOfFields& order) {
    return rows > 0 && (!is_polarity[order[of(Field::kP)]] || !fits(order, 0, 0));
  });
  if (orders.empty()) return std::nullopt;
  // Larger coordinates are likely those of another column, unless the format says where they are.
  const auto fits_a_sensor = [&](const ColumnsOfFields& order) { return fits(order, kWidestSensor, kWidestSensor); };
  if (rows > 0 && std::none_of(orders.begin(), orders.end(), fits_a_sensor)) {
    std::erase_if(orders, [&](const ColumnsOfFields& order) { return letters_of(order) != hints.usual; });
    if (orders.empty()) return std::nullopt;
  }
  narrow(orders, fits_a_sensor);
  // If the sensor is too small for every order, events are left out, which is reported elsewhere.
  narrow(orders, [&](const ColumnsOfFields& order) { return fits(order, width, height); });

  const auto time_of = [](const ColumnsOfFields& order) { return order[of(Field::kT)]; };
  const auto has_one_time = [&] {
    return std::all_of(orders.begin(), orders.end(), [&](const auto& o) { return time_of(o) == time_of(orders[0]); });
  };
  if (!has_one_time() && rows >= kFewRows) {
    const auto rises = [&](const auto& order) { return steps[time_of(order)].rises; };
    narrow(orders, [&](const auto& order) { return rises(order) && steps[time_of(order)].share_falling == 0; });
    const bool others_fall_often = std::all_of(orders.begin(), orders.end(), [&](const auto& order) {
      const double share = steps[time_of(order)].share_falling;
      return share <= kFallsRarely || share >= kFallsOften;
    });
    if (others_fall_often) {
      narrow(orders, [&](const auto& order) { return steps[time_of(order)].share_falling <= kFallsRarely; });
    }
  }
  const bool is_told = has_one_time() && rows > 0;
  const auto usual =
      std::find_if(orders.begin(), orders.end(), [&](const auto& order) { return letters_of(order) == hints.usual; });
  if (!is_told) {
    if (usual == orders.end()) return std::nullopt;
    return OrderGuess{*usual, true};
  }
  // The polarity is last, or follows the coordinates if times are last.
  for (const std::string_view likely : {"txyp", "xytp", "xypt"}) {
    narrow(orders, [&](const auto& order) { return letters_of(order) == likely; });
  }
  if (orders.size() == 1) return OrderGuess{orders[0], letters_of(orders[0]) == hints.usual};
  return std::nullopt;
}

}  // namespace e2lf::recordings::table
