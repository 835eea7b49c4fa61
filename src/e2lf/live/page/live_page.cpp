// SPDX-License-Identifier: MIT
#include "e2lf/live/page/live_page.h"

#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "e2lf/base/guarded.h"
#include "e2lf/base/text.h"
#include "e2lf/live/live_requests.h"
#include "e2lf/view/document.h"
#include "e2lf/view/server.h"

namespace e2lf::live {
namespace {

using FrozenField = std::shared_ptr<view::LightFieldCycles>;

view::Response refusal(const std::string& text) {
  return {409, "text/plain", text};
}

FrozenField keep(lightfield::LightField light_field) {
  auto kept = std::make_shared<view::LightFieldCycles>();
  kept->add("cycle", std::move(light_field));
  return kept;
}

class ServedLivePage {
 public:
  ServedLivePage(Session& session, FineMethod fine, std::shared_ptr<recordings::RunningCamera> camera)
      : session_(session), method_(std::move(fine)), camera_(std::move(camera)) {}
  ServedLivePage(const ServedLivePage&) = delete;
  ServedLivePage& operator=(const ServedLivePage&) = delete;
  ~ServedLivePage() {
    if (server_) server_->end();
    for (std::thread* thread : {&serving_, &refining_}) {
      if (thread->joinable()) thread->join();
    }
  }

  Result<void> start(uint16_t port) {
    E2LF_ASSIGN_OR_RETURN(server_, view::Server::create(document(), port, [this](const auto& request) {
                            return guarded_answer(request);
                          }));
    serving_ = guarded_thread([this] { return result_ = server_->run(); },
                              [this](const Error& error) { result_ = error; }, [] {});
    return {};
  }

  [[nodiscard]] std::string url() const { return server_->url(); }

  Result<void> finish() {
    serving_.join();
    return result_;
  }

 private:
  /// An exception must not leave the thread of a connection, because it would end the recording.
  std::optional<view::Response> guarded_answer(const view::Request& request) {
    auto answered = guarded([&]() -> Result<std::optional<view::Response>> { return answer(request); });
    return answered ? *std::move(answered) : refusal(answered.error().message);
  }

  std::optional<view::Response> answer(const view::Request& request) {
    if (request.is_command && request.name == "freeze") return freeze();
    if (request.is_command && request.name == "fine") return refine();
    if (request.is_command && request.name == "camera") return change_camera(request.parameters);
    if (!request.is_command && request.name == "statistics") return statistics();
    auto answered = live::answer(session_, request.is_command, request.name, request.parameters);
    if (!answered) return std::nullopt;
    return view::Response{answered->status, std::move(answered->type), std::move(answered->body)};
  }

  view::Response change_camera(const std::map<std::string, std::string>& parameters) {
    const auto text = [&](const char* name) {
      const auto found = parameters.find(name);
      return found == parameters.end() ? std::string() : found->second;
    };
    const Result<void> changed = camera_->change(text("name"), text("value"));
    return changed ? made(Json::object()) : refusal(changed.error().message);
  }

  view::Response statistics() {
    Json json = live::statistics(session_);
    json["camera"] = Json::array();
    for (const recordings::CameraControl& control : camera_->controls()) {
      json["camera"].push_back(
          {{"name", control.name}, {"value", control.value}, {"least", control.least}, {"most", control.most}});
    }
    const std::lock_guard lock(mutex_);
    json["is_refining"] = is_refining_;
    json["refining_error"] = refining_error_;
    return made(json);
  }

  static view::Response made(const Json& json) {
    return {200, "application/json", json.dump(-1, ' ', false, Json::error_handler_t::replace)};
  }

  view::Response freeze() {
    auto now = session_.freeze();
    if (!now) return refusal(now.error().message);
    if (const auto fits = view::check_browser_memory(now->light_field.shape(), "frozen"); !fits) {
      return refusal(fits.error().message);
    }
    FrozenField kept = keep(std::move(now->light_field));
    now->light_field = {};
    const std::lock_guard lock(mutex_);
    frozen_ = std::move(*now);
    quick_ = std::move(kept);
    fine_.reset();
    server_->replace(document());
    return made({{"name", frozen_name()}});
  }

  /// Reconstructs the frozen cycle again in a separate thread.
  view::Response refine() {
    std::string name;
    {
      const std::lock_guard lock(mutex_);
      if (is_refining_) return refusal("a reconstruction is in progress");
      if (!quick_) return refusal("nothing is frozen yet");
      is_refining_ = true;
      refining_error_.clear();
      name = fine_name();
    }
    if (refining_.joinable()) refining_.join();
    refining_ = guarded_thread([this] { return refine_frozen(); },
                               [this](const Error& error) {
                                 const std::lock_guard lock(mutex_);
                                 refining_error_ = error.text();
                               },
                               [this] {
                                 const std::lock_guard lock(mutex_);
                                 is_refining_ = false;
                               });
    return made({{"name", name}});
  }

  Result<void> refine_frozen() {
    std::unique_lock lock(mutex_);
    const LiveField frozen = frozen_;
    lock.unlock();
    E2LF_ASSIGN_OR_RETURN(lightfield::LightField refined, method_(frozen));
    lock.lock();
    if (frozen.serial != frozen_.serial) {
      return fail(ErrorCode::kCancelled, "", "another light field was frozen in the meantime");
    }
    fine_ = keep(std::move(refined));
    enlarge_quick();
    server_->replace(document());
    return {};
  }

  /// Gives the frozen light field the size of the one that was reconstructed well, so that both are compared.
  void enlarge_quick() {
    const lightfield::Shape& size = fine_->shape();
    const auto small = quick_->read(0);
    if (quick_->shape() == size || !small) return;
    quick_ = keep(enlarged(**small, size.height, size.width));
  }

  [[nodiscard]] std::string frozen_name() const { return cat("cycle ", frozen_.cycle.number); }
  [[nodiscard]] std::string fine_name() const { return frozen_name() + ", reconstructed well"; }

  /// Returns the current content of the page. mutex_ must be locked unless the server has not started yet.
  [[nodiscard]] view::Document document() const {
    const recordings::RecordingInfo& info = session_.reader().cycles().recording().info();
    const model::Model& model = session_.model();
    const Json about = {{"width", info.width}, {"height", info.height}, {"views", {model.views_y, model.views_x}}};
    view::Document document;
    for (const auto& [kind, name] : {std::pair{"live_setup", "Set up"}, std::pair{"live_field", "Light field"}}) {
      Json item = about;
      item["kind"] = kind;
      item["name"] = name;
      document.add_item(std::move(item));
    }
    document.set_growing();
    if (!quick_) return document;
    document.add_light_field(frozen_name(), quick_);
    if (!fine_) return document;
    document.add_light_field(fine_name(), fine_);
    if (!(fine_->shape() == quick_->shape())) return document;
    const auto fine = fine_->read(0), quick = quick_->read(0);
    if (fine && quick) document.add_comparison(3, 2, {view::quality_of_pictures(**fine, **quick)});
    return document;
  }

  Session& session_;
  FineMethod method_;
  std::shared_ptr<recordings::RunningCamera> camera_;
  std::mutex mutex_;
  LiveField frozen_;  ///< without its views
  FrozenField quick_, fine_;
  bool is_refining_ = false;
  std::string refining_error_;
  std::unique_ptr<view::Server> server_;
  Result<void> result_;
  std::thread serving_, refining_;
};

}  // namespace

Result<LivePage> start_live_page(Session& session, FineMethod fine, std::shared_ptr<recordings::RunningCamera> camera,
                                 uint16_t port) {
  const auto page = std::make_shared<ServedLivePage>(session, std::move(fine), std::move(camera));
  E2LF_RETURN_IF_ERROR(page->start(port));
  return LivePage{page->url(), [page] { return page->finish(); }};
}

}  // namespace e2lf::live
