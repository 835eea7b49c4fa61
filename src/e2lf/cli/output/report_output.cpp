// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/report_output.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/cli/output/print.h"
#include "e2lf/film/draw_svg.h"
#include "e2lf/lightfield/contact_sheet.h"
#include "e2lf/report/chart.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Returns the command line as it was typed, as far as possible.
std::string command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(shell_word(word));
  if (!words.empty()) words.front() = "e2lf";
  return join(words, " ");
}

}  // namespace

void add_report_option(CLI::App& app, std::vector<fs::path>& names) {
  const auto check = [](std::string& text) {
    const auto format = report::file_format_of(text);
    return format ? std::string() : format.error().text();
  };
  app.add_option("--report", names,
                 "also write a report of the run: a page (.html) or its tables (.tex; .csv for the first one); may be "
                 "given several times")
      ->check(CLI::Validator(check, ""))
      ->allow_extra_args(false);
}

Result<ReportOutput> ReportOutput::open(const std::vector<fs::path>& names, const OutputRules& rules) {
  ReportOutput made;
  for (const fs::path& name : names) {
    E2LF_ASSIGN_OR_RETURN(const report::FileFormat format, report::file_format_of(name));
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(name, rules));
    made.files_.push_back({format, std::move(output)});
  }
  return made;
}

Result<void> ReportOutput::write(const report::Page& page) {
  for (File& file : files_) {
    E2LF_RETURN_IF_ERROR(write_file(file.output.path(), report::file_text(page, file.format)));
    E2LF_RETURN_IF_ERROR(file.output.commit());
  }
  return {};
}

report::Page verb_page(const std::string& title) {
  report::Page page(title);
  page.code(command_line());
  return page;
}

Result<void> add_pictures(const std::vector<NamedImage>& images, size_t most_width, report::Page& page) {
  std::vector<std::vector<uint8_t>> kept;
  for (const auto& [image, caption] : images) {
    const size_t width = std::min(image.width, most_width);
    const size_t height = std::max<size_t>(1, image.height * width / std::max<size_t>(1, image.width));
    const bool is_wide = width < image.width;
    E2LF_ASSIGN_OR_RETURN(
        auto png,
        lightfield::encode_png(lightfield::to_bytes(is_wide ? lightfield::shrink(image, width, height) : image)));
    kept.push_back(std::move(png));
  }
  std::vector<report::Picture> pictures;
  for (size_t i = 0; i < images.size(); ++i) pictures.push_back({kept[i], images[i].caption});
  page.pictures(pictures);
  return {};
}

void add_patterns(const capture::Codes& codes, report::Page& page) {
  page.begin_row();
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    const auto pattern = codes.pattern(n);
    page.drawing(report::grid_svg({codes.views_x, {pattern.begin(), pattern.end()}}), cat("a", n + 1));
  }
  page.end_row();
}

std::string transition_bars(const std::vector<double>& events_per_pixel) {
  report::BarChart chart;
  chart.y_label = "events per pixel";
  chart.decimals = 3;
  report::BarChart::Series series{"signed sums", {}};
  for (size_t k = 0; k < events_per_pixel.size(); ++k) {
    chart.groups.push_back(cat("transition ", k + 1));
    series.values.emplace_back(events_per_pixel[k]);
  }
  chart.series.push_back(std::move(series));
  return report::chart_svg(chart);
}

void add_chart_option(CLI::App& app, fs::path& name, const std::string& help) {
  const auto check = [](std::string& text) {
    const std::string extension = fs::path(text).extension().string();
    return extension == ".svg" || extension == ".png"
               ? std::string()
               : cat("the chart is an SVG or PNG image; give it a name that ends in .svg or .png, not ", text);
  };
  app.add_option("--plot", name, help)->check(CLI::Validator(check, ""));
}

Result<ChartOutput> ChartOutput::open(const fs::path& name, OutputRules rules) {
  ChartOutput chart;
  chart.name_ = name;
  rules.streams = true;
  E2LF_ASSIGN_OR_RETURN(chart.file_, open_optional(name, rules));
  return chart;
}

Result<void> ChartOutput::write(const std::string& svg) {
  constexpr size_t kWidth = 1800;  // twice the width of the drawing
  const std::string drawing = report::file_svg(svg);
  if (name_.extension() == ".png") {
    E2LF_ASSIGN_OR_RETURN(const lightfield::Image image, located(film::draw_svg(drawing, kWidth), name_));
    E2LF_RETURN_IF_ERROR(lightfield::write_png(file_->path(), lightfield::to_bytes(image)));
  } else {
    E2LF_RETURN_IF_ERROR(write_file(file_->path(), drawing));
  }
  return file_->commit();
}

namespace {

float bright_count(const capture::EventImages& images) {
  std::vector<int16_t> counts = images.values;
  for (int16_t& count : counts) count = static_cast<int16_t>(std::min(std::abs(int{count}), 32767));
  const auto quantile = counts.begin() + static_cast<ptrdiff_t>((counts.size() - 1) * 99 / 100);
  std::nth_element(counts.begin(), quantile, counts.end());
  return static_cast<float>(std::max<int>(*quantile, 1));
}

std::array<float, 3> colour_of(float value) {
  constexpr float kGrey = 0.92F;
  const float strength = std::min(std::abs(value), 1.0F);
  const float faded = kGrey * (1.0F - strength);
  return value >= 0 ? std::array{kGrey, faded, faded} : std::array{faded, faded, kGrey};
}

}  // namespace

lightfield::Image event_picture(const capture::EventImages& images) {
  constexpr size_t kGap = 4;
  lightfield::Image picture(images.count * (images.width + kGap) - kGap, images.height, 3);
  std::fill(picture.pixels.begin(), picture.pixels.end(), 1.0F);
  const float scale = 1.0F / bright_count(images);
  for (size_t k = 0; k < images.count; ++k) {
    const auto image = images.image(k);
    for (size_t y = 0; y < images.height; ++y) {
      float* row = picture.pixels.data() + (y * picture.width + k * (images.width + kGap)) * 3;
      for (size_t x = 0; x < images.width; ++x) {
        const auto colour = colour_of(scale * static_cast<float>(image[y * images.width + x]));
        std::copy(colour.begin(), colour.end(), row + 3 * x);
      }
    }
  }
  return picture;
}

}  // namespace e2lf::cli
