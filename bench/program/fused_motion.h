// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/reconstruct.h"
#include "e2lf/report/page.h"

namespace e2lf::bench {

/// The number of cycles that are fused.
constexpr size_t kFusedMotionCycles = 8;

/// Reconstructs the last of kFusedMotionCycles cycles of scenes of which nothing, a square or everything moves, and of
/// the turntable: from this cycle alone, from the fused cycles, and from the mean of all. Returns rows with `motion`,
/// `part`, `one_psnr_db`, `fused_psnr_db` and `mean_psnr_db`, which are means over the scenes. `codes` are those of a
/// whole cycle, of which the network takes the lit transitions, and it is conditioned on its camera.
[[nodiscard]] Result<Json> measure_fused_motion(const std::vector<lightfield::LightField>& scenes,
                                                const capture::Codes& codes, const recon::Reconstructor& network,
                                                size_t size, uint64_t seed, bool is_quiet);

/// Returns these rows as a table.
[[nodiscard]] report::Table fused_motion_table(const Json& rows);

}  // namespace e2lf::bench
