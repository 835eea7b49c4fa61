// SPDX-License-Identifier: MIT
#include "bench/peers/onnx_runtime.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>

#include "e2lf/base/text.h"
#include "e2lf/files/options.h"
#include "e2lf/model/onnx/onnx_export.h"

namespace e2lf::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScript = R"(
import { createRequire } from 'node:module';
const [packages, model, height, width, runs, threads] = process.argv.slice(2);
const require = createRequire(packages + '/package.json');
const { InferenceSession, Tensor } = require('onnxruntime-node');
const session = await InferenceSession.create(model, { intraOpNumThreads: Number(threads), logSeverityLevel: 3 });
const feeds = {};
const [channels, traits] = process.argv.slice(8).map(Number);
const counts = Float32Array.from({ length: channels * height * width }, (_, i) => (i * 2654435761 % 17) - 8);
feeds.events = new Tensor('float32', counts, [1, channels, Number(height), Number(width)]);
const input = session.inputNames.find((name) => name !== 'events');
if (input) feeds[input] = new Tensor('float32', new Float32Array(traits), [1, traits]);
const seconds = [];
for (let run = 0; run <= Number(runs); ++run) {
  const begin = process.hrtime.bigint();
  await session.run(feeds);
  if (run > 0) seconds.push(Number(process.hrtime.bigint() - begin) * 1e-9);
}
console.log(JSON.stringify({ seconds }));
)";

/// A folder that vanishes with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "e2lf-onnx-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool write(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  return file.good();
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

}  // namespace

Result<PeerRuns> run_onnx_runtime(const model::Model& model, size_t height, size_t width, size_t runs, int threads,
                                  const fs::path& packages) {
  E2LF_ASSIGN_OR_RETURN(const std::string onnx, model::onnx_file(model));
  const ScratchFolder folder;
  if (folder.path().empty() || !write(folder.path() / "model.onnx", onnx) ||
      !write(folder.path() / "run.mjs", kScript)) {
    return Error{ErrorCode::kIo, "cannot write the exported model; free space in the folder for temporary files", ""};
  }
  const std::string command =
      cat("node ", quoted((folder.path() / "run.mjs").string()), " ", quoted(fs::absolute(packages).string()), " ",
          quoted((folder.path() / "model.onnx").string()), " ", height, " ", width, " ", runs, " ", threads, " ",
          model.num_patterns - 1, " ", model::num_input_channels(model::InputKind::kCamera, model.num_patterns), " 2>",
          quoted((folder.path() / "errors").string()));
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::string output;
  std::array<char, 4096> part{};
  while (pipe && std::fgets(part.data(), static_cast<int>(part.size()), pipe.get()) != nullptr) output += part.data();
  const Json json = Json::parse(output, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("seconds")) {
    return Error{ErrorCode::kMissingDependency,
                 "ONNX Runtime does not run; install Node.js, and onnxruntime-node in the folder by npm",
                 packages.string()};
  }
  std::string version;
  std::ifstream about(packages / "node_modules" / "onnxruntime-node" / "package.json");
  const Json package = Json::parse(about, nullptr, /*allow_exceptions=*/false);
  if (package.is_object()) version = package.value("version", "");
  return PeerRuns{cat("ONNX Runtime ", version), json["seconds"].get<std::vector<double>>()};
}

}  // namespace e2lf::bench
