// SPDX-License-Identifier: MIT
#include "e2lf/files/sha256.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/sha256_blocks.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

class Sha256 {
 public:
  void add(std::span<const uint8_t> bytes) {
    bytes_ += bytes.size();
    if (!rest_.empty()) {
      const size_t missing = std::min(bytes.size(), sha256::kBlockBytes - rest_.size());
      rest_.insert(rest_.end(), bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(missing));
      bytes = bytes.subspan(missing);
      if (rest_.size() < sha256::kBlockBytes) return;
      add_blocks(rest_);
      rest_.clear();
    }
    const size_t whole = bytes.size() / sha256::kBlockBytes * sha256::kBlockBytes;
    add_blocks(bytes.first(whole));
    rest_.assign(bytes.begin() + static_cast<ptrdiff_t>(whole), bytes.end());
  }

  /// Returns the hash in hexadecimal; nothing may be added afterwards.
  std::string hex() {
    const uint64_t bits = 8 * bytes_;
    rest_.push_back(0x80);
    while (rest_.size() % sha256::kBlockBytes != sha256::kBlockBytes - sizeof bits) rest_.push_back(0);
    for (int shift = 56; shift >= 0; shift -= 8) rest_.push_back(static_cast<uint8_t>(bits >> shift));
    add_blocks(rest_);
    std::string text;
    for (const uint32_t word : state_) text += formatted("%08x", word);
    return text;
  }

 private:
  void add_blocks(std::span<const uint8_t> bytes) {
    static const auto add =
        sha256::has_sha_instructions() ? sha256::add_blocks_with_sha_instructions : sha256::add_blocks_scalar;
    add(state_, bytes.data(), bytes.size() / sha256::kBlockBytes);
  }

  sha256::HashState state_ = sha256::kInitial;
  std::vector<uint8_t> rest_;  ///< less than a block
  uint64_t bytes_ = 0;
};

Result<std::string> sha256_of_file(const fs::path& path, const ProgressFn& progress) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  const size_t bytes = fs::file_size(path, ignored);
  size_t done = 0;
  Sha256 sha256;
  std::vector<uint8_t> chunk(size_t{1} << 20);
  do {
    file.read(reinterpret_cast<char*>(chunk.data()), static_cast<std::streamsize>(chunk.size()));
    sha256.add(std::span(chunk).first(static_cast<size_t>(file.gcount())));
    done += static_cast<size_t>(file.gcount());
    if (progress) progress(done, bytes);
  } while (file);
  if (!file.eof()) {
    return fail(ErrorCode::kIo, path, "cannot read the input again for its hash; check the disk");
  }
  return sha256.hex();
}

}  // namespace

std::string sha256_of_bytes(std::span<const uint8_t> bytes) {
  Sha256 sha256;
  sha256.add(bytes);
  return sha256.hex();
}

std::string sha256_of_text(const std::string& text) {
  return sha256_of_bytes({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

Result<std::string> sha256_of(const fs::path& path, const ProgressFn& progress) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return sha256_of_file(path, progress);
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  std::string listing;
  size_t done = 0;
  for (const fs::path& file : files) {
    E2LF_ASSIGN_OR_RETURN(const std::string hash, sha256_of_file(file, {}));
    listing += hash + "  " + file.lexically_relative(path).string() + "\n";
    if (progress) progress(++done, files.size());
  }
  return sha256_of_text(listing);
}

}  // namespace e2lf
