// SPDX-License-Identifier: MIT
#include "e2lf/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::span<const uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(base64(bytes_of("")), "");
  EXPECT_EQ(base64(bytes_of("f")), "Zg==");
  EXPECT_EQ(base64(bytes_of("fo")), "Zm8=");
  EXPECT_EQ(base64(bytes_of("foo")), "Zm9v");
  EXPECT_EQ(base64(bytes_of("foobar")), "Zm9vYmFy");
  EXPECT_EQ(base64(bytes_of("\xFF\xFE\xFD")), "//79");
}

TEST(Escaped, MarkupBecomesEntities) {
  EXPECT_EQ(escaped("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Escaped, KeepsUtf8AndReplacesWhatIsNone) {
  EXPECT_EQ(escaped("\xCE\xB5\xE2\x82\xAC\xF0\x9F\x98\x80"), "\xCE\xB5\xE2\x82\xAC\xF0\x9F\x98\x80");
  EXPECT_EQ(escaped("caf\xE9"), "caf\xEF\xBF\xBD");
  EXPECT_EQ(escaped("\xC0\x80x"), "\xEF\xBF\xBD\xEF\xBF\xBDx");            // an overlong zero
  EXPECT_EQ(escaped("\xED\xA0\x80").find("\xED\xA0"), std::string::npos);  // half of a surrogate pair
  EXPECT_EQ(escaped(std::string("a\0b\x1B", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
}

TEST(LatexEscaped, SpecialsAreWritten) {
  EXPECT_EQ(latex_escaped("50% & $x_1^2$ {#} ~\\"),
            "50\\% \\& \\$x\\_1\\textasciicircum{}2\\$ \\{\\#\\} \\textasciitilde{}\\textbackslash{}");
  EXPECT_EQ(latex_escaped("a\nb"), "a b");
}

TEST(NumCharacters, CountsCharacters) {
  EXPECT_EQ(num_characters("a\xCE\xB5\xF0\x9F\x98\x80"), 3U);
}

TEST(Page, HoldsEverythingAndEscapesTexts) {
  Table table;
  table.columns = {{"<method>"}, {"n", true}};
  table.rows = {{text_cell("a&b"), number_cell(1, 1)}};
  const std::string png = "\x89PNG";
  Page page("a <title>");
  page.heading("one")
      .paragraph("x < y")
      .code("e2lf 'a'")
      .table(table)
      .pictures({{{png.begin(), png.end()}, "\"quoted\""}});
  page.drawing("<svg></svg>", "under & over");
  const std::string html = page.html();
  for (const char* part :
       {"<h1>a &lt;title&gt;</h1>", "<h2>one</h2>", "<p>x &lt; y</p>", "<pre>e2lf &#39;a&#39;</pre>", "&lt;method&gt;",
        "a&amp;b", "src=\"data:image/png;base64,iVBORw==\"", "alt=\"&quot;quoted&quot;\"", "<svg></svg>",
        "under &amp; over", "prefers-color-scheme:dark"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

TEST(FileText, IsThePageOrItsTables) {
  Table first{"one", {{"n", true, false, "number"}}, {{number_cell(1.25, 1)}}};
  Table second{"two", {{"m"}}, {{text_cell("x")}}};
  Page page("title");
  page.facts({{"threads", 2}}).table(first).table(second);
  EXPECT_EQ(file_text(page, "a.html").value(), page.html());
  EXPECT_EQ(file_text(page, "a.csv").value(), "number\r\n1.25\r\n");
  const std::string latex = file_text(page, "a.tex").value();
  EXPECT_LT(latex.find("\\caption{one}"), latex.find("\\caption{two}"));
  EXPECT_THAT(latex, Not(HasSubstr("threads")));
}

TEST(ReportFile, FormatIsTheExtension) {
  for (const char* known : {"a/b.html", "b.csv", "b.tex"}) EXPECT_TRUE(check_extension(known)) << known;
  const auto other = check_extension("b.pdf");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::report
