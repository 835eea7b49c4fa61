// SPDX-License-Identifier: MIT
#include "e2lf/view/document.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <zlib.h>

#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_picture.h"
#include "e2lf/eval/report.h"
#include "e2lf/recordings/event_counters.h"
#include "e2lf/report/page.h"
#include "e2lf/report/table.h"

// These symbols are defined in page_bytes.S.
extern "C" {
extern const char kPageBegin[] asm("e2lf_view_page_begin");
extern const char kPageEnd[] asm("e2lf_view_page_end");
}

namespace e2lf::view {
namespace {

Json codes_json(const capture::Codes& codes) {
  Json patterns = Json::array();
  for (size_t n = 0; n < codes.num_patterns; ++n) patterns.push_back(codes.pattern(n));
  return {{"views", {codes.views_y, codes.views_x}}, {"patterns", std::move(patterns)}};
}

Json numbers_or_null(const std::vector<double>& values) {
  Json numbers = Json::array();
  for (const double value : values) numbers.push_back(finite_or_null(std::round(value * 1000.0) / 1000.0));
  return numbers;
}

constexpr int16_t kUnknownDisparity = -32768;

std::vector<int16_t> thousandths(const lightfield::Image& map) {
  std::vector<int16_t> numbers;
  numbers.reserve(map.pixels.size());
  for (const float value : map.pixels) {
    const float most = 32.0F;
    numbers.push_back(std::isfinite(value) ? static_cast<int16_t>(std::lround(1000.0F * std::clamp(value, -most, most)))
                                           : kUnknownDisparity);
  }
  return numbers;
}

/// Returns the name and the value of each row of `e2lf model info`.
Json facts_of(const model::Model& model) {
  Json facts = Json::array();
  for (const auto& row : report::facts_table(model::summary_json(model)).rows) {
    facts.push_back({row[0].text, row[1].text});
  }
  return facts;
}

}  // namespace

size_t Document::add_part(Part part) {
  parts_.push_back(std::move(part));
  return parts_.size() - 1;
}

void Document::add_light_field(const std::string& name, const std::shared_ptr<LightFieldCycles>& cycles) {
  const lightfield::Shape shape = cycles->shape();
  Json described = Json::array();
  for (size_t cycle = 0; cycle < cycles->size(); ++cycle) {
    Json views = Json::array();
    for (size_t view = 0; view < shape.num_views(); ++view) {
      views.push_back(add_part([cycles, cycle, view] { return cycles->png(cycle, view); }));
    }
    described.push_back({{"label", cycles->label(cycle)}, {"views", std::move(views)}});
  }
  add_item({{"kind", "light_field"},
            {"name", name},
            {"views", {shape.views_y, shape.views_x}},
            {"height", shape.height},
            {"width", shape.width},
            {"channels", shape.channels},
            {"cycles", std::move(described)}});
}

void Document::add_disparity(size_t item, const DisparityMaps& disparity) {
  const auto& [maps, view, confidences] = disparity;
  Json& field = items_.at(item);
  E2LF_REQUIRE(confidences.empty() || confidences.size() == maps.size(), "each map has its confidences");
  lightfield::Image all, confidence_of_all;
  const auto append = [](const lightfield::Image& image, lightfield::Image& to) {
    to.pixels.insert(to.pixels.end(), image.pixels.begin(), image.pixels.end());
  };
  for (const lightfield::Image& map : maps) {
    E2LF_REQUIRE(field["height"] == map.height && field["width"] == map.width, "a map has the size of the views");
    append(map, all);
  }
  for (const lightfield::Image& confidence : confidences) append(confidence, confidence_of_all);
  const depth::DisparityRange range =
      confidences.empty() ? depth::shown_range(all) : depth::shown_range(all, confidence_of_all);
  const auto add_parts = [&](const std::vector<lightfield::Image>& images) {
    Json parts = Json::array();
    for (const lightfield::Image& image : images) parts.push_back(add_part(counts_part(thousandths(image))));
    return parts;
  };
  field["disparity"] = {{"view", {view.y, view.x}},
                        {"range", {json_number(range.least), json_number(range.most)}},
                        {"maps", add_parts(maps)}};
  if (!confidences.empty()) field["disparity"]["confidences"] = add_parts(confidences);
}

void Document::add_event_images(const std::string& name, const std::vector<capture::EventImages>& cycles,
                                const capture::Codes* codes) {
  Json described = Json::array();
  for (size_t cycle = 0; cycle < cycles.size(); ++cycle) {
    described.push_back({{"label", cat("cycle ", cycle)}, {"counts", add_part(counts_part(cycles[cycle].values))}});
  }
  const capture::EventImages& first = cycles.front();
  Json item = {{"kind", "event_images"}, {"name", name},         {"transitions", first.count},
               {"height", first.height}, {"width", first.width}, {"cycles", std::move(described)}};
  if (codes != nullptr && codes->num_patterns == first.count + 1) item["codes"] = codes_json(*codes);
  add_item(std::move(item));
}

void Document::add_model(const model::Model& model) {
  Json item = {{"kind", "model"},
               {"name", model.name},
               {"facts", facts_of(model)},
               {"is_of_depth", model::is_depth_network(model)}};
  if (model.codes) item["codes"] = codes_json(*model.codes);
  add_item(std::move(item));
}

void Document::add_comparison(size_t first, size_t second, const std::vector<Quality>& cycles) {
  Json described = Json::array();
  for (const Quality& quality : cycles) {
    described.push_back({{"psnr_db", numbers_or_null(quality.psnr_db)},
                         {"tone", {quality.tone.gain, quality.tone.black}},
                         {"toned_psnr_db", numbers_or_null(quality.toned_psnr_db)}});
    if (!quality.disparity) continue;
    described.back()["disparity"] = eval::to_json(*quality.disparity);
    described.back()["disparity"]["source"] = quality.truth_source;
  }
  comparisons_.push_back({{"first", first}, {"second", second}, {"cycles", std::move(described)}});
}

std::string Document::description() const {
  Json json = {{"format", "e2lf-view"}, {"version", 1}, {"items", items_}, {"comparisons", comparisons_}};
  if (is_growing_) json["is_growing"] = true;
  // The text must not contain "</script>", which would end the element.
  std::string text;
  for (const char letter : json_line(json)) text += letter == '<' ? "\\u003c" : std::string(1, letter);
  return text;
}

Part counts_part(std::span<const int16_t> counts) {
  static_assert(std::endian::native == std::endian::little);
  uLongf size = compressBound(counts.size_bytes());
  auto bytes = std::make_shared<std::vector<uint8_t>>(size);
  const int code =
      compress2(bytes->data(), &size, reinterpret_cast<const Bytef*>(counts.data()), counts.size_bytes(), Z_BEST_SPEED);
  E2LF_REQUIRE(code == Z_OK, "zlib compresses into a buffer of compressBound() bytes");
  bytes->resize(size);
  bytes->shrink_to_fit();
  return [bytes]() -> Result<std::vector<uint8_t>> { return *bytes; };
}

namespace {

constexpr size_t kRateBins = 2000;
constexpr size_t kMostTriggers = 20000;  // the most that are drawn

/// The results of a first pass over a recording.
struct Overview {
  recordings::RecordingInfo info = {};
  size_t width = 0, height = 0;
  uint64_t num_events = 0;
  int64_t begin_us = 0, end_us = 0;
  recordings::EventRate rate = {};
  std::vector<recordings::Trigger> triggers = {};
};

Result<Overview> survey(const RecordingSource& source, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const auto reader, source.open(0, 0));
  Overview overview{.info = reader->info()};
  recordings::EventRateCounter counter(kRateBins);
  recordings::EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) break;
    counter.add(batch);
    for (const uint16_t x : batch.events.x) overview.width = std::max<size_t>(overview.width, x + 1U);
    for (const uint16_t y : batch.events.y) overview.height = std::max<size_t>(overview.height, y + 1U);
    for (const recordings::Trigger& trigger : batch.triggers) {
      if (overview.triggers.size() < kMostTriggers) overview.triggers.push_back(trigger);
    }
  }
  const recordings::DecodeSummary summary = reader->summary();
  overview.num_events = summary.events();
  if (overview.num_events == 0) {
    return fail(ErrorCode::kInvalidValue, name, "the recording holds no events; there is nothing to show");
  }
  if (overview.info.width != 0) {
    overview.width = overview.info.width;
    overview.height = overview.info.height;
  }
  overview.begin_us = summary.first_t_us;
  overview.end_us = summary.last_t_us + 1;
  overview.rate = counter.rate();
  return overview;
}

class Frames {
 public:
  Frames(Document& document, const Overview& overview, size_t num_frames)
      : document_(document),
        begin_us_(overview.begin_us),
        length_us_(overview.end_us - overview.begin_us),
        count_(std::min(static_cast<int64_t>(num_frames), length_us_)),
        image_(1, overview.height, overview.width) {}

  /// Adds events except the first `first` ones.
  void add(const recordings::EventColumns& events, size_t first = 0) {
    num_events_ += events.size() - first;
    for (size_t i = first; i < events.size(); ++i) {
      while (events.t[i] - begin_us_ >= edge_us(frame_ + 1)) finish();
      if (events.x[i] >= image_.width || events.y[i] >= image_.height) continue;
      int16_t& count = image_.values[events.y[i] * image_.width + events.x[i]];
      count = capture::saturated(count + (events.p[i] != 0 ? 1 : -1));
    }
  }

  [[nodiscard]] uint64_t num_events() const { return num_events_; }

  Json take() {
    while (frame_ < count_) finish();
    return std::move(frames_);
  }

 private:
  [[nodiscard]] int64_t edge_us(int64_t frame) const {
    return length_us_ / count_ * frame + length_us_ % count_ * frame / count_;
  }

  void finish() {
    frames_.push_back({{"begin_us", edge_us(frame_)},
                       {"end_us", edge_us(frame_ + 1)},
                       {"counts", document_.add_part(counts_part(image_.values))}});
    std::fill(image_.values.begin(), image_.values.end(), int16_t{0});
    ++frame_;
  }

  Document& document_;
  int64_t begin_us_, length_us_, count_, frame_ = 0;
  uint64_t num_events_ = 0;
  capture::EventImages image_;
  Json frames_ = Json::array();
};

/// Adds the events that `frames` has not received yet.
Result<void> add_remaining(const RecordingSource& source, const Overview& overview, Frames& frames) {
  if (frames.num_events() == overview.num_events) return {};
  E2LF_ASSIGN_OR_RETURN(const auto reader, source.open(overview.width, overview.height));
  recordings::EventBatch batch;
  for (uint64_t known = frames.num_events();;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch));
    if (!more) return {};
    const size_t skipped = std::min<uint64_t>(known, batch.events.size());
    known -= skipped;
    frames.add(batch.events, skipped);
  }
}

/// Returns the cycles that can be found, and adds the events that are read to `frames`. The absence of cycles is not an
/// error for a viewer.
Json found_cycles(const RecordingSource& source, int64_t origin_us, Frames& frames) {
  Json cycles = Json::array();
  if (!source.open_cycles) return cycles;
  auto reader = source.open_cycles([&frames](const recordings::EventBatch& batch) { frames.add(batch.events); });
  if (!reader) return cycles;
  for (;;) {
    const auto cycle = reader->next();
    if (!cycle || !*cycle) return cycles;
    Json slices = Json::array();
    for (const cycles::TimeSlice& slice : (*cycle)->slices) {
      slices.push_back({slice.begin_us - origin_us, slice.end_us - origin_us});
    }
    cycles.push_back(
        {{"number", (*cycle)->number}, {"confidence", (*cycle)->confidence}, {"slices", std::move(slices)}});
  }
}

}  // namespace

Result<void> add_recording(Document& document, const std::string& name, const RecordingSource& source,
                           size_t num_frames) {
  E2LF_ASSIGN_OR_RETURN(const Overview overview, survey(source, name));
  Frames frames(document, overview, num_frames);
  const Json cycles = found_cycles(source, overview.begin_us, frames);
  E2LF_RETURN_IF_ERROR(add_remaining(source, overview, frames));
  Json triggers = Json::array();
  for (const recordings::Trigger& trigger : overview.triggers) {
    triggers.push_back({trigger.t - overview.begin_us, trigger.p, trigger.id});
  }
  document.add_item({{"kind", "recording"},
                     {"name", name},
                     {"format", overview.info.format},
                     {"height", overview.height},
                     {"width", overview.width},
                     {"events", overview.num_events},
                     {"origin_us", overview.begin_us},
                     {"frames", frames.take()},
                     {"rate",
                      {{"begin_us", overview.rate.begin_us - overview.begin_us},
                       {"bin_us", overview.rate.bin_us},
                       {"on", overview.rate.on},
                       {"off", overview.rate.off}}},
                     {"triggers", triggers},
                     {"cycles", cycles}});
  return {};
}

Quality quality_of(const lightfield::LightField& truth, const lightfield::LightField& reconstruction) {
  Quality quality{eval::psnr_of_views(truth, reconstruction), eval::best_tone(truth, reconstruction), {}};
  lightfield::LightField toned = reconstruction;
  for (float& value : toned.data()) value = (value - quality.tone.black) * quality.tone.gain;
  quality.toned_psnr_db = eval::psnr_of_views(truth, toned);
  return quality;
}

Quality quality_of_pictures(lightfield::LightField truth, lightfield::LightField reconstruction) {
  for (lightfield::LightField* const field : {&truth, &reconstruction}) {
    for (float& value : field->data()) value = std::clamp(value, 0.0F, 1.0F);
  }
  return quality_of(truth, reconstruction);
}

std::string_view empty_page() {
  return {kPageBegin, kPageEnd};
}

Result<void> write_page(const std::filesystem::path& path, const Document& document, const ProgressFn& progress) {
  const std::string_view page = empty_page();
  constexpr std::string_view kPlace = "<!--e2lf-data-->";
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
  if (!out.flush()) return fail(ErrorCode::kIo, path, "cannot write; check space and permissions");
  return {};
}

}  // namespace e2lf::view
