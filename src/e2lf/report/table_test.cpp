// SPDX-License-Identifier: MIT
#include "e2lf/report/table.h"

#include <cmath>
#include <gtest/gtest.h>

namespace e2lf::report {
namespace {

Table two_methods() {
  Table table;
  table.caption = "PSNR & SSIM";
  table.columns = {{"method"}, {"EPFL", true, true}, {"HCI (new)", true}};
  table.rows = {{text_cell("e2lf_n4"), number_cell(28.734, 2), number_cell(30.0, 2)},
                {text_cell("50 % {x}"), number_cell(29.5, 2), {}}};
  mark_best(table, 1);
  return table;
}

TEST(Table, TextHasEvenColumns) {
  EXPECT_EQ(table_text(two_methods()),
            "method      EPFL  HCI (new)\n"
            "e2lf_n4   28.73       30.00\n"
            "50 % {x}  29.50*          -\n");
}

TEST(Table, TextCountsCharactersAndNotBytes) {
  Table table;
  table.columns = {{"a"}, {"b"}};
  table.rows = {{text_cell("\xC3\xA4\xC3\xB6"), text_cell("1")}, {text_cell("xy"), text_cell("2")}};
  EXPECT_EQ(table_text(table), "a   b\n\xC3\xA4\xC3\xB6  1\nxy  2\n");
}

TEST(Table, CsvHasFullValuesAndQuotesOddNames) {
  Table table;
  table.columns = {{"a,b"}, {"psnr", true}};
  table.rows = {{text_cell("say \"hi\""), number_cell(28.734, 1)}, {text_cell("two\nlines"), {}}};
  EXPECT_EQ(table_csv(table), "\"a,b\",psnr\r\n\"say \"\"hi\"\"\",28.734\r\n\"two\nlines\",\r\n");
}

TEST(Table, CsvSplitsObjects) {
  Table table;
  table.columns = {{"method"}, {"EPFL", true}};
  table.rows = {{text_cell("a"), {"28.40/0.8330", {{"psnr_db", 28.4}, {"ssim", 0.833}}}}, {text_cell("b"), {}}};
  EXPECT_EQ(table_csv(table), "method,EPFL psnr_db,EPFL ssim\r\na,28.4,0.833\r\nb,,\r\n");
}

TEST(Table, JsonKeepsNumbersAndNull) {
  const Json json = table_json(two_methods());
  EXPECT_EQ(json["rows"][0]["EPFL"], 28.734);
  EXPECT_TRUE(json["rows"][1]["HCI (new)"].is_null());
}

TEST(Table, LatexIsEscapedAndBold) {
  EXPECT_EQ(table_latex(two_methods()),
            "% needs \\usepackage{booktabs,graphicx}\n\\begin{table}[t]\n\\centering\n\\caption{PSNR \\& SSIM}\n"
            "\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{"
            "\\begin{tabular}{l|rr}\n\\toprule\nmethod & EPFL & HCI (new) \\\\\n\\midrule\n"
            "e2lf\\_n4 & 28.73 & 30.00 \\\\\n50 \\% \\{x\\} & \\textbf{29.50} & -- \\\\\n"
            "\\bottomrule\n\\end{tabular}}\n\\end{table}\n");
}

TEST(Table, EqualTextsShareTheMark) {
  Table table;
  table.columns = {{"n", true}};
  table.rows = {{number_cell(1.001, 2)}, {number_cell(1.0, 2)}, {number_cell(0.5, 2)}, {number_cell(NAN, 2)}};
  mark_best(table, 0);
  EXPECT_TRUE(table.rows[0][0].is_best && table.rows[1][0].is_best);
  EXPECT_FALSE(table.rows[2][0].is_best || table.rows[3][0].is_best);
  mark_best(table, 0, /*is_least=*/true);
  EXPECT_FALSE(table.rows[0][0].is_best);
  EXPECT_TRUE(table.rows[2][0].is_best);
}

TEST(FactsTable, HasALineForEachValue) {
  const Json facts = {{"least_confidence", 0.5},
                      {"found", {{"complete", 3}, {"is_live", true}, {"channels", {1, 2}}}},
                      {"nothing", nullptr},
                      {"rows", Json::array({{{"a", 1}}, {{"a", 2}}})}};
  std::vector<std::string> lines;
  for (const auto& row : facts_table(facts).rows) lines.push_back(row[0].text + ": " + row[1].text);
  EXPECT_THAT(lines, testing::UnorderedElementsAre("least confidence: 0.5", "found complete: 3", "found is live: yes",
                                                   "found channels: 1, 2", "nothing: -", "rows 1 a: 1", "rows 2 a: 2"));
}

}  // namespace
}  // namespace e2lf::report
