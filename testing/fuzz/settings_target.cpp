// SPDX-License-Identifier: MIT
// The target of JSON settings (run.json, --config) and of --set: the first line is a setting "a.b=value", the rest the
// JSON it is applied to.
#include <algorithm>

#include "e2lf/files/options.h"
#include "require.h"

namespace {

struct Settings {
  std::string verb;
  uint64_t seed = 0;
  int threads = 0;
  float tau = 0;
  bool overwrite = false;
  std::vector<std::string> inputs;
  std::optional<double> gain;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf;
  using fuzz::require;
  const std::string input(reinterpret_cast<const char*>(data), size);
  const size_t line = std::min(input.find('\n'), input.size());
  auto json = parse_json(input.substr(std::min(line + 1, input.size())), "input");
  if (!json) return 0;
  const auto changed = apply_override(*json, input.substr(0, line));
  require(changed.ok() || !changed.error().message.empty(), "an error says what is wrong");
  const auto back = parse_json(json->dump(-1, ' ', false, Json::error_handler_t::replace), "encoded");
  require(back.ok(), "JSON comes back as written");
  Settings settings;
  OptionReader reader(*json, "input");
  reader.read("verb", settings.verb).read("seed", settings.seed).read("threads", settings.threads);
  reader.read("tau", settings.tau).read("overwrite", settings.overwrite).read("inputs", settings.inputs);
  reader.read("gain", settings.gain);
  OptionReader options(reader.child("options"), reader.child_location("options"));
  options.read("seed", settings.seed).read("gain", settings.gain);
  (void)options.finish();
  (void)reader.finish();
  return 0;
}
