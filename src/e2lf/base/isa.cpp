// SPDX-License-Identifier: MIT
#include "e2lf/base/isa.h"

#include <cstdint>
#include <cstdlib>

#include <hwy/highway.h>
#include <hwy/targets.h>

#include "e2lf/base/text.h"

namespace e2lf {
namespace {

struct Isa {
  const char* name;
  int64_t targets;  ///< what the cap leaves on (Highway keeps its baseline in any case)
};

constexpr int64_t kScalar = HWY_SCALAR | HWY_EMU128;
constexpr int64_t kSse4 = kScalar | HWY_SSSE3 | HWY_SSE4;
constexpr int64_t kAvx2 = kSse4 | HWY_AVX2;
constexpr int64_t kAvx512 = kAvx2 | HWY_AVX3 | HWY_AVX3_DL;

const std::vector<Isa>& isas() {
  static const std::vector<Isa> list = {{"scalar", kScalar}, {"sse4", kSse4}, {"avx2", kAvx2}, {"avx512", kAvx512}};
  return list;
}

}  // namespace

Result<void> set_max_isa(const std::string& word) {
  // Not DisableTargets(): in Highway 1.0 every call of SupportedTargets() dispatches to the disabled ones again.
  hwy::SetSupportedTargetsForTest(0);
  if (!word.empty()) {
    const Isa* chosen = nullptr;
    std::vector<std::string> names;
    for (const Isa& isa : isas()) {
      names.emplace_back(isa.name);
      if (word == isa.name) chosen = &isa;
    }
    if (chosen == nullptr) {
      return Error{ErrorCode::kInvalidValue, cat("unknown instruction set \"", word, "\"; use one of ", join(names)),
                   "E2LF_MAX_ISA"};
    }
    hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & chosen->targets);
  }
  return {};
}

Result<void> apply_isa_cap() {
  const char* word = std::getenv("E2LF_MAX_ISA");
  return word == nullptr ? Result<void>() : set_max_isa(word);
}

std::string current_isa() {
  return available_isas().back();
}

std::vector<std::string> available_isas() {
  const int64_t usable = hwy::SupportedTargets();
  std::vector<std::string> names;
  int64_t previous = 0;
  for (const Isa& isa : isas()) {
    if (names.empty() || (usable & isa.targets) != (usable & previous)) names.emplace_back(isa.name);
    previous = isa.targets;
  }
  return names;
}

}  // namespace e2lf
