// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "e2lf/base/little_endian.h"

namespace e2lf::recordings::aedat4 {

/// Reads the fields of a FlatBuffer. Every offset is checked against the buffer, so that damage yields nothing instead
/// of a wrong value. (A table begins with the distance back to its vtable, which lists the offsets of the fields.
/// Strings, vectors and sub-tables are referenced by u32 offsets.)
class FlatBuffer {
 public:
  explicit FlatBuffer(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  /// Returns the position of the root table if the identifier of the buffer is `id` (four characters).
  [[nodiscard]] std::optional<size_t> root(std::string_view id) const {
    const auto place = follow(0);
    if (!place || bytes_.size() < 8 || text(4, 4) != id) return std::nullopt;
    return place;
  }

  /// Returns the position of field number `field` of the table, or nothing if it has its default value or is damaged.
  [[nodiscard]] std::optional<size_t> field(size_t table, size_t field) const {
    const auto back = number<int32_t>(table);
    if (!back) return std::nullopt;
    const int64_t vtable = static_cast<int64_t>(table) - *back;
    if (vtable < 0) return std::nullopt;
    const auto vtable_size = number<uint16_t>(static_cast<size_t>(vtable));
    const size_t entry = 4 + 2 * field;
    if (!vtable_size || entry + 2 > *vtable_size) return std::nullopt;
    const auto offset = number<uint16_t>(static_cast<size_t>(vtable) + entry);
    if (!offset || *offset == 0) return std::nullopt;
    return table + *offset;
  }

  template <typename T>
  [[nodiscard]] std::optional<T> number(size_t place) const {
    if (place > bytes_.size() || bytes_.size() - place < sizeof(T)) return std::nullopt;
    return load_le<T>(bytes_.data() + place);
  }

  /// Returns the value of a numeric field, or its default.
  template <typename T>
  [[nodiscard]] T number_field(size_t table, size_t index, T default_value) const {
    const auto place = field(table, index);
    return place ? number<T>(*place).value_or(default_value) : default_value;
  }

  /// Returns the elements of a vector field, or the characters of a string field, with `element_size` bytes each.
  [[nodiscard]] std::optional<std::span<const uint8_t>> vector_field(size_t table, size_t index,
                                                                     size_t element_size) const {
    const auto place = field(table, index);
    const auto vector = place ? follow(*place) : std::nullopt;
    const auto count = vector ? number<uint32_t>(*vector) : std::nullopt;
    if (!count || (bytes_.size() - *vector - 4) / element_size < *count) return std::nullopt;
    return bytes_.subspan(*vector + 4, *count * element_size);
  }

  /// Returns the position to which the u32 offset at `place` points.
  [[nodiscard]] std::optional<size_t> follow(size_t place) const {
    const auto offset = number<uint32_t>(place);
    if (!offset || *offset > bytes_.size() - place) return std::nullopt;
    return place + *offset;
  }

  /// Returns the position of an element of a vector that vector_field() returned.
  [[nodiscard]] size_t place_of(const uint8_t* element) const { return static_cast<size_t>(element - bytes_.data()); }

 private:
  [[nodiscard]] std::string_view text(size_t place, size_t length) const {
    return {reinterpret_cast<const char*>(bytes_.data()) + place, length};
  }

  std::span<const uint8_t> bytes_;
};

}  // namespace e2lf::recordings::aedat4
