// SPDX-License-Identifier: MIT
#include "e2lf/report/table.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/report/page.h"

namespace e2lf::report {
namespace {

void check(const Table& table) {
  for (const auto& row : table.rows) {
    E2LF_REQUIRE(row.size() == table.columns.size(), "a row of a table must have a cell for each column");
  }
}

const std::string& key_of(const Column& column) {
  return column.key.empty() ? column.name : column.key;
}

bool has_best(const Table& table, size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return row[column].is_best; });
}

std::string padded(const std::string& text, size_t width, bool is_right) {
  const std::string space(width - std::min(width, num_characters(text)), ' ');
  return is_right ? space + text : text + space;
}

std::string csv_value(const Json& value) {
  if (value.is_null()) return {};
  return csv_cell(value.is_string() ? value.get<std::string>() : json_line(value));
}

/// Returns the keys of the objects in a column, or none if it holds no objects.
std::vector<std::string> keys_of(const Table& table, size_t column) {
  std::vector<std::string> keys;
  for (const auto& row : table.rows) {
    if (!row[column].value.is_object()) continue;
    for (const auto& [key, value] : row[column].value.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

std::string csv_line(const std::vector<std::string>& cells) {
  return join(cells, ",") + "\r\n";
}

std::string latex_cell(const Cell& cell) {
  if (cell.text.empty()) return "--";
  const std::string text = latex_escaped(cell.text);
  return cell.is_best ? "\\textbf{" + text + "}" : text;
}

/// Returns the number by which a cell is compared: its value, or the first one of its object.
std::optional<double> rank_of(const Cell& cell) {
  const Json& value = cell.value.is_object() && !cell.value.empty() ? *cell.value.begin() : cell.value;
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

constexpr size_t kMostListed = 16;

std::string scalar_text(const Json& value) {
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return cat(value.get<double>());
  return json_line(value);
}

std::string fact_text(const Json& value) {
  if (!value.is_array()) return scalar_text(value);
  const bool is_plain = std::none_of(value.begin(), value.end(), [](const Json& each) { return each.is_structured(); });
  if (!is_plain || value.size() > kMostListed) return cat(value.size(), " entries");
  std::vector<std::string> texts;
  for (const Json& each : value) texts.push_back(scalar_text(each));
  return texts.empty() ? "none" : join(texts, ", ");
}

void add_facts(const Json& facts, const std::string& prefix, Table& table) {
  for (const auto& [key, value] : facts.items()) {
    std::string name = prefix + key;
    std::replace(name.begin(), name.end(), '_', ' ');
    const bool is_list = value.is_array() && !value.empty() && value.size() <= kMostListed &&
                         std::ranges::all_of(value, [](const Json& each) { return each.is_object(); });
    if (value.is_object()) {
      add_facts(value, name + " ", table);
    } else if (is_list) {
      for (size_t i = 0; i < value.size(); ++i) add_facts(value[i], cat(name, " ", i + 1, " "), table);
    } else {
      table.rows.push_back({text_cell(name), {fact_text(value), value}});
    }
  }
}

}  // namespace

Table facts_table(const Json& facts) {
  Table table{"", {{"name"}, {"value"}}, {}};
  add_facts(facts, "", table);
  return table;
}

Cell text_cell(std::string text) {
  Json value = text;
  return {std::move(text), std::move(value)};
}

Cell number_cell(std::optional<double> value, int decimals) {
  if (!value || !std::isfinite(*value)) return {};
  return {formatted("%.*f", decimals, *value), *value};
}

void mark_best(Table& table, size_t column, bool is_least) {
  std::optional<double> best;
  std::string text;
  for (const auto& row : table.rows) {
    const auto rank = rank_of(row.at(column));
    if (!rank || (best && (is_least ? *rank >= *best : *rank <= *best))) continue;
    best = rank;
    text = row[column].text;
  }
  for (auto& row : table.rows) row[column].is_best = best && row[column].text == text;
}

std::string table_text(const Table& table) {
  check(table);
  std::vector<std::vector<std::string>> lines(1);
  for (const Column& column : table.columns) lines[0].push_back(column.name);
  for (const auto& row : table.rows) {
    lines.emplace_back();
    for (size_t i = 0; i < row.size(); ++i) {
      const char* const mark = row[i].is_best ? "*" : has_best(table, i) ? " " : "";
      lines.back().push_back(row[i].text.empty() ? "-" : row[i].text + mark);
    }
  }
  std::vector<size_t> widths(table.columns.size());
  for (const auto& line : lines) {
    for (size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], num_characters(line[i]));
  }
  std::string text;
  for (const auto& line : lines) {
    std::string written;
    for (size_t i = 0; i < line.size(); ++i) {
      written += (i > 0 ? "  " : "") + padded(line[i], widths[i], table.columns[i].is_number);
    }
    written.erase(written.find_last_not_of(' ') + 1);
    text += written + "\n";
  }
  return text;
}

std::string table_csv(const Table& table) {
  check(table);
  std::vector<std::string> heading;
  std::vector<std::vector<std::string>> keys;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    keys.push_back(keys_of(table, i));
    if (keys[i].empty()) heading.push_back(csv_cell(key_of(table.columns[i])));
    for (const std::string& key : keys[i]) heading.push_back(csv_cell(cat(key_of(table.columns[i]), ' ', key)));
  }
  std::string text = csv_line(heading);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (size_t i = 0; i < row.size(); ++i) {
      const Json& value = row[i].value;
      if (keys[i].empty()) cells.push_back(csv_value(value));
      for (const std::string& key : keys[i]) {
        cells.push_back(value.is_object() && value.contains(key) ? csv_value(value[key]) : std::string());
      }
    }
    text += csv_line(cells);
  }
  return text;
}

Json table_json(const Table& table) {
  check(table);
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json object = Json::object();
    for (size_t i = 0; i < row.size(); ++i) object[key_of(table.columns[i])] = row[i].value;
    rows.push_back(std::move(object));
  }
  return {{"caption", table.caption}, {"rows", std::move(rows)}};
}

std::string table_latex(const Table& table) {
  check(table);
  std::string format, heading;
  for (const Column& column : table.columns) {
    if (column.begins_part) format += "|";
    format += column.is_number ? "r" : "l";
    heading += (heading.empty() ? "" : " & ") + latex_escaped(column.name);
  }
  // The table is scaled down if it is wider than the text of the page.
  constexpr const char* kNoWider = "\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{";
  std::string text = "% needs \\usepackage{booktabs,graphicx}\n\\begin{table}[t]\n\\centering\n";
  text += cat("\\caption{", latex_escaped(table.caption), "}\n", kNoWider, "\\begin{tabular}{", format,
              "}\n\\toprule\n", heading, " \\\\\n\\midrule\n");
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (const Cell& cell : row) cells.push_back(latex_cell(cell));
    text += join(cells, " & ") + " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}}\n\\end{table}\n";
}

}  // namespace e2lf::report
