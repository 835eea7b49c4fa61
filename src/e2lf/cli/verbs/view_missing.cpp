// SPDX-License-Identifier: MIT
// e2lf view, reconstruct --view and the pages of the demo and of e2lf live in a build without the viewer
#include "e2lf/cli/output/comparison_page.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/live_page.h"
#include "e2lf/cli/verbs/live_view.h"

namespace e2lf::cli {
namespace {

Error no_viewer() {
  return {ErrorCode::kMissingDependency,
          "this build has no viewer; install npm and libcpp-httplib-dev, configure and build again",
          {}};
}

}  // namespace

bool has_viewer() {
  return false;
}

Result<void> write_comparison_page(const std::filesystem::path& /*path*/, const lightfield::LightField& /*truth*/,
                                   const lightfield::LightField& /*reconstruction*/) {
  return no_viewer();
}

class LiveView::Impl {};
LiveView::LiveView(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveView::LiveView(LiveView&&) noexcept = default;
LiveView::~LiveView() = default;

Result<LiveView> LiveView::start(const std::string& /*name*/, const std::filesystem::path& /*folder*/,
                                 uint16_t /*port*/) {
  return no_viewer();
}

void LiveView::add(const std::string& /*cycle*/, lightfield::LightField /*light_field*/, const std::string& /*note*/) {}

void LiveView::set_folder(const std::filesystem::path& /*folder*/) {}

Result<void> LiveView::finish() {
  return {};
}

class LivePage::Impl {};
LivePage::LivePage(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LivePage::LivePage(LivePage&&) noexcept = default;
LivePage::~LivePage() = default;

Result<LivePage> LivePage::start(live::Session& /*session*/, FineMethod /*fine*/, uint16_t /*port*/) {
  return no_viewer();
}

std::string LivePage::url() const {
  return "";
}

Result<void> LivePage::finish() {
  return {};
}

int run_view(const std::vector<std::string>& arguments) {
  Verb verb("view", "Show light fields, events, recordings and models in a browser. This build has no viewer.",
            "./run e2lf view out/demo/recon");
  verb.app().allow_extras();
  return verb.run(arguments, []() -> Result<void> { return no_viewer(); });
}

}  // namespace e2lf::cli
