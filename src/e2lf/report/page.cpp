// SPDX-License-Identifier: MIT
#include "e2lf/report/page.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/report/chart.h"

namespace e2lf::report {
namespace {

constexpr const char* kStyle =
    // The colours of viewer/src/style.css.
    ":root{color-scheme:light dark;--ground:#f4f5f7;--surface:#fff;--ink:#16191d;--quiet:#626a75;--line:#d3d8df;"
    "--accent:#d9480f;--best:#e6f2e6}"
    "@media(prefers-color-scheme:dark){:root{--ground:#0e1013;--surface:#171a1f;--ink:#e8eaed;--quiet:#98a1ad;"
    "--line:#2c323b;--accent:#ff9a4d;--best:#1d3a1d}}"
    "*{box-sizing:border-box}body{margin:0;padding:0 12px 12px;background:var(--ground);color:var(--ink);"
    "font:14px/1.45 system-ui,sans-serif}"
    "h1{margin:0 -12px 12px;padding:6px 12px;font-size:16px;letter-spacing:.04em;color:var(--accent);"
    "background:var(--surface);border-bottom:1px solid var(--line)}h2{font-size:16px}h3,h4{font-size:14px}"
    "p{max-width:70em}table{border-collapse:collapse;margin:1em 0}.wide{overflow-x:auto}"
    "caption{caption-side:bottom;text-align:left;color:var(--quiet);padding-top:.4em}"
    "th,td{padding:.25em .8em;border-bottom:1px solid var(--line);text-align:left;white-space:nowrap}"
    ".number{text-align:right;font-variant-numeric:tabular-nums}.best{background:var(--best);font-weight:bold}"
    ".row{display:flex;flex-wrap:wrap;gap:1em}figure{margin:.5em 0;max-width:100%;overflow-x:auto}"
    ".chart{padding:12px;background:var(--surface);border:1px solid var(--line);border-radius:6px}"
    ".chart svg{width:100%}figcaption{color:var(--quiet)}img,svg{max-width:100%;height:auto}"
    "pre{overflow-x:auto;background:var(--surface);border:1px solid var(--line);padding:.6em}";

}  // namespace

Page::Page(std::string title) : title_(std::move(title)) {}

Page& Page::heading(std::string_view text, int level) {
  E2LF_REQUIRE(level >= 2 && level <= 4, "headings of a page have levels 2 to 4");
  body_ += cat("<h", level, ">", escaped(text), "</h", level, ">\n");
  return *this;
}

Page& Page::paragraph(std::string_view text) {
  body_ += cat("<p>", escaped(text), "</p>\n");
  return *this;
}

Page& Page::code(std::string_view text) {
  body_ += cat("<pre>", escaped(text), "</pre>\n");
  return *this;
}

Page& Page::table(const Table& table) {
  tables_.push_back(table);
  return add(table);
}

Page& Page::add(const Table& table) {
  body_ += "<div class=\"wide\"><table>\n";
  if (!table.caption.empty()) body_ += cat("<caption>", escaped(table.caption), "</caption>\n");
  body_ += "<thead><tr>";
  for (const Column& column : table.columns) {
    body_ += cat("<th", column.is_number ? " class=\"number\"" : "", ">", escaped(column.name), "</th>");
  }
  body_ += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    E2LF_REQUIRE(row.size() == table.columns.size(), "a row of a table must have a cell for each column");
    body_ += "<tr>";
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string kinds = cat(table.columns[i].is_number ? "number" : "", row[i].is_best ? " best" : "");
      body_ += cat("<td class=\"", kinds, "\">", escaped(row[i].text), "</td>");
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
  return *this;
}

Page& Page::begin_row() {
  body_ += "<div class=\"row\">\n";
  return *this;
}

Page& Page::end_row() {
  body_ += "</div>\n";
  return *this;
}

Page& Page::pictures(const std::vector<Picture>& pictures) {
  begin_row();
  for (const Picture& picture : pictures) {
    const std::string caption = escaped(picture.caption);
    body_ += cat("<figure><img alt=\"", caption, "\" src=\"data:image/png;base64,", base64(picture.png),
                 "\"><figcaption>", caption, "</figcaption></figure>\n");
  }
  return end_row();
}

Page& Page::drawing(std::string_view svg, std::string_view caption) {
  if (first_drawing_.empty()) first_drawing_ = svg;
  body_ += cat("<figure", is_chart(svg) ? " class=\"chart\">" : ">", svg);
  if (!caption.empty()) body_ += cat("<figcaption>", escaped(caption), "</figcaption>");
  body_ += "</figure>\n";
  return *this;
}

std::string Page::html() const {
  const std::string title = escaped(title_);
  return cat(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>",
      title, "</title><style>", kStyle, "</style></head><body>\n<h1>", title, "</h1>\n", body_, "</body></html>\n");
}

Result<void> check_extension(const std::filesystem::path& path) {
  for (const char* known : {".html", ".csv", ".tex", ".svg"}) {
    if (path.extension() == known) return {};
  }
  return fail(
      ErrorCode::kUnsupported, path,
      "reports are pages (.html), their tables (.csv, .tex) or their first chart (.svg); use one of these extensions");
}

Result<std::string> file_text(const Page& page, const std::filesystem::path& path) {
  E2LF_RETURN_IF_ERROR(check_extension(path));
  if (path.extension() == ".html") return page.html();
  if (path.extension() == ".svg") {
    if (page.first_drawing().empty())
      return fail(ErrorCode::kUnsupported, "", "there is no chart to write as .svg; write a page (.html)");
    return file_svg(page.first_drawing());
  }
  E2LF_REQUIRE(!page.tables().empty(), "a table can only be written to a page with tables");
  if (path.extension() == ".csv") return table_csv(page.tables().front());
  std::string text;
  for (const Table& table : page.tables()) text += (text.empty() ? "" : "\n") + table_latex(table);
  return text;
}

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Returns the size in bytes of the character at the beginning of `text`, or 0 if it is not one that XML allows.
size_t xml_character_size(std::string_view text) {
  const auto first = static_cast<uint8_t>(text[0]);
  const bool is_control = (first < 0x20 && first != '\t' && first != '\n' && first != '\r') || first == 0x7F;
  const bool is_refused = is_control || text.starts_with("\xEF\xBF\xBE") || text.starts_with("\xEF\xBF\xBF");
  for (size_t size = 1; size <= 4 && !is_refused; ++size) {
    if (is_utf8(text.substr(0, size))) return size;
  }
  return 0;
}

using Replacement = std::pair<char, const char*>;
constexpr Replacement kHtml[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
constexpr Replacement kLatex[] = {{'&', "\\&"},
                                  {'%', "\\%"},
                                  {'$', "\\$"},
                                  {'#', "\\#"},
                                  {'_', "\\_"},
                                  {'{', "\\{"},
                                  {'}', "\\}"},
                                  {'~', "\\textasciitilde{}"},
                                  {'^', "\\textasciicircum{}"},
                                  {'\\', "\\textbackslash{}"},
                                  {'<', "\\textless{}"},
                                  {'>', "\\textgreater{}"},
                                  {'|', "\\textbar{}"},
                                  {'"', "\\textquotedbl{}"},
                                  {'\n', " "},
                                  {'\r', " "},
                                  {'\t', " "}};

/// Replaces characters. Invalid ones become U+FFFD.
std::string replaced(std::string_view text, std::span<const Replacement> replacements) {
  std::string result;
  while (!text.empty()) {
    const size_t length = xml_character_size(text);
    const auto found = std::ranges::find(replacements, text[0], &Replacement::first);
    if (length == 0) {
      result += kReplacement;
    } else if (found != replacements.end()) {
      result += found->second;
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(std::max<size_t>(length, 1));
  }
  return result;
}

}  // namespace

std::string escaped(std::string_view text) {
  return replaced(text, kHtml);
}

std::string latex_escaped(std::string_view text) {
  return replaced(text, kLatex);
}

size_t num_characters(std::string_view text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<uint8_t>(c) & 0xC0U) != 0x80U; }));
}

std::string base64(std::span<const uint8_t> bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (size_t k = 0; k < 4; ++k) text += k <= count ? kLetters[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace e2lf::report
