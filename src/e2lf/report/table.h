// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2lf/files/options.h"

namespace e2lf::report {

/// A cell: the text for readers and the value for programs.
struct Cell {
  std::string text;  ///< empty if there is none
  Json value;        ///< a text, a number or an object of numbers; null if there is none
  bool is_best = false;
};

struct Column {
  std::string name;
  bool is_number = false;    ///< the column is right-aligned
  bool begins_part = false;  ///< LaTeX draws a vertical line before it
  std::string key = {};      ///< the name for programs; if empty, `name`
};

/// Rows of cells under named columns. Every row has one cell per column.
struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

[[nodiscard]] Cell text_cell(std::string text);
/// Makes a cell that shows a number with `decimals` decimals and stores the exact value. The cell is empty if the value
/// is absent or not finite.
[[nodiscard]] Cell number_cell(std::optional<double> value, int decimals);

/// Marks the cell with the largest number in a column (the smallest if `is_least`), and all cells with the same text.
void mark_best(Table& table, size_t column, bool is_least = false);

/// Lists the values of an object as rows of "name" and "value". Members of nested objects are prefixed with the name of
/// their object, and "_" in a name becomes a space. A list of up to 16 plain values is shown in one cell, and each
/// of up to 16 objects in rows of its own; of other lists, only the length is shown.
[[nodiscard]] Table facts_table(const Json& facts);

/// Formats a table for a terminal: a heading, one line per row, and aligned columns. "-" stands for a missing value,
/// and "*" follows the best value of a column that has one.
[[nodiscard]] std::string table_text(const Table& table);

/// Formats the exact values as comma-separated values (RFC 4180). Each member of an object gets a column "<name>
/// <key>".
[[nodiscard]] std::string table_csv(const Table& table);

/// Returns {"caption", "rows": [{"<column>": value, ...}]}.
[[nodiscard]] Json table_json(const Table& table);

/// Formats a LaTeX table in the style of booktabs, with the best value of a column in bold. A table wider than the text
/// is scaled down to its width. It needs \usepackage{booktabs,graphicx}.
[[nodiscard]] std::string table_latex(const Table& table);

}  // namespace e2lf::report
