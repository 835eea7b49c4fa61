// SPDX-License-Identifier: MIT
// Reads folders of views; declared in readers.h.

#include <algorithm>
#include <charconv>
#include <climits>
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

constexpr int kMaxNumber = 9999;

/// Returns whether the extension of a file is that of PNG or JPEG images.
bool is_image_name(const fs::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

/// A number in a file name.
struct NameNumber {
  int value = 0;              ///< at least 0
  size_t num_minus = 0;       ///< number of "-" in front of it
  bool follows_word = false;  ///< whether a letter or a digit stands in front of these, which they may separate from it
};

/// The name of an image that may be a view: of kViewFolder ("00_00"), of kStanfordFolder ("out_00_00_-1.5_2.5"), of
/// kHciFolder, with one number ("input_cam000"), or any other with two numbers ("view_0_0", "r00_c00").
struct ViewName {
  std::string words;  ///< the name without its numbers, which all views of a light field share: "view_#_#"
  std::vector<NameNumber> numbers;
};

constexpr std::string_view kPlainName = "#_#", kStanfordName = "out_#_#", kHciName = "input_cam#";

bool is_standard(std::string_view words) {
  return words == kPlainName || words == kStanfordName || words == kHciName;
}

/// Parses the file name of an image. Returns nothing for any other file.
std::optional<ViewName> parse_view_name(const fs::path& file) {
  if (!is_image_name(file)) return std::nullopt;
  const std::string stem = lower_case(file.stem().string());
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  ViewName name;
  bool follows_word = false;  // whether a letter or a digit stands in front of `rest`
  for (std::string_view rest = stem; !rest.empty();) {
    // In the names of Stanford, the position of the camera follows.
    if (name.words == kStanfordName && rest[0] == '_') break;
    const size_t minus = std::min(rest.find_first_not_of('-'), rest.size() - 1);
    const bool has_plus = rest[0] == '+' && rest.size() > 1;
    const size_t signs = std::max<size_t>(minus, has_plus ? 1 : 0);
    if (is_digit(rest[signs])) {
      rest.remove_prefix(signs);
      NameNumber number{0, minus, follows_word};
      const auto [end, status] = std::from_chars(rest.data(), rest.data() + rest.size(), number.value);
      if (name.numbers.size() == 2 || status != std::errc() || number.value > kMaxNumber) return std::nullopt;
      rest.remove_prefix(static_cast<size_t>(end - rest.data()));
      name.numbers.push_back(number);
      name.words += '#';
      follows_word = true;
    } else {
      follows_word = rest[0] >= 'a' && rest[0] <= 'z';
      name.words += rest[0];
      rest.remove_prefix(1);
    }
  }
  return name.numbers.size() == 2 || name.words == kHciName ? std::optional(std::move(name)) : std::nullopt;
}

/// The grid of views that are numbered consecutively: number = first + columns * row + column.
struct FlatGrid {
  int first = 0, columns = 1;
};

/// The numbers of rows or columns from the first to the last, which are `step` apart, since only every second view may
/// have been kept.
struct Numbers {
  int first = INT_MAX, last = INT_MIN, step = 0;

  void add(int number) {
    if (last >= first) step = std::gcd(step, number - last);
    first = std::min(first, number);
    last = std::max(last, number);
  }
  [[nodiscard]] size_t count() const { return step == 0 ? 1 : static_cast<size_t>((last - first) / step + 1); }
};

/// The files of a grid of views by (row, column), and the rows and columns that exist.
struct FolderGrid {
  std::map<std::pair<int, int>, fs::path> files;
  Numbers rows, columns;
  FlatGrid flat;  ///< of views that are numbered consecutively
};

/// Assigns rows and columns to views that are numbered consecutively, by the stated number of columns, or else in a
/// square grid, in which some views may be missing. Fails with kInvalidValue.
Result<void> place_in_rows(const ViewFiles& views, size_t columns, const fs::path& folder, FolderGrid& grid) {
  const int first = views.files.begin()->first.second, last = views.files.rbegin()->first.second;
  if (columns == 0) columns = views_per_axis(static_cast<size_t>(last - first + 1));
  if (columns == 0) {
    return fail(ErrorCode::kInvalidValue, folder, views.files.size(), " views are numbered consecutively from ", first,
                " to ", last,
                ", which is not a square grid; give the number of view columns, or copy the missing views");
  }
  grid.flat = {first, static_cast<int>(columns)};
  for (const auto& [number, file] : views.files) {
    const int at = number.second - grid.flat.first;
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
    log_info(cat(folder.string(), ": the numbers of the views go in steps of ", std::max(grid.rows.step, 1),
                 " rows and ", std::max(grid.columns.step, 1), " columns"));
  }
  return grid;
}

/// Returns the name of a missing view. In the names of Stanford, the position of the camera is unknown.
std::string missing_name(const ViewFiles& views, const FolderGrid& grid, int row, int column) {
  if (views.kind == LightFieldKind::kStanfordFolder) return formatted("out_%02d_%02d_*.png", row, column);
  if (views.kind != LightFieldKind::kHciFolder) return formatted("%02d_%02d.png", row, column);
  const fs::path like = grid.files.begin()->second.filename();
  const std::string stem = like.stem().string();
  const size_t words = kHciName.find('#');
  return cat(
      stem.substr(0, words),
      formatted("%0*d", static_cast<int>(stem.size() - words), grid.flat.first + grid.flat.columns * row + column),
      like.extension().string());
}

/// Returns the files of the selected views, row by row.
Result<std::vector<fs::path>> choose_files(const ViewFiles& views, const ReadOptions& options, const fs::path& folder,
                                           ChosenGrid& chosen) {
  E2LF_ASSIGN_OR_RETURN(const FolderGrid grid, grid_of(views, options, folder));
  E2LF_ASSIGN_OR_RETURN(chosen, choose_views(grid.rows.count(), grid.columns.count(), options, folder.string()));
  std::vector<fs::path> files;
  for (size_t view_y = 0; view_y < chosen.y.count; ++view_y) {
    for (size_t view_x = 0; view_x < chosen.x.count; ++view_x) {
      const int row = grid.rows.first + grid.rows.step * static_cast<int>(chosen.y[view_y]);
      const int column = grid.columns.first + grid.columns.step * static_cast<int>(chosen.x[view_x]);
      const auto found = grid.files.find({row, column});
      if (found == grid.files.end()) {
        return fail(ErrorCode::kNotFound, folder / missing_name(views, grid, row, column),
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

/// The files whose names differ in their numbers only.
using NameGroup = std::vector<std::pair<ViewName, fs::path>>;

/// Returns a number of each name. The "-" that are in all names only separate a number from the word or number before
/// it; others are signs.
std::vector<int> signed_numbers(const NameGroup& group, size_t which) {
  size_t separators = group.front().first.numbers[which].follows_word ? SIZE_MAX : 0;
  for (const auto& [name, file] : group) separators = std::min(separators, name.numbers[which].num_minus);
  std::vector<int> values;
  for (const auto& [name, file] : group) {
    const NameNumber& number = name.numbers[which];
    values.push_back(number.num_minus > separators ? -number.value : number.value);
  }
  return values;
}

/// Returns the views of a group by row and column. The first number is the row, unless a letter x, u or c, or a word
/// that begins with col, stands in front of it. Fails with kFormat if two files are the same view.
Result<ViewFiles> views_of(const NameGroup& group) {
  const std::string& words = group.front().first.words;
  ViewFiles views;
  if (words == kStanfordName) views.kind = LightFieldKind::kStanfordFolder;
  if (words == kHciName) views.kind = LightFieldKind::kHciFolder;
  const std::string front = words.substr(0, words.find('#'));
  const std::string word = front.substr(front.find_last_not_of("abcdefghijklmnopqrstuvwxyz") + 1);
  const bool is_column_first =
      words == kHciName || word == "x" || word == "u" || word == "c" || word.starts_with("col");
  const std::vector<int> first = signed_numbers(group, 0);
  const std::vector<int> second = words == kHciName ? std::vector<int>(group.size()) : signed_numbers(group, 1);
  for (size_t i = 0; i < group.size(); ++i) {
    const std::pair<int, int> place = is_column_first ? std::pair(second[i], first[i]) : std::pair(first[i], second[i]);
    const auto [other, is_new] = views.files.insert({place, group[i].second});
    if (is_new) continue;
    return fail(ErrorCode::kFormat, group[i].second, "the same view as ", other->second.filename().string(),
                "; remove one of the two");
  }
  if (!is_standard(words)) {
    views.reading = cat("the first number in names such as ", views.files.begin()->second.filename().string(),
                        " was taken as the ", is_column_first ? "column" : "row");
  }
  return views;
}

bool is_complete_grid(const ViewFiles& views) {
  Numbers rows, columns;
  for (const auto& [place, file] : views.files) {
    rows.add(place.first);
    columns.add(place.second);
  }
  return std::min(rows.count(), columns.count()) >= 2 && views.files.size() == rows.count() * columns.count();
}

/// Returns whether e2lf writes a picture of this name beside the views of a light field.
bool is_overview(const fs::path& file) {
  return file.filename() == "contact_sheet.png" || file.filename() == "epi.png";
}

}  // namespace

Result<ViewFiles> list_views(const fs::path& folder) {
  std::error_code error;
  std::map<std::string, NameGroup> groups;
  size_t named = 0, pictures = 0;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (auto name = parse_view_name(file)) {
      const std::string words = name->words;
      groups[words].emplace_back(*std::move(name), file);
      ++named;
    } else if (is_image_name(file) && !is_overview(file)) {
      ++pictures;
    }
  }
  if (error) return fail(ErrorCode::kIo, folder, "cannot list the folder (", error.message(), "); check it");
  const bool has_standard = std::ranges::any_of(groups, [](const auto& group) { return is_standard(group.first); });
  ViewFiles most;
  for (const auto& [words, group] : groups) {
    if (is_standard(words) != has_standard || group.size() <= most.files.size()) continue;
    Result<ViewFiles> views = views_of(group);
    // Names of any kind are those of views only if they are a complete grid.
    if (!has_standard && (!views || !is_complete_grid(*views))) continue;
    if (!views) return views;
    most = *std::move(views);
  }
  if (!most.files.empty()) most.others = named - most.files.size();
  most.pictures = pictures;
  return most;
}

std::string unread_pictures_text(const fs::path& folder) {
  constexpr std::string_view kExtensions[] = {".exr", ".tif", ".tiff", ".bmp", ".webp", ".pfm", ".ppm", ".pgm"};
  std::map<std::string, size_t> counts;
  for (const fs::path& file : paths_in(folder)) {
    const std::string extension = lower_case(file.extension().string());
    if (std::ranges::find(kExtensions, extension) != std::end(kExtensions)) ++counts[extension];
  }
  if (counts.empty()) return "";
  const auto by_count = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto& [extension, count] = *std::ranges::max_element(counts, by_count);
  return cat("the folder contains ", counted(count, "picture"), " as ", extension,
             ", which e2lf does not read; convert them to PNG with 16 bits and linear values, and name them by row and "
             "column, such as 00_00.png");
}

std::string no_views_text(const fs::path& folder) {
  const std::string unread = unread_pictures_text(folder);
  return unread.empty() ? "the folder contains no views; give one with 00_00.png ..." : unread;
}

Result<LightField> read_view_folder(const fs::path& folder, const ReadOptions& options, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const ViewFiles views, list_views(folder));
  if (views.files.empty()) {
    return fail(ErrorCode::kNotFound, folder, no_views_text(folder));
  }
  if (views.others > 0) {
    log_warning(cat(folder.string(), ": read the ", views.files.size(), " views that are named like ",
                    views.files.begin()->second.filename().string(), "; left out ", views.others,
                    " with other names, give each light field its own folder"));
  }
  if (views.pictures > 0) {
    log_info(cat(folder.string(), ": left out ", counted(views.pictures, "image"), " whose names do not number views"));
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
