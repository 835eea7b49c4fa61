// SPDX-License-Identifier: MIT
#include <algorithm>
#include <mutex>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/formats/view_names.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {
namespace fs = std::filesystem;
namespace {

/// The chosen views' files, row by row.
Result<std::vector<fs::path>> choose_files(const ViewFiles& views, const ReadOptions& options, const fs::path& folder,
                                           ChosenGrid& grid) {
  size_t row_begin = SIZE_MAX, column_begin = SIZE_MAX, row_end = 0, column_end = 0;
  for (const auto& [number, file] : views.files) {
    row_begin = std::min(row_begin, number.first);
    row_end = std::max(row_end, number.first + 1);
    column_begin = std::min(column_begin, number.second);
    column_end = std::max(column_end, number.second + 1);
  }
  E2LF_ASSIGN_OR_RETURN(grid, choose_views(row_end - row_begin, column_end - column_begin, options, folder.string()));
  std::vector<fs::path> files;
  for (size_t view_y = 0; view_y < grid.y.count; ++view_y) {
    for (size_t view_x = 0; view_x < grid.x.count; ++view_x) {
      const size_t row = row_begin + grid.y[view_y], column = column_begin + grid.x[view_x];
      const auto found = views.files.find({row, column});
      if (found == views.files.end()) {
        return Error{ErrorCode::kNotFound, "the view is missing; copy the folder again",
                     (folder / view_name(views.kind, row, column)).string()};
      }
      files.push_back(found->second);
    }
  }
  return files;
}

/// Puts one decoded view in its place.
Result<void> store_view(Image image, size_t view, const fs::path& file, const fs::path& first_file, LightField& out) {
  const Shape& shape = out.shape();
  if (shape.channels == 1) image = to_grey(std::move(image));
  if (image.width != shape.width || image.height != shape.height || image.channels != shape.channels) {
    return Error{ErrorCode::kShape,
                 cat("the view is ", image.width, "x", image.height, " with ", image.channels, " channels, but ",
                     first_file.filename().string(), " is ", shape.width, "x", shape.height, " with ", shape.channels,
                     "; all views must have one size"),
                 file.string()};
  }
  std::copy(image.pixels.begin(), image.pixels.end(), out.view(view / shape.views_x, view % shape.views_x).begin());
  return {};
}

/// Decodes files[1..] in parallel; of several errors the one of the first view is returned.
Result<void> read_rest(const std::vector<fs::path>& files, const ProgressFn& progress, LightField& out) {
  std::vector<std::optional<Error>> errors(files.size());
  std::mutex mutex;
  size_t done = 1;
  parallel_for(files.size() - 1, 1, [&](size_t begin, size_t end) {
    for (size_t view = begin + 1; view < end + 1; ++view) {
      Result<Image> image = read_image(files[view]);
      const Result<void> stored =
          image.ok() ? store_view(std::move(image).value(), view, files[view], files[0], out) : image.error();
      if (!stored.ok()) errors[view] = stored.error();
      const std::lock_guard lock(mutex);
      ++done;
      if (progress) progress(done, files.size());
    }
  });
  for (const auto& error : errors) {
    if (error) return *error;
  }
  return {};
}

}  // namespace

Result<ViewFiles> list_views(const fs::path& folder) {
  std::error_code error;
  std::map<LightFieldKind, ViewFiles> kinds;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    const auto view = parse_view_name(file);
    if (!view) continue;
    ViewFiles& views = kinds[view->kind];
    views.kind = view->kind;
    const auto [other, added] = views.files.insert({{view->row, view->column}, file});
    if (!added) {
      return Error{ErrorCode::kFormat,
                   cat("the same view as ", other->second.filename().string(), "; remove one of the two"),
                   file.string()};
    }
  }
  if (error)
    return Error{ErrorCode::kIo, cat("cannot list the folder (", error.message(), "); check it"), folder.string()};
  ViewFiles most;
  for (auto& [kind, views] : kinds) {
    if (views.files.size() > most.files.size()) most = std::move(views);
  }
  return most;
}

Result<LightField> read_view_folder(const fs::path& folder, const ReadOptions& options, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const ViewFiles views, list_views(folder));
  if (views.files.empty()) {
    return Error{ErrorCode::kNotFound, "the folder holds no views; give one with 00_00.png ...", folder.string()};
  }
  ChosenGrid grid;
  E2LF_ASSIGN_OR_RETURN(const std::vector<fs::path> files, choose_files(views, options, folder, grid));

  // The first view says how large the light field is.
  E2LF_ASSIGN_OR_RETURN(Image first, read_image(files[0]));
  const Shape shape{grid.y.count, grid.x.count, first.height, first.width, options.colour ? first.channels : 1};
  E2LF_RETURN_IF_ERROR(check_memory(shape, sizeof(float), options, folder.string()));
  LightField out(shape);
  E2LF_RETURN_IF_ERROR(store_view(std::move(first), 0, files[0], files[0], out));
  if (files.size() > 1) E2LF_RETURN_IF_ERROR(read_rest(files, progress, out));
  return out;
}

}  // namespace e2lf::lightfield
