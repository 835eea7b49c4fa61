// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/viewer.h"

#include <cstdio>
#include <thread>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/terminal/progress_bar.h"
#include "e2lf/view/page.h"
#include "e2lf/view/server.h"

namespace e2lf::cli {
namespace {

class ServedLiveView : public LiveView {
 public:
  ServedLiveView(std::string name, const std::filesystem::path& folder, view::Server server)
      : name_(std::move(name)), server_(std::move(server)) {
    cycles_->set_folder(folder);
    thread_ = std::thread([this] { result_ = server_.run(); });
  }
  ~ServedLiveView() override { end(); }

  void add(const std::string& cycle, lightfield::LightField light_field, const std::string& note) override {
    if (const auto fits = view::check_browser_memory(light_field.shape(), name_); !fits) {
      if (!has_warned_) log_warning("the light fields cannot be shown: " + fits.error().message);
      has_warned_ = true;
      return;
    }
    cycles_->add(cycle, std::move(light_field));
    notes_.push_back(note);
    show(/*is_growing=*/true);
  }

  void set_folder(const std::filesystem::path& folder) override { cycles_->set_folder(folder); }

  Result<void> finish() override {
    show(/*is_growing=*/false);
    if (!stop_requested()) {
      hide_progress();
      std::fprintf(stderr, "all cycles are done and shown at %s; press Ctrl-C to end\n", server_.url().c_str());
      thread_.join();
    }
    end();
    return result_;
  }

 private:
  void show(bool is_growing) {
    view::Document document;
    if (cycles_->size() > 0) document.add_light_field(name_, cycles_, notes_);
    if (is_growing) document.set_growing();
    server_.replace(std::move(document));
  }

  void end() {
    server_.end();
    if (thread_.joinable()) thread_.join();
  }

  std::string name_;
  std::shared_ptr<view::LightFieldCycles> cycles_ = std::make_shared<view::LightFieldCycles>();
  std::vector<std::string> notes_;
  view::Server server_;
  Result<void> result_;
  bool has_warned_ = false;
  std::thread thread_;
};

}  // namespace

bool has_viewer() {
  return true;
}

Result<void> require_viewer() {
  return {};
}

Result<std::unique_ptr<LiveView>> start_live_view(const std::string& name, const std::filesystem::path& folder,
                                                  uint16_t port) {
  view::Document nothing_yet;
  nothing_yet.set_growing();
  E2LF_ASSIGN_OR_RETURN(view::Server server, view::Server::create(std::move(nothing_yet), port));
  std::fprintf(stderr, "open %s in a browser to see each cycle when it is done\n", server.url().c_str());
  return std::unique_ptr<LiveView>(std::make_unique<ServedLiveView>(name, folder, std::move(server)));
}

Result<void> write_comparison_page(const std::filesystem::path& path, const Shown& truth, const Shown& reconstruction,
                                   const std::optional<depth::DisparityError>& error) {
  view::Document document;
  for (const auto& [name, shown] : {std::pair("scene", &truth), std::pair("reconstruction", &reconstruction)}) {
    const lightfield::Shape& shape = shown->light_field.shape();
    E2LF_RETURN_IF_ERROR(view::check_browser_memory(shape, path));
    const auto cycles = std::make_shared<view::LightFieldCycles>();
    cycles->add(name, shown->light_field);
    document.add_light_field(name, cycles);
    if (!error) continue;
    const depth::ViewIndex middle = depth::middle_view(shape);
    document.add_disparity(document.num_items() - 1, {shown->disparity}, middle.y, middle.x);
  }
  view::Quality quality = view::quality_of(truth.light_field, reconstruction.light_field);
  quality.disparity = error;
  quality.truth_source = "those of the scene";
  document.add_comparison(0, 1, {quality});
  return view::write_page(path, document);
}

}  // namespace e2lf::cli
