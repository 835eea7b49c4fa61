// SPDX-License-Identifier: MIT
// e2lf eval: comparison of a reconstruction with the ground truth
#include <algorithm>
#include <cstdio>
#include <optional>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/compare/tables.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/depth/disparity_picture.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/report/chart.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct EvalArguments {
  fs::path truth, reconstruction, events, true_disparity, output;
  std::vector<std::string> named;  ///< "NAME=PATH"
  bool fit_gain = false;
  std::vector<fs::path> reports;
};

struct Candidate {
  std::string name;
  fs::path path;
};

Result<std::vector<Candidate>> candidates_of(const EvalArguments& arguments) {
  std::vector<Candidate> found;
  if (!arguments.reconstruction.empty()) {
    found.push_back({arguments.reconstruction.string(), arguments.reconstruction});
  }
  for (const std::string& named : arguments.named) {
    const size_t equals = named.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == named.size()) {
      return fail(ErrorCode::kInvalidValue, cat("--name ", named), "a reconstruction with a name is written NAME=PATH");
    }
    const std::string name = named.substr(0, equals);
    if (std::ranges::any_of(found, [&](const Candidate& other) { return other.name == name; })) {
      return fail(ErrorCode::kInvalidValue, cat("--name ", named),
                  "another reconstruction has this name; choose another");
    }
    found.push_back({name, named.substr(equals + 1)});
  }
  if (!found.empty()) return found;
  return fail(ErrorCode::kInvalidValue, "",
              "there is nothing to compare; give a reconstruction, or several with --name");
}

/// Reads the tone in the record of `e2lf reconstruct` beside a reconstruction: that of the cycle, or of all.
void read_recorded_tone(const fs::path& path, eval::EvalRow& row) {
  const fs::path folder = is_folder(path) ? path : path.parent_path();
  const auto record = read_json(folder / "run.json");
  if (!record || !is_our_record(folder / "run.json")) return;
  for (const char* place : {"/options", "/cycle"}) {
    const Json tone = record->value(Json::json_pointer(place), Json::object());
    if (!tone.is_object()) continue;
    if (tone.contains("gain") && tone["gain"].is_number()) row.gain = tone["gain"].get<double>();
    if (tone.contains("black") && tone["black"].is_number()) row.black = tone["black"].get<double>();
  }
}

/// The result of a comparison: the figures, and the reconstruction for images.
struct Compared {
  eval::EvalRow row;
  lightfield::LightField field;
  lightfield::Image disparity;  ///< empty if it is not compared
};

/// The true light field, with the disparities of its middle view unless there is nothing to compare.
struct Truth {
  lightfield::LightField field;
  std::optional<depth::TrueDisparity> disparity;
};

std::vector<eval::EvalRow> rows_of(const std::vector<Compared>& all) {
  std::vector<eval::EvalRow> rows;
  for (const Compared& compared : all) rows.push_back(compared.row);
  return rows;
}

/// Returns a line for each reconstruction that does not have the brightness that the method produced.
std::string tone_text(const std::vector<eval::EvalRow>& rows) {
  std::string text;
  for (const eval::EvalRow& row : rows) {
    const double gain = row.gain.value_or(1), black = row.black.value_or(0);
    if (gain != 1 || black != 0) {
      text += cat(row.method, ": toned when it was reconstructed: a gain of ", gain, " and a black level of ", black,
                  row.fitted_gain ? ""
                                  : "; --fit-gain compares with the best gain and black level, and `e2lf reconstruct "
                                    "--gain 1 --black 0` reconstructs without them",
                  "\n");
    }
    if (row.fitted_gain) {
      text += cat(row.method, ": compared with the least-squares gain of ", *row.fitted_gain, " and black level of ",
                  *row.fitted_black, "\n");
    }
  }
  return text;
}

std::string disparity_text(const Truth& truth) {
  return cat("Disparities are those that `e2lf depth` finds in the reconstruction, against ", truth.disparity->source,
             ".");
}

/// Adds the true disparities beside those of the reconstructions, and the error of the most certain pixels.
Result<void> add_disparities(const std::vector<Compared>& all, const Truth& truth, report::Page& page) {
  page.heading("Disparity").paragraph(disparity_text(truth));
  const depth::DisparityRange range = depth::shown_range(truth.disparity->disparity);
  std::vector<NamedImage> pictures = {{depth::picture_with_scale(truth.disparity->disparity, range), "truth"}};
  report::LineChart chart{"the most certain pixels, %", "off by more than 0.2 px, %", {}};
  for (const Compared& compared : all) {
    const depth::DisparityError& error = *compared.row.disparity;
    pictures.push_back(
        {depth::picture_with_scale(compared.disparity, range),
         compared.row.method + formatted(": %.1f %% off by more than 0.07 px, %.1f %% by more than 0.2 px, mean error "
                                         "%.3f px, slope %.2f",
                                         error.bad_07_percent, error.bad_20_percent, error.mean_absolute_px,
                                         error.slope)});
    report::Line& line = chart.lines.emplace_back();
    line.name = compared.row.method;
    for (const depth::ErrorPart& part : compared.row.disparity->most_certain) {
      line.points.push_back({part.pixels_percent, part.bad_20_percent});
    }
  }
  E2LF_RETURN_IF_ERROR(add_pictures(pictures, 350, page));
  page.drawing(report::chart_svg(chart));
  return {};
}

Result<report::Page> eval_page(const std::vector<Compared>& all, const Truth& true_scene) {
  const lightfield::LightField& truth = true_scene.field;
  const std::vector<eval::EvalRow> rows = rows_of(all);
  std::vector<std::string> names;
  for (const eval::EvalRow& row : rows) names.push_back(row.method);
  report::Page page = verb_page(cat(join(names), " against ", rows.front().scene));
  const lightfield::Shape& shape = truth.shape();
  page.paragraph(cat(shape.views_y, "x", shape.views_x, " views of ", shape.width, "x", shape.height, " px, ",
                     shape.channels == 1 ? "grey" : "colour"));
  page.table(eval::quality_table(rows));
  if (const std::string tones = tone_text(rows); !tones.empty()) page.paragraph(tones);
  page.heading("Pictures")
      .paragraph(
          "The upper left view and its enlarged centre, with the EPI of the middle row below, whose lines are straight "
          "where views are consistent. Beside each reconstruction is its error: black is none, white is 0.2 and more.");
  std::vector<NamedImage> pictures = {{compare::look(truth, nullptr), cat("truth: ", rows.front().scene)}};
  for (const Compared& compared : all) {
    pictures.push_back({compare::look(compared.field, &truth), compared.row.method});
  }
  E2LF_RETURN_IF_ERROR(add_pictures(pictures, 700, page));
  if (true_scene.disparity) E2LF_RETURN_IF_ERROR(add_disparities(all, true_scene, page));
  if (const auto& events = rows.front().events) {
    page.heading("Events").facts(eval::to_json(*events));
  }
  return page;
}

/// Returns the figures of one reconstruction, or a list of them under "methods"; with `channels` unless it is 0.
Json json_of(const std::vector<eval::EvalRow>& rows, const Truth& truth, size_t channels) {
  Json methods = Json::array();
  for (const eval::EvalRow& row : rows) {
    methods.push_back(eval::to_json(row));
    if (truth.disparity) methods.back()["disparity"]["truth"] = truth.disparity->source;
    if (channels > 0) methods.back()["channels"] = channels;
  }
  return rows.size() == 1 ? methods.front() : Json{{"methods", methods}};
}

void print_rows(const std::vector<eval::EvalRow>& rows, const Truth& truth, const CommonOptions& common) {
  if (common.json) {
    std::printf("%s", json_text(json_of(rows, truth, truth.field.shape().channels)).c_str());
  } else if (!common.quiet) {
    std::printf("%s%s", report::table_text(eval::quality_table(rows)).c_str(), tone_text(rows).c_str());
    if (truth.disparity) std::printf("%s\n", disparity_text(truth).c_str());
    for (const eval::EvalRow& row : rows) {
      const std::string of = rows.size() > 1 ? cat(" of ", row.method) : "";
      std::printf("\nPSNR of each view%s in dB:\n%s", of.c_str(), eval::view_grid_text(row.quality).c_str());
    }
  }
}

Result<eval::EventStatistics> read_events(const fs::path& path, const lightfield::Shape& shape) {
  E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(path));
  const capture::EventImages& images = file.cycles.front();
  if (images.width == shape.width && images.height == shape.height) return eval::event_statistics(images);
  return fail(ErrorCode::kShape, path, "event images of ", images.width, "x", images.height,
              " px do not belong to a light field of ", shape.width, "x", shape.height,
              " px; give the events from which it was reconstructed");
}

/// Reads the true light field with as many views as a reconstruction has, in colour if it is.
Result<Truth> read_truth(const EvalArguments& arguments, const lightfield::Shape& shape, bool quiet) {
  Truth truth;
  const SceneOptions same{{}, shape.views_y, shape.views_x, shape.channels == 3};
  E2LF_ASSIGN_OR_RETURN(truth.field, load_scene(arguments.truth, same, quiet));
  if (!(truth.field.shape() == shape) || !depth::has_comparable_disparity(shape)) return truth;
  const auto file = arguments.true_disparity.empty() ? depth::find_true_disparity(arguments.truth)
                                                     : std::optional(arguments.true_disparity);
  E2LF_ASSIGN_OR_RETURN(truth.disparity, depth::true_disparity(truth.field, file));
  if (file) {
    ProgressBar bar("check the true disparity", quiet);
    E2LF_RETURN_IF_ERROR(depth::check_true_disparity(truth.field, *truth.disparity, bar.callback()));
  }
  return truth;
}

Result<void> compare_disparity(const Truth& truth, Compared& compared, bool quiet) {
  if (!truth.disparity) return {};
  ProgressBar bar("depth", quiet);
  E2LF_ASSIGN_OR_RETURN(depth::FoundDisparity found,
                        depth::judge_disparity(compared.field, truth.disparity->disparity, bar.callback()));
  compared.row.disparity = std::move(found.error);
  compared.disparity = std::move(found.disparity);
  return {};
}

Result<Compared> compare_one(const Candidate& candidate, lightfield::LightField field, const Truth& true_scene,
                             const EvalArguments& arguments, bool quiet) {
  const lightfield::LightField& truth = true_scene.field;
  Compared compared{{candidate.name, arguments.truth.string(), {}}, std::move(field), {}};
  if (!(compared.field.shape() == truth.shape())) {
    const auto text = [](const lightfield::Shape& shape) {
      return cat(shape.views_y, "x", shape.views_x, " views of ", shape.width, "x", shape.height, " px");
    };
    return fail(ErrorCode::kShape, candidate.path, "has ", text(compared.field.shape()),
                ", but the true light field has ", text(truth.shape()), "; compare light fields of one size");
  }
  read_recorded_tone(candidate.path, compared.row);
  if (arguments.fit_gain) {
    const eval::Tone tone = eval::best_tone(truth, compared.field);
    for (float& value : compared.field.data()) value = (value - tone.black) * tone.gain;
    compared.row.fitted_gain = double{tone.gain};
    compared.row.fitted_black = double{tone.black};
  }
  {
    ProgressBar bar("compare", quiet);
    E2LF_ASSIGN_OR_RETURN(compared.row.quality, eval::compare(truth, compared.field, /*clamp=*/true, bar.callback()));
  }
  E2LF_RETURN_IF_ERROR(compare_disparity(true_scene, compared, quiet));
  return compared;
}

Result<void> evaluate(const EvalArguments& arguments, const Verb& verb) {
  const bool quiet = verb.common().quiet;
  E2LF_ASSIGN_OR_RETURN(const std::vector<Candidate> candidates, candidates_of(arguments));
  std::vector<fs::path> named;
  for (const Candidate& candidate : candidates) named.push_back(candidate.path);
  OutputRules rules = output_rules(verb, named);
  E2LF_ASSIGN_OR_RETURN(ReportOutput reports, ReportOutput::open(arguments.reports, rules));
  rules.streams = true;
  rules.ending = ".json";
  std::optional<OutputFile> output;
  if (!arguments.output.empty()) {
    E2LF_ASSIGN_OR_RETURN(output, OutputFile::create(arguments.output, rules));
  }
  Truth truth;
  std::vector<Compared> all;
  for (const Candidate& candidate : candidates) {
    E2LF_ASSIGN_OR_RETURN(lightfield::LightField field,
                          read_with_progress(candidate.path, unchanged_options({}), quiet));
    if (all.empty()) {
      E2LF_ASSIGN_OR_RETURN(truth, read_truth(arguments, field.shape(), quiet));
    }
    E2LF_ASSIGN_OR_RETURN(Compared compared, compare_one(candidate, std::move(field), truth, arguments, quiet));
    all.push_back(std::move(compared));
  }
  if (!arguments.events.empty()) {
    E2LF_ASSIGN_OR_RETURN(const eval::EventStatistics events, read_events(arguments.events, truth.field.shape()));
    for (Compared& compared : all) compared.row.events = events;
  }
  const std::vector<eval::EvalRow> rows = rows_of(all);
  if (output) {
    E2LF_RETURN_IF_ERROR(write_file(output->path(), json_text(json_of(rows, truth, 0))));
    E2LF_RETURN_IF_ERROR(output->commit());
  }
  if (reports.is_wanted()) {
    E2LF_ASSIGN_OR_RETURN(const report::Page page, eval_page(all, truth));
    E2LF_RETURN_IF_ERROR(reports.write(page));
  }
  print_rows(rows, truth, verb.common());
  return {};
}

}  // namespace

int run_eval(const std::vector<std::string>& arguments) {
  Verb verb("eval",
            "Compare a reconstructed light field with the true one: PSNR and SSIM of each view, their means, and the "
            "disparity.",
            "e2lf eval scene/ out/recon --events events.npz --report quality.html");
  EvalArguments evaluation;
  CLI::App& app = verb.app();
  app.add_option("truth", evaluation.truth, "the true light field")->required();
  app.add_option("reconstruction", evaluation.reconstruction, "the reconstructed light field");
  app.add_option("--name", evaluation.named,
                 "NAME=PATH: a reconstruction and its name in tables and images; may be given several times")
      ->allow_extra_args(false);
  app.add_flag("--fit-gain", evaluation.fit_gain,
               "apply to each reconstruction its least-squares gain and black level, which are reported");
  app.add_option("--events", evaluation.events,
                 "event images, which add event counts, measurement time and data rate to the result");
  app.add_option(
      "--true-disparity", evaluation.true_disparity,
      "true disparities of the middle view, .npy or .pfm; default: gt_disparity.npy or gt_disp_lowres.pfm in "
      "the folder of the true light field, else those that `e2lf depth` finds in it");
  app.add_option("-o,--output", evaluation.output, "also write the result to this JSON file");
  add_report_option(app, evaluation.reports);
  return verb.run(arguments, [&] { return evaluate(evaluation, verb); });
}

}  // namespace e2lf::cli
