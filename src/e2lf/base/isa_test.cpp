// SPDX-License-Identifier: MIT
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/base/isa_test.cpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::HWY_NAMESPACE {

/// The target this copy was compiled for, and the lanes of a float vector.
int64_t compiled_target() {
  return HWY_TARGET;
}
size_t float_lanes() {
  const hwy::HWY_NAMESPACE::ScalableTag<float> d;
  return hwy::HWY_NAMESPACE::Lanes(d);
}

}  // namespace e2lf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#if defined(__x86_64__) && defined(__linux__)
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include "e2lf/base/isa.h"

namespace e2lf {
namespace {

HWY_EXPORT(compiled_target);
HWY_EXPORT(float_lanes);

class Isa : public testing::Test {
 protected:
  void TearDown() override { ASSERT_TRUE(set_max_isa("").ok()); }
};

TEST_F(Isa, StartsAtScalarAndEndsWithWhatRunsNow) {
  const auto isas = available_isas();
  ASSERT_FALSE(isas.empty());
  EXPECT_EQ(isas.front(), "scalar");
  EXPECT_EQ(isas.back(), current_isa());
}

TEST_F(Isa, CapChangesWhatKernelsAreDispatchedTo) {
  const std::map<std::string, size_t> lanes = {
      {"scalar", HWY_ARCH_ARM ? 4 : 1}, {"neon", 4}, {"sse4", 4}, {"avx2", 8}, {"avx512", 16}, {"amx", 16}};
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa).ok());
    EXPECT_EQ(current_isa(), isa);
    EXPECT_EQ(HWY_DYNAMIC_DISPATCH(float_lanes)(), lanes.at(isa))
        << isa << " runs " << hwy::TargetName(HWY_DYNAMIC_DISPATCH(compiled_target)());
  }
}

TEST_F(Isa, EmptyWordLiftsTheCap) {
  const auto all = available_isas();
  ASSERT_TRUE(set_max_isa("scalar").ok());
  EXPECT_THAT(available_isas(), testing::ElementsAre("scalar"));
  ASSERT_TRUE(set_max_isa("").ok());
  EXPECT_EQ(available_isas(), all);
}

TEST_F(Isa, RefusesAnUnknownWord) {
  const Error error = set_max_isa("mmx").error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_THAT(error.message, testing::HasSubstr("avx2"));
}

TEST_F(Isa, AnUnknownWordChangesNothing) {
  ASSERT_TRUE(set_max_isa("scalar").ok());
  ASSERT_FALSE(set_max_isa("mmx").ok());
  EXPECT_EQ(current_isa(), "scalar");
}

#if defined(__x86_64__) && defined(__linux__)
TEST_F(Isa, TilesThatTheCapExcludesAreNotAskedFor) {
  const auto tiles_permitted = [] {
    constexpr int kGetPermission = 0x1022;  // of arch_prctl(2)
    constexpr uint64_t kTileData = uint64_t{1} << 18U;
    uint64_t permitted = 0;
    return ::syscall(SYS_arch_prctl, kGetPermission, &permitted) == 0 && (permitted & kTileData) != 0;
  };
  if (tiles_permitted()) GTEST_SKIP() << "another test of this process has asked for them";
  ASSERT_TRUE(set_max_isa("avx512").ok());
  (void)available_isas();
  EXPECT_FALSE(tiles_permitted());
}
#endif

TEST_F(Isa, TakesTheCapFromTheEnvironment) {
  ::setenv("E2LF_MAX_ISA", "scalar", 1);
  EXPECT_TRUE(apply_isa_cap().ok());
  EXPECT_EQ(current_isa(), "scalar");
  ::setenv("E2LF_MAX_ISA", "nonsense", 1);
  EXPECT_EQ(apply_isa_cap().error().location, "E2LF_MAX_ISA");
  ::unsetenv("E2LF_MAX_ISA");
}

}  // namespace
}  // namespace e2lf

#endif
