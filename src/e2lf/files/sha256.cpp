// SPDX-License-Identifier: MIT
#include "e2lf/files/sha256.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <openssl/evp.h>
#include <vector>

#include "e2lf/base/text.h"

namespace e2lf {
namespace fs = std::filesystem;
namespace {

class Sha256 {
 public:
  Sha256() { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const void* data, size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &length);
    std::string text;
    for (const unsigned char byte : std::span(digest, length)) text += formatted("%02x", byte);
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_{EVP_MD_CTX_new(), EVP_MD_CTX_free};
};

Result<std::string> sha256_of_file(const fs::path& path, const ProgressFn& progress) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  const size_t bytes = fs::file_size(path, ignored);
  size_t done = 0;
  Sha256 sha256;
  std::vector<char> chunk(size_t{1} << 20);
  do {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    sha256.add(chunk.data(), static_cast<size_t>(file.gcount()));
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
  sha256.add(bytes.data(), bytes.size());
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
