// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2lf/files/options.h"

namespace e2lf::report {

/// A cell: what people read, and the value for programs.
struct Cell {
  std::string text;  ///< empty: there is none
  Json value;        ///< a text, a number, an object of numbers; null: there is none
  bool is_best = false;
};

struct Column {
  std::string name;
  bool is_number = false;    ///< set to the right
  bool begins_part = false;  ///< a line stands before it in LaTeX
  std::string key = {};      ///< its name for programs; empty: the same
};

/// Rows of cells under named columns; every row has a cell for each column.
struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

[[nodiscard]] Cell text_cell(std::string text);
/// A number with so many decimals, the value in full. Nothing, and what is not finite, is an empty cell.
[[nodiscard]] Cell number_cell(std::optional<double> value, int decimals);

/// Marks the cell with the largest number in a column (the smallest, with `is_least`) and those that read the same.
void mark_best(Table& table, size_t column, bool is_least = false);

/// The values of an object as rows "name", "value": members of objects within have the name before theirs, "_" in a
/// name becomes a space. Lists of numbers and texts stand in one cell, of other lists the length.
[[nodiscard]] Table facts_table(const Json& facts);

/// For a terminal: a heading, a line for each row, columns of even width; "-" where there is no value, "*" after the
/// best of a column that has one.
[[nodiscard]] std::string table_text(const Table& table);

/// Comma-separated values (RFC 4180) of the full values; the members of an object have a column each, "<name> <key>".
[[nodiscard]] std::string table_csv(const Table& table);

/// {"caption", "rows": [{"<column>": value, ...}]}.
[[nodiscard]] Json table_json(const Table& table);

/// A LaTeX table in the style of booktabs, the best of a column bold. One that is wider than the text is made as wide
/// as that. It needs \usepackage{booktabs,graphicx}.
[[nodiscard]] std::string table_latex(const Table& table);

}  // namespace e2lf::report
