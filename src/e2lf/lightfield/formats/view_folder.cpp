// SPDX-License-Identifier: MIT
// Reads folders of views; declared in readers.h.

#include <algorithm>
#include <charconv>
#include <mutex>
#include <numeric>
#include <string_view>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxNumber = 9999;

/// Removes a number from the front of `text`. Returns false if there is none or if it is too large.
bool take_number(std::string_view& text, size_t& number) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || number > kMaxNumber) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return true;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Returns whether the extension of a file is that of PNG or JPEG images.
bool is_image_name(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

struct NumberedView {
  LightFieldKind kind;  ///< one of the folder kinds
  size_t row, column;   ///< in kHciFolder, whose names contain one number: row 0 and that number
};

/// Parses the file name of a view. Returns nothing for any other file.
std::optional<NumberedView> parse_view_name(const std::filesystem::path& file) {
  if (!is_image_name(file)) return std::nullopt;
  const std::string stem = lower_case(file.stem().string());
  std::string_view rest = stem;
  if (take_prefix(rest, "input_cam")) {
    size_t number = 0;
    if (!take_number(rest, number) || !rest.empty()) return std::nullopt;
    return NumberedView{LightFieldKind::kHciFolder, 0, number};
  }
  const LightFieldKind kind = take_prefix(rest, "out_") ? LightFieldKind::kStanfordFolder : LightFieldKind::kViewFolder;
  size_t row = 0, column = 0;
  if (!take_number(rest, row) || !take_prefix(rest, "_") || !take_number(rest, column)) return std::nullopt;
  const bool position_follows = kind == LightFieldKind::kStanfordFolder && rest.starts_with("_");
  if (!rest.empty() && !position_follows) return std::nullopt;
  return NumberedView{kind, row, column};
}

/// A file name with two numbers, which may be the row and the column of a view: view_0_0.png, r00_c00.png.
struct PairName {
  std::string words;  ///< the name without its numbers, which all views of a light field share: "view_#_#"
  size_t row, column;
  /// Whether the first number is the column, as in x0_y0.png.
  bool is_column_first;
};

/// Parses a file name with two numbers. The first one is the row, unless a letter x, u or c, or a word that begins with
/// col, stands in front of it. Returns nothing for any other file.
std::optional<PairName> parse_pair_name(const std::filesystem::path& file) {
  if (!is_image_name(file)) return std::nullopt;
  const std::string stem = lower_case(file.stem().string());
  std::string words;
  std::vector<size_t> numbers;
  for (std::string_view rest = stem; !rest.empty();) {
    const bool is_digit = rest[0] >= '0' && rest[0] <= '9';
    size_t number = 0;
    if (is_digit && (numbers.size() == 2 || !take_number(rest, number))) return std::nullopt;
    if (is_digit) numbers.push_back(number);
    words += is_digit ? '#' : rest[0];
    if (!is_digit) rest.remove_prefix(1);
  }
  // Adjacent numbers would be one.
  if (numbers.size() != 2) return std::nullopt;
  const std::string front = words.substr(0, words.find('#'));
  const std::string word = front.substr(front.find_last_not_of("abcdefghijklmnopqrstuvwxyz") + 1);
  const bool is_column_first = word == "x" || word == "u" || word == "c" || word.starts_with("col");
  return PairName{words, numbers[is_column_first ? 1 : 0], numbers[is_column_first ? 0 : 1], is_column_first};
}

/// Returns the name of the view with another number, with as many digits and the same extension as `like`, which is a
/// name of kHciFolder.
std::string numbered_view_name(const std::filesystem::path& like, size_t number) {
  const std::string stem = like.stem().string();
  const size_t words = std::string_view("input_Cam").size();
  return cat(stem.substr(0, words), formatted("%0*zu", static_cast<int>(stem.size() - words), number),
             like.extension().string());
}

}  // namespace

std::string view_name(LightFieldKind kind, size_t row, size_t column) {
  if (kind == LightFieldKind::kStanfordFolder) return formatted("out_%02zu_%02zu_*.png", row, column);
  return formatted("%02zu_%02zu.png", row, column);
}

namespace {

/// The grid of views that are numbered consecutively: number = first + columns * row + column.
struct FlatGrid {
  size_t first = 0, columns = 1;
};

/// The numbers of rows or columns from the first to the last, which are `step` apart, since only every second view may
/// have been kept.
struct Numbers {
  size_t first = SIZE_MAX, last = 0, step = 0;

  void add(size_t number) {
    if (last >= first) step = std::gcd(step, number > last ? number - last : last - number);
    first = std::min(first, number);
    last = std::max(last, number);
  }
  [[nodiscard]] size_t count() const { return step == 0 ? 1 : (last - first) / step + 1; }
};

/// The files of a grid of views by (row, column), and the rows and columns that exist.
struct FolderGrid {
  std::map<std::pair<size_t, size_t>, fs::path> files;
  Numbers rows, columns;
  FlatGrid flat;  ///< of views that are numbered consecutively
};

/// Assigns rows and columns to views that are numbered consecutively, by the stated number of columns, or else in a
/// square grid, in which some views may be missing. Fails with kInvalidValue.
Result<void> place_in_rows(const ViewFiles& views, size_t columns, const fs::path& folder, FolderGrid& grid) {
  const size_t first = views.files.begin()->first.second, last = views.files.rbegin()->first.second;
  if (columns == 0) columns = views_per_axis(last - first + 1);
  if (columns == 0) {
    return fail(ErrorCode::kInvalidValue, folder, views.files.size(), " views are numbered consecutively from ", first,
                " to ", last,
                ", which is not a square grid; give the number of view columns, or copy the missing views");
  }
  grid.flat = {first, columns};
  for (const auto& [number, file] : views.files) {
    const size_t at = number.second - grid.flat.first;
    grid.files[{at / grid.flat.columns, at % grid.flat.columns}] = file;
  }
  grid.rows.step = grid.columns.step = 1;
  return {};
}

Result<FolderGrid> grid_of(const ViewFiles& views, const ReadOptions& options, const fs::path& folder) {
  FolderGrid grid;
  if (views.kind == LightFieldKind::kHciFolder) {
    E2LF_RETURN_IF_ERROR(place_in_rows(views, options.view_columns, folder, grid));
  } else {
    grid.files = views.files;
  }
  for (const auto& [number, file] : grid.files) {
    grid.rows.add(number.first);
    grid.columns.add(number.second);
  }
  if (std::max(grid.rows.step, grid.columns.step) > 1) {
    log_info(cat(folder.string(), ": the numbers of the views go in steps of ", std::max<size_t>(grid.rows.step, 1),
                 " rows and ", std::max<size_t>(grid.columns.step, 1), " columns"));
  }
  return grid;
}

/// Returns the name of a missing view.
std::string missing_name(const ViewFiles& views, const FolderGrid& grid, size_t row, size_t column) {
  if (views.kind != LightFieldKind::kHciFolder) return view_name(views.kind, row, column);
  return numbered_view_name(grid.files.begin()->second, grid.flat.first + grid.flat.columns * row + column);
}

/// Returns the files of the selected views, row by row.
Result<std::vector<fs::path>> choose_files(const ViewFiles& views, const ReadOptions& options, const fs::path& folder,
                                           ChosenGrid& chosen) {
  E2LF_ASSIGN_OR_RETURN(const FolderGrid grid, grid_of(views, options, folder));
  E2LF_ASSIGN_OR_RETURN(chosen, choose_views(grid.rows.count(), grid.columns.count(), options, folder.string()));
  std::vector<fs::path> files;
  for (size_t view_y = 0; view_y < chosen.y.count; ++view_y) {
    for (size_t view_x = 0; view_x < chosen.x.count; ++view_x) {
      const size_t row = grid.rows.first + grid.rows.step * chosen.y[view_y];
      const size_t column = grid.columns.first + grid.columns.step * chosen.x[view_x];
      const auto found = grid.files.find({row, column});
      if (found == grid.files.end()) {
        return fail(ErrorCode::kNotFound, (folder / missing_name(views, grid, row, column)).string(),
                    "the view is missing; copy the folder again");
      }
      files.push_back(found->second);
    }
  }
  return files;
}

Result<RawImage> read_view(const fs::path& file) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(file));
  return decode_raw_image(bytes, file.string());
}

/// Converts one decoded view to float32 at its place.
Result<void> store_view(const RawImage& image, size_t view, const fs::path& file, const fs::path& first_file,
                        const ReadOptions& options, LightField& out) {
  const Shape& shape = out.shape();
  const size_t channels = options.colour ? image.channels : 1;
  if (image.width != shape.width || image.height != shape.height || channels != shape.channels) {
    return fail(ErrorCode::kShape, file, "the view is ", image.width, "x", image.height, " with ", channels,
                " channels, but ", first_file.filename().string(), " is ", shape.width, "x", shape.height, " with ",
                shape.channels, "; all views must have one size");
  }
  constexpr ChosenViews kOne{.count = 1, .stored = 1};
  const LightFieldOutput place(out.view(view / shape.views_x, view % shape.views_x).data(),
                               {1, 1, shape.height, shape.width, shape.channels});
  return convert_views(stored_view(image), {kOne, kOne}, options, place, file.string());
}

/// Decodes files[1..] in parallel. If several fail, the error of the first view is returned.
Result<void> read_rest(const std::vector<fs::path>& files, const ReadOptions& options, const ProgressFn& progress,
                       LightField& out) {
  std::vector<std::optional<Error>> errors(files.size());
  std::mutex mutex;
  size_t done = 1;
  parallel_for(files.size() - 1, 1, [&](size_t begin, size_t end) {
    for (size_t view = begin + 1; view < end + 1; ++view) {
      const Result<RawImage> image = read_view(files[view]);
      const Result<void> stored =
          image.ok() ? store_view(*image, view, files[view], files[0], options, out) : image.error();
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

/// The files whose names differ in two numbers only.
struct PairFiles {
  ViewFiles views;
  bool is_column_first = false;
  bool is_unique = true;  ///< no two files are the same view
};

/// Returns the views with names such as view_0_0.png, if they are a complete grid of at least 2x2.
std::optional<ViewFiles> list_pairs(const std::vector<fs::path>& files) {
  std::map<std::string, PairFiles> groups;
  for (const fs::path& file : files) {
    const auto name = parse_pair_name(file);
    if (!name) continue;
    PairFiles& group = groups[name->words];
    group.is_column_first = name->is_column_first;
    group.is_unique &= group.views.files.insert({{name->row, name->column}, file}).second;
  }
  for (auto& [words, group] : groups) {
    Numbers rows, columns;
    for (const auto& [place, file] : group.views.files) {
      rows.add(place.first);
      columns.add(place.second);
    }
    const bool is_grid =
        std::min(rows.count(), columns.count()) >= 2 && group.views.files.size() == rows.count() * columns.count();
    if (!is_grid || !group.is_unique) continue;
    group.views.reading =
        cat("the first number in names such as ", group.views.files.begin()->second.filename().string(),
            " was taken as the ", group.is_column_first ? "column" : "row");
    group.views.others = files.size() - group.views.files.size();
    return std::move(group.views);
  }
  return std::nullopt;
}

}  // namespace

Result<ViewFiles> list_views(const fs::path& folder) {
  std::error_code error;
  std::map<LightFieldKind, ViewFiles> kinds;
  std::vector<fs::path> others;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    const auto view = parse_view_name(file);
    if (!view && is_image_name(file)) others.push_back(file);
    if (!view) continue;
    ViewFiles& views = kinds[view->kind];
    views.kind = view->kind;
    const auto [other, added] = views.files.insert({{view->row, view->column}, file});
    if (!added) {
      return fail(ErrorCode::kFormat, file, "the same view as ", other->second.filename().string(),
                  "; remove one of the two");
    }
  }
  if (error) return fail(ErrorCode::kIo, folder, "cannot list the folder (", error.message(), "); check it");
  if (kinds.empty()) return list_pairs(others).value_or(ViewFiles{});
  ViewFiles most;
  size_t all = 0;
  for (auto& [kind, views] : kinds) {
    all += views.files.size();
    if (views.files.size() > most.files.size()) most = std::move(views);
  }
  most.others = all - most.files.size();
  return most;
}

Result<LightField> read_view_folder(const fs::path& folder, const ReadOptions& options, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const ViewFiles views, list_views(folder));
  if (views.files.empty()) {
    return fail(ErrorCode::kNotFound, folder, "the folder contains no views; give one with 00_00.png ...");
  }
  if (views.others > 0) {
    log_warning(cat(folder.string(), ": read the ", views.files.size(), " views that are named like ",
                    views.files.begin()->second.filename().string(), "; left out ", views.others,
                    " with other names, give each light field its own folder"));
  }
  if (!views.reading.empty()) log_info(cat(folder.string(), ": ", views.reading));
  ChosenGrid grid;
  E2LF_ASSIGN_OR_RETURN(const std::vector<fs::path> files, choose_files(views, options, folder, grid));

  // The first view determines the size of the light field.
  E2LF_ASSIGN_OR_RETURN(const RawImage first, read_view(files[0]));
  const Shape shape{grid.y.count, grid.x.count, first.height, first.width, options.colour ? first.channels : 1};
  E2LF_RETURN_IF_ERROR(check_memory(shape, sizeof(float), options, folder.string()));
  LightField out(shape);
  E2LF_RETURN_IF_ERROR(store_view(first, 0, files[0], files[0], options, out));
  if (files.size() > 1) E2LF_RETURN_IF_ERROR(read_rest(files, options, progress, out));
  E2LF_RETURN_IF_ERROR(check_values(out, options.white > 0.0F ? 0.0F : stored_view(first).white, folder.string()));
  return out;
}

}  // namespace e2lf::lightfield
