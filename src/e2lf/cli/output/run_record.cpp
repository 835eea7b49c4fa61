// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/run_record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <openssl/evp.h>
#include <span>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/cli/version.h"
#include "e2lf/files/options.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

std::string hex(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string sha256(const void* data, size_t size) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  EVP_Digest(data, size, digest, &length, EVP_sha256(), nullptr);
  return hex({digest, length});
}

/// Computed in constant memory, because recordings may be larger than memory.
Result<std::string> sha256_of_file(const fs::path& path, const ProgressFn& progress) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  const size_t bytes = fs::file_size(path, ignored);
  size_t done = 0;
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  std::vector<char> chunk(size_t{1} << 20);
  do {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    EVP_DigestUpdate(context.get(), chunk.data(), static_cast<size_t>(file.gcount()));
    done += static_cast<size_t>(file.gcount());
    if (progress) progress(done, bytes);
  } while (file);
  if (!file.eof())
    return Error{ErrorCode::kIo, "cannot read the input again for its hash; check the disk", path.string()};
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  EVP_DigestFinal_ex(context.get(), digest, &length);
  return hex({digest, length});
}

/// Warns of inputs that have changed since the run that is repeated.
void warn_of_other_inputs(const Json& inputs, const Json& earlier_run) {
  if (!earlier_run.is_object() || !earlier_run.contains("inputs")) return;
  const auto whole = [](const Json& input) { return fs::absolute(input.value("path", "")).lexically_normal(); };
  for (const Json& earlier : earlier_run["inputs"]) {
    for (const Json& input : inputs) {
      if (!earlier.is_object() || whole(earlier) != whole(input)) continue;
      if (earlier.value("sha256", "") == input["sha256"]) continue;
      log_warning(
          cat(input["path"].get<std::string>(), " has changed since the earlier run, so the result will differ"));
    }
  }
}

}  // namespace

Result<std::string> sha256_of(const fs::path& path, const ProgressFn& progress) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return sha256_of_file(path, progress);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string listing;
  size_t done = 0;
  for (const fs::path& file : files) {
    E2LF_ASSIGN_OR_RETURN(const std::string hash, sha256_of(file));
    listing += hash + "  " + file.filename().string() + "\n";
    if (progress) progress(++done, files.size());
  }
  return sha256(listing.data(), listing.size());
}

RunRecord::RunRecord(std::string verb, const std::vector<fs::path>& inputs) : verb_(std::move(verb)) {
  for (const fs::path& input : inputs) add_input(input);
}

void RunRecord::add_input(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error) || fs::is_directory(path, error)) inputs_.push_back({path, ""});
}

void RunRecord::add_input(const fs::path& path, std::span<const uint8_t> bytes) {
  inputs_.push_back({path, sha256(bytes.data(), bytes.size())});
}

void RunRecord::end_step(const std::string& name) {
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - step_begin_).count();
  timings_s_[name] = std::round(seconds * 1e4) / 1e4;
  step_begin_ = now;
}

Json RunRecord::json_so_far(const Verb& verb) const {
  Json record;
  record["written_by"] = "e2lf";
  record["verb"] = verb_;
  record["version"] = kVersion;
  std::error_code ignored;
  record["folder"] = fs::current_path(ignored).string();
  record["options"] = verb.resolved_options();
  record["options"].update(resolved_);
  record["seed"] = verb.common().seed;
  record["threads"] = num_threads();
  record["complete"] = false;
  return record;
}

Result<Json> RunRecord::json(const Verb& verb) const {
  Json record = json_so_far(verb);
  record.erase("complete");
  record["inputs"] = Json::array();
  for (const Input& input : inputs_) {
    std::string hash = input.sha256;
    if (hash.empty()) {
      ProgressBar bar("hash " + input.path.filename().string(), verb.common().quiet);
      E2LF_ASSIGN_OR_RETURN(hash, sha256_of(input.path, bar.callback()));
    }
    record["inputs"].push_back({{"path", input.path.string()}, {"sha256", hash}});
  }
  warn_of_other_inputs(record["inputs"], verb.earlier_run());
  record["timings_s"] = timings_s_;
  if (!notes_.empty()) record["notes"] = notes_;
  return record;
}

Result<void> RunRecord::write(const fs::path& path, const Verb& verb) const {
  E2LF_ASSIGN_OR_RETURN(const Json record, json(verb));
  return write_file(path, json_text(record));
}

}  // namespace e2lf::cli
