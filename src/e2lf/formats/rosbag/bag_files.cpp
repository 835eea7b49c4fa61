// SPDX-License-Identifier: MIT
// Finds the files of a ROS 2 bag; declared in bag.h.
#include <algorithm>
#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/rosbag/bag.h"
#include "e2lf/recordings/io/unpacked_source.h"

namespace e2lf::recordings::rosbag {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxMetadataLines = 1'000'000, kMaxFiles = 100'000;

bool is_bag_file(const fs::path& path) {
  const bool is_packed = path.extension() == ".zstd" || path.extension() == ".zst";
  const std::string extension = (is_packed ? path.stem() : path).extension().string();
  return extension == ".db3" || extension == ".mcap";
}

/// Returns the names below "relative_file_paths:". The files are in the folder itself, regardless of any path before
/// their names.
std::vector<fs::path> files_of_metadata(const fs::path& folder) {
  std::vector<fs::path> files;
  std::ifstream metadata(folder / "metadata.yaml");
  bool is_list = false;
  std::string line;
  for (size_t i = 0; i < kMaxMetadataLines && files.size() < kMaxFiles && std::getline(metadata, line); ++i) {
    const size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos) continue;
    std::string text = line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
    if (is_list && text.starts_with("- ")) {
      std::erase(text, '"');
      std::erase(text, '\'');
      files.push_back(folder / fs::path(text.substr(2)).filename());
    } else {
      is_list = text == "relative_file_paths:";
    }
  }
  return files;
}

std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_bag_file(entry.path()) && files.size() < kMaxFiles) files.push_back(entry.path());
  }
  // "bag_2" before "bag_10".
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    const std::string first = a.filename().string(), second = b.filename().string();
    return first.size() != second.size() ? first.size() < second.size() : first < second;
  });
  return files;
}

class BagFiles final : public Bag {
 public:
  explicit BagFiles(std::vector<fs::path> files) : files_(std::move(files)) {}

  std::vector<Topic> topics() const override { return bag_->topics(); }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const bool more, bag_->next(message, summary));
      summary.add_losses(std::exchange(*losses_, {}));
      if (more) return true;
      if (file_ + 1 >= files_.size()) return false;
      E2LF_RETURN_IF_ERROR(open(file_ + 1));
    }
  }

  Result<void> rewind() override { return open(0); }

  Result<void> open(size_t file) {
    file_ = file;
    *losses_ = {};
    E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(files_[file]));
    E2LF_ASSIGN_OR_RETURN(auto head, source->fetch(kDetectBytes));
    if (is_packed(head)) {
      E2LF_ASSIGN_OR_RETURN(source, make_unpacked_source(std::move(source), losses_));
      E2LF_ASSIGN_OR_RETURN(head, source->fetch(kDetectBytes));
    }
    if (detect_mcap(head)) {
      E2LF_ASSIGN_OR_RETURN(bag_, open_mcap_bag(std::move(source)));
      return {};
    }
    E2LF_ASSIGN_OR_RETURN(bag_, open_sqlite_bag(std::move(source)));
    return {};
  }

 private:
  std::vector<fs::path> files_;
  std::shared_ptr<DecodeSummary> losses_ = std::make_shared<DecodeSummary>();
  BagPtr bag_;
  size_t file_ = 0;
};

}  // namespace

bool is_bag_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) && !files_of_folder(path).empty();
}

Result<BagPtr> open_bag_folder(const fs::path& folder) {
  std::vector<fs::path> files = files_of_metadata(folder);
  if (files.empty()) files = files_of_folder(folder);
  if (files.empty()) return Error{ErrorCode::kNotFound, "the folder contains no files of a bag", folder.string()};
  auto bag = std::make_unique<BagFiles>(std::move(files));
  E2LF_RETURN_IF_ERROR(bag->open(0));
  return BagPtr(std::move(bag));
}

}  // namespace e2lf::recordings::rosbag
