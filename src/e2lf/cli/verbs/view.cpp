// SPDX-License-Identifier: MIT
// e2lf view: serves the viewer to a browser, or writes it as one HTML file
#include <cstdio>
#include <memory>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/depth/matching_cost.h"
#include "e2lf/files/file.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/terminal/progress_bar.h"
#include "e2lf/view/document.h"
#include "e2lf/view/server.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
namespace {

struct ViewArguments {
  std::vector<fs::path> things;
  fs::path page, disparity;
  uint16_t port = 0;
  size_t frames = 200;
  LightFieldFlags light_field;
  CycleFlags cycles;
};

/// A light field of the document, for the comparison with others.
struct ShownCycles {
  size_t item = 0;
  std::shared_ptr<view::LightFieldCycles> cycles;
  fs::path path;
};

/// Returns the name of an item on its tab: the last part of its path, with the folder if that part alone is not
/// distinctive.
std::string name_of(const fs::path& path) {
  const fs::path whole = (path.has_filename() ? path : path.parent_path()).lexically_normal();
  const fs::path folder = whole.parent_path().filename();
  return folder.empty() || folder == ".." ? whole.filename().string() : (folder / whole.filename()).string();
}

Result<Image> read_map(const fs::path& path, const lightfield::Shape& shape) {
  E2LF_ASSIGN_OR_RETURN(Image image, depth::read_disparity(path));
  if (image.width == shape.width && image.height == shape.height) return image;
  return fail(ErrorCode::kShape, path, "has ", image.width, "x", image.height, " px, the views have ", shape.width, "x",
              shape.height, "; give the map of this light field");
}

/// Returns the files of the maps in `path`, in the order of the cycles.
std::vector<fs::path> files_of(const fs::path& path) {
  if (!is_folder(path)) return {path};
  std::vector<fs::path> files;
  for (const fs::path& cycle : lightfield::cycle_folders(path)) files.push_back(cycle / "disparity.npy");
  if (files.empty()) files.push_back(path / "disparity.npy");
  return files;
}

/// Returns the view that the record of `e2lf depth` states; maps of other programs have no record.
depth::ViewIndex view_of(const fs::path& path, const lightfield::Shape& shape) {
  const auto record = read_json(is_folder(path) ? path / "run.json" : path_beside(path, record_path_beside));
  const depth::ViewIndex middle = depth::middle_view(shape);
  if (!record) return middle;
  const Json::json_pointer place("/notes/maps/0/view");
  if (!record->contains(place)) return middle;
  const Json& view = record->at(place);
  if (!view.is_array() || view.size() != 2 || !view[0].is_number_unsigned() || !view[1].is_number_unsigned()) {
    return middle;
  }
  const depth::ViewIndex named{view[0].get<size_t>(), view[1].get<size_t>()};
  return named.y < shape.views_y && named.x < shape.views_x ? named : middle;
}

/// Reads the disparity maps of a light field with the given shape and number of cycles: float32 [y, x] as .npy or .pfm,
/// or a folder that `e2lf depth` wrote (disparity.npy and confidence.npy, in each of cycle_00000 ...). The record
/// beside the maps states to which view they belong; without a record it is depth::middle_view(). Fails with kNotFound,
/// kFormat, and kShape (the size or number of the maps does not match).
Result<view::DisparityMaps> read_disparity(const fs::path& path, const lightfield::Shape& shape, size_t cycles) {
  const std::vector<fs::path> files = files_of(path);
  if (files.size() != 1 && files.size() != cycles) {
    return fail(ErrorCode::kShape, path, "there are ", files.size(), " disparity maps for ", cycles,
                " cycles; give one, or those of this light field");
  }
  view::DisparityMaps found{{}, view_of(path, shape)};
  for (const fs::path& file : files) {
    E2LF_ASSIGN_OR_RETURN(Image map, read_map(file, shape));
    found.maps.push_back(std::move(map));
    const fs::path beside = file.parent_path() / "confidence.npy";
    if (file == path || !is_present(beside)) continue;
    E2LF_ASSIGN_OR_RETURN(Image confidence, read_map(beside, shape));
    found.confidences.push_back(std::move(confidence));
  }
  if (found.confidences.size() < found.maps.size()) found.confidences.clear();
  return found;
}

/// Returns whether a folder contains maps of `e2lf depth`, or is that of one of its cycles.
bool is_depth_folder(const fs::path& path) {
  return is_folder(path) && is_present(files_of(path).front());
}

/// Returns the light field of which the maps in a folder of `e2lf depth` are, or an empty path if it is not there.
fs::path light_field_of(const fs::path& depth_folder) {
  const auto record = read_json(depth_folder / "run.json");
  const Json::json_pointer place("/inputs/0/path"), folder("/folder");
  if (!record || !record->contains(place) || !record->at(place).is_string()) return {};
  const Json& base = record->contains(folder) ? record->at(folder) : Json("");
  const fs::path path =
      fs::path(base.is_string() ? base.get<std::string>() : "") / record->at(place).get<std::string>();
  if (!is_present(path)) return {};
  const auto kind = file_kind(path);
  return kind && (*kind == FileKind::kLightField || *kind == FileKind::kCycles) ? path : fs::path();
}

class DocumentMaker {
 public:
  DocumentMaker(const ViewArguments& arguments, bool is_quiet) : arguments_(arguments), is_quiet_(is_quiet) {}

  Result<void> add(const fs::path& path) {
    if (is_live(path)) {
      return fail(ErrorCode::kUnsupported, path, "a live recording cannot be shown; convert it to a file first");
    }
    if (is_depth_folder(path)) return add_depth(path);
    E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
    if (kind == FileKind::kModel) {
      E2LF_ASSIGN_OR_RETURN(const model::Model model, model::read_model(path));
      document_.add_model(model);
      return {};
    }
    if (kind == FileKind::kEventImages) return add_event_images(path);
    if (kind == FileKind::kLightField || kind == FileKind::kCycles) return add_light_field(path, name_of(path));
    if (kind == FileKind::kRecording) return add_recording(path);
    if (kind != FileKind::kImages) return other_kind_error(path, kind, "something that the viewer can show");
    return fail(ErrorCode::kUnsupported, path,
                "the viewer does not show measurements with intensity images; reconstruct a light field from it");
  }

  /// Compares every light field with the first one of the same shape.
  Result<void> compare() {
    for (size_t second = 1; second < light_fields_.size(); ++second) {
      for (size_t first = 0; first < second; ++first) {
        if (!(light_fields_[first].cycles->shape() == light_fields_[second].cycles->shape())) continue;
        E2LF_RETURN_IF_ERROR(compare(light_fields_[first], light_fields_[second]));
        break;
      }
    }
    return {};
  }

  /// Adds a disparity map to the first light field.
  Result<void> add_disparity(const fs::path& path) {
    if (light_fields_.empty()) {
      return fail(ErrorCode::kInvalidValue, "--disparity",
                  "a disparity map is shown over a light field; also give a light field");
    }
    return add_disparity(path, light_fields_.front());
  }

  view::Document take() { return std::move(document_); }

 private:
  Result<void> add_event_images(const fs::path& path) {
    E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(path));
    const std::optional<capture::Codes>& codes = file.setup.codes;
    document_.add_event_images(name_of(path), file.cycles, codes ? &*codes : nullptr);
    return {};
  }

  Result<void> add_light_field(const fs::path& path, const std::string& name) {
    E2LF_ASSIGN_OR_RETURN(auto cycles, view::LightFieldCycles::open(path, unchanged_options(arguments_.light_field)));
    light_fields_.push_back({document_.num_items(), cycles, path});
    document_.add_light_field(name, cycles);
    return {};
  }

  Result<void> add_disparity(const fs::path& path, const ShownCycles& shown) {
    E2LF_ASSIGN_OR_RETURN(const view::DisparityMaps found,
                          read_disparity(path, shown.cycles->shape(), shown.cycles->size()));
    document_.add_disparity(shown.item, found);
    return {};
  }

  /// Adds the maps over the light field from which they were computed, or alone if that is not there.
  Result<void> add_depth(const fs::path& path) {
    const fs::path source = light_field_of(path);
    if (!source.empty()) {
      E2LF_RETURN_IF_ERROR(add_light_field(source, name_of(path)));
      return add_disparity(path, light_fields_.back());
    }
    ShownCycles shown{document_.num_items(), std::make_shared<view::LightFieldCycles>(), path};
    for (const fs::path& file : files_of(path)) {
      E2LF_ASSIGN_OR_RETURN(const Image map, depth::read_disparity(file));
      lightfield::LightField grey({1, 1, map.height, map.width, 1});
      std::ranges::fill(grey.data(), 0.5F);
      shown.cycles->add(file.parent_path().filename().string(), std::move(grey));
    }
    document_.add_light_field(name_of(path), shown.cycles);
    return add_disparity(path, shown);
  }

  Result<void> add_recording(const fs::path& path) {
    const CycleFlags& flags = arguments_.cycles;
    const auto open = [&](size_t width, size_t height) -> Result<std::unique_ptr<recordings::RecordingReader>> {
      E2LF_ASSIGN_OR_RETURN(recordings::OpenOptions options, open_options(path, flags.recording));
      if (options.width == 0) {
        options.width = width;
        options.height = height;
      }
      return recordings::open_named_recording(path.string(), options);
    };
    // Frames show the polarity of the recording; with --invert-polarity, the events of cycles have the other one.
    const auto open_its_cycles = [&](const auto& on_batch) {
      CycleFlags observed = flags;
      if (!flags.events.cycles.invert_polarity) observed.events.cycles.on_batch = on_batch;
      return open_cycles(path, observed);
    };
    return view::add_recording(document_, name_of(path), {open, open_its_cycles}, arguments_.frames);
  }

  /// Compares the disparities of two single light fields, if those of the first one lie beside it.
  Result<void> compare_disparity(const ShownCycles& first, const ShownCycles& second, view::Quality& quality) {
    const auto file = depth::find_true_disparity(first.path);
    const lightfield::Shape shape = first.cycles->shape();
    const bool is_single = first.cycles->size() == 1 && second.cycles->size() == 1;
    const lightfield::ReadOptions read = read_options(arguments_.light_field);
    const bool are_all_views = read.views_y.count == 0 && read.views_y.step == 1 && read.orientation.is_upright();
    if (!file || !is_single || !are_all_views || !arguments_.disparity.empty() ||
        !depth::has_comparable_disparity(shape)) {
      return {};
    }
    E2LF_ASSIGN_OR_RETURN(const auto scene, first.cycles->read(0));
    E2LF_ASSIGN_OR_RETURN(const auto reconstruction, second.cycles->read(0));
    E2LF_ASSIGN_OR_RETURN(const depth::TrueDisparity truth, depth::true_disparity(*scene, file));
    ProgressBar bar("depth of " + name_of(second.path), is_quiet_);
    E2LF_ASSIGN_OR_RETURN(depth::FoundDisparity found,
                          depth::judge_disparity(*reconstruction, truth.disparity, bar.callback()));
    const depth::ViewIndex view = depth::middle_view(shape);
    document_.add_disparity(first.item, {{truth.disparity}, view});
    document_.add_disparity(second.item, {{found.disparity}, view});
    quality.disparity = std::move(found.error);
    quality.truth_source = truth.source;
    return {};
  }

  Result<void> compare(const ShownCycles& first, const ShownCycles& second) {
    const bool is_one_truth = first.cycles->size() == 1;
    const size_t count = is_one_truth ? second.cycles->size() : std::min(first.cycles->size(), second.cycles->size());
    std::vector<view::Quality> cycles;
    for (size_t cycle = 0; cycle < count; ++cycle) {
      E2LF_ASSIGN_OR_RETURN(const auto truth, first.cycles->read(is_one_truth ? 0 : cycle));
      E2LF_ASSIGN_OR_RETURN(const auto reconstruction, second.cycles->read(cycle));
      cycles.push_back(view::quality_of(*truth, *reconstruction));
    }
    E2LF_RETURN_IF_ERROR(compare_disparity(first, second, cycles.front()));
    document_.add_comparison(first.item, second.item, cycles);
    return {};
  }

  const ViewArguments& arguments_;
  view::Document document_;
  bool is_quiet_;
  std::vector<ShownCycles> light_fields_;
};

Result<view::Document> make_document(const ViewArguments& arguments, bool is_quiet) {
  DocumentMaker maker(arguments, is_quiet);
  for (const fs::path& thing : arguments.things) E2LF_RETURN_IF_ERROR(maker.add(thing));
  if (!arguments.disparity.empty()) E2LF_RETURN_IF_ERROR(maker.add_disparity(arguments.disparity));
  E2LF_RETURN_IF_ERROR(maker.compare());
  return maker.take();
}

Result<void> export_page(const ViewArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  std::vector<fs::path> inputs = arguments.things;
  if (!arguments.disparity.empty()) inputs.push_back(arguments.disparity);
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.page, verb, ".html"));
  RunRecord record(verb, inputs);
  E2LF_ASSIGN_OR_RETURN(const view::Document document, make_document(arguments, common.quiet));
  record.end_step("read");
  {
    ProgressBar bar("write", common.quiet);
    E2LF_RETURN_IF_ERROR(view::write_page(output.path(), document, bar.callback()));
  }
  record.end_step("write");
  E2LF_RETURN_IF_ERROR(commit(output, record));
  if (!common.quiet) std::printf("%s: open it in a browser\n", arguments.page.c_str());
  return {};
}

Result<void> serve(const ViewArguments& arguments, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(view::Document document, make_document(arguments, verb.common().quiet));
  E2LF_ASSIGN_OR_RETURN(const auto server, view::Server::create(std::move(document), arguments.port));
  if (verb.common().json) {
    std::printf("%s\n", Json{{"url", server->url()}}.dump().c_str());
  } else {
    std::printf("open %s in a browser; press Ctrl-C to end\n", server->url().c_str());
  }
  std::fflush(stdout);
  return server->run();
}

}  // namespace

int run_view(const std::vector<std::string>& arguments) {
  Verb verb("view",
            "Show light fields, folders of cycles, event images, recordings and models in a browser. Two light fields "
            "of the same shape are compared; the first one is the ground truth.",
            "e2lf view out/demo/scene out/demo/recon");
  ViewArguments view_arguments;
  CLI::App& app = verb.app();
  app.add_option("things", view_arguments.things, "files and folders to show, or bundled models")
      ->required()
      ->type_name(kThingType);
  app.add_option("--disparity", view_arguments.disparity,
                 "disparity map to show over the first light field: .npy, .pfm, or a folder of `e2lf depth`");
  app.add_option("--export", view_arguments.page, "write a self-contained HTML file instead of serving");
  add_count(app, "--port", view_arguments.port, 0, 65535, "port of 127.0.0.1 to serve on; 0 = any free one");
  add_count(app, "--frames", view_arguments.frames, 1, 10000, "recordings: number of images over time");
  add_light_field_options(app, view_arguments.light_field, /*has_views=*/true);
  add_orientation_options(app, view_arguments.light_field.orientation);
  add_cycle_options(app, view_arguments.cycles);
  verb.stop_gently();
  return verb.run(arguments, [&] {
    std::ranges::transform(view_arguments.things, view_arguments.things.begin(), file_or_bundled_model);
    return view_arguments.page.empty() ? serve(view_arguments, verb) : export_page(view_arguments, verb);
  });
}

Result<void> write_comparison_page(const std::filesystem::path& path, const ComparedLightField& truth,
                                   const ComparedLightField& reconstruction,
                                   const std::optional<depth::DisparityError>& error) {
  view::Document document;
  for (const auto& [name, shown] : {std::pair("scene", &truth), std::pair("reconstruction", &reconstruction)}) {
    const lightfield::Shape& shape = shown->light_field.shape();
    E2LF_RETURN_IF_ERROR(view::check_browser_memory(shape, path));
    const auto cycles = std::make_shared<view::LightFieldCycles>();
    cycles->add(name, shown->light_field);
    document.add_light_field(name, cycles);
    if (!error) continue;
    document.add_disparity(document.num_items() - 1, {{shown->disparity}, depth::middle_view(shape)});
  }
  view::Quality quality = view::quality_of_pictures(truth.light_field, reconstruction.light_field);
  quality.disparity = error;
  quality.truth_source = "those of the scene";
  document.add_comparison(0, 1, {quality});
  return view::write_page(path, document);
}

}  // namespace e2lf::cli
