// SPDX-License-Identifier: MIT
#include "e2lf/view/page.h"

#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/report/page.h"

// These symbols are defined in page_bytes.S.
extern "C" {
extern const char kPageBegin[] asm("e2lf_view_page_begin");
extern const char kPageEnd[] asm("e2lf_view_page_end");
}

namespace e2lf::view {
namespace {

constexpr std::string_view kPlace = "<!--e2lf-data-->";

}  // namespace

std::string_view empty_page() {
  return {kPageBegin, kPageEnd};
}

Result<void> write_page(const std::filesystem::path& path, const Document& document, const ProgressFn& progress) {
  const std::string_view page = empty_page();
  const size_t place = page.find(kPlace);
  E2LF_REQUIRE(place != std::string_view::npos, "the page has a place for data");
  std::ofstream out(path, std::ios::binary);
  out << page.substr(0, place) << "<script type=\"application/json\" id=\"e2lf-document\">" << document.description()
      << "</script>\n";
  for (size_t number = 0; number < document.parts().size(); ++number) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, document.parts()[number]());
    out << "<script type=\"text/plain\" id=\"e2lf-part-" << number << "\">" << report::base64(bytes) << "</script>\n";
    if (progress) progress(number + 1, document.parts().size());
  }
  out << page.substr(place + kPlace.size());
  if (!out.flush()) return Error{ErrorCode::kIo, "cannot write; check space and permissions", path.string()};
  return {};
}

}  // namespace e2lf::view
