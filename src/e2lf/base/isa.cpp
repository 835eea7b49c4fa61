// SPDX-License-Identifier: MIT
#include "e2lf/base/isa.h"

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <hwy/highway.h>
#include <hwy/targets.h>

#if defined(__x86_64__) && defined(__linux__)
#include <cpuid.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include "e2lf/base/choice.h"

namespace e2lf {
namespace {

constexpr int64_t kScalar = HWY_SCALAR | HWY_EMU128;
constexpr int64_t kNeon = kScalar | HWY_NEON;  // on 64-bit ARM, where kernels use it under the cap "scalar", too
constexpr int64_t kSse4 = kNeon | HWY_SSSE3 | HWY_SSE4;
constexpr int64_t kAvx2 = kSse4 | HWY_AVX2;
constexpr int64_t kAvx512 = kAvx2 | (2 * HWY_AVX3 - 1);  // and all better targets; later Highways have more
constexpr const char* kAmx = "amx";                      // not a Highway target

/// The targets that each cap leaves enabled (Highway always keeps its baseline).
constexpr Choice<int64_t> kIsas[] = {{"scalar", kScalar}, {"neon", kNeon},     {"sse4", kSse4},
                                     {"avx2", kAvx2},     {"avx512", kAvx512}, {kAmx, kAvx512}};

std::atomic<bool> g_amx_allowed = true;

/// Returns true if the CPU has AMX tiles with bfloat16 and Linux grants their use to this process.
bool ask_for_amx() {
#if defined(__x86_64__) && defined(__linux__)
  constexpr unsigned kFeatures = (1U << 24U) | (1U << 22U);   // AMX-TILE, AMX-BF16
  constexpr int kRequestPermission = 0x1023, kTileData = 18;  // of arch_prctl(2)
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  if (__get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) == 0 || (edx & kFeatures) != kFeatures) return false;
  return ::syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
#else
  return false;
#endif
}

bool amx_usable(int64_t targets) {
  if (!g_amx_allowed || (targets & kAvx512 & ~kAvx2) == 0) return false;
  static const bool granted = ask_for_amx();
  return granted;
}

}  // namespace

Result<void> set_max_isa(const std::string& word) {
  const auto known = choice_of(word, kIsas);
  if (!known && !word.empty()) {
    return fail(ErrorCode::kInvalidValue, "E2LF_MAX_ISA", "unknown instruction set \"", word, "\"; use one of ",
                join(words_of(kIsas)));
  }
  // DisableTargets() is not used: in Highway 1.0, every call of SupportedTargets() dispatches to the disabled ones
  // again.
  hwy::SetSupportedTargetsForTest(0);
  g_amx_allowed = word.empty() || word == kAmx;
  if (known) hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & *known);
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
  for (const Choice<int64_t>& isa : kIsas) {
    const bool adds =
        std::string_view(isa.word) == kAmx ? amx_usable(usable) : (usable & isa.value) != (usable & previous);
    if (names.empty() || adds) names.emplace_back(isa.word);
    previous = isa.value;
  }
  return names;
}

}  // namespace e2lf
