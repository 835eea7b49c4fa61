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

/// Returns the size of the views in graphics memory: one byte per grey pixel, and four per colour pixel.
uint64_t browser_bytes(const lightfield::Shape& shape) {
  return uint64_t{shape.num_views()} * shape.height * shape.width * (shape.channels == 1 ? 1 : 4);
}

}  // namespace

Result<void> check_browser_memory(const lightfield::Shape& shape, const std::filesystem::path& path) {
  if (browser_bytes(shape) <= LightFieldCycles::kMostBytes) return {};
  return Error{ErrorCode::kUnsupported,
               cat("its ", shape.num_views(), " views need ", browser_bytes(shape) >> 20,
                   " MiB in the browser, more than ", LightFieldCycles::kMostBytes >> 20, "; show fewer"),
               path.string(), "views"};
}

Result<std::shared_ptr<LightFieldCycles>> LightFieldCycles::open(const std::filesystem::path& path,
                                                                 const lightfield::ReadOptions& options) {
  std::vector<std::filesystem::path> paths = lightfield::cycle_folders(path);
  if (paths.empty()) paths.push_back(path);
  std::shared_ptr<LightFieldCycles> cycles(new LightFieldCycles(std::move(paths), options));
  E2LF_ASSIGN_OR_RETURN(auto first, lightfield::read_light_field(cycles->paths_.front(), options));
  cycles->shape_ = first.shape();
  E2LF_RETURN_IF_ERROR(check_browser_memory(first.shape(), path));
  cycles->kept_ = std::make_shared<const lightfield::LightField>(std::move(first));
  return cycles;
}

void LightFieldCycles::add(const std::string& name, lightfield::LightField light_field) {
  E2LF_REQUIRE(paths_.empty() || light_field.shape() == shape_, "the cycles of a recording have one shape");
  shape_ = light_field.shape();
  added_.push_back(std::make_shared<const lightfield::LightField>(std::move(light_field)));
  paths_.emplace_back(name);
}

std::string LightFieldCycles::label(size_t cycle) const {
  std::string name = paths_[cycle].filename().string();
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Result<std::shared_ptr<const lightfield::LightField>> LightFieldCycles::read(size_t cycle) {
  if (!added_.empty()) return added_.at(cycle);
  const std::lock_guard lock(mutex_);
  if (kept_ && kept_cycle_ == cycle) return kept_;
  const std::filesystem::path& path = paths_[cycle];
  E2LF_ASSIGN_OR_RETURN(auto light_field, lightfield::read_light_field(path, options_));
  if (!(light_field.shape() == shape_)) {
    return fail(ErrorCode::kShape, path, "has another size than the first cycle; show it separately");
  }
  kept_ = std::make_shared<const lightfield::LightField>(std::move(light_field));
  kept_cycle_ = cycle;
  return kept_;
}

Result<std::vector<uint8_t>> LightFieldCycles::png(size_t cycle, size_t view) {
  E2LF_ASSIGN_OR_RETURN(const auto light_field, read(cycle));
  const lightfield::Shape& shape = light_field->shape();
  const std::span<const float> pixels = light_field->view(view / shape.views_x, view % shape.views_x);
  lightfield::Image image(shape.width, shape.height, shape.channels);
  image.pixels.assign(pixels.begin(), pixels.end());
  return lightfield::encode_png(lightfield::to_bytes(image));
}

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
