// SPDX-License-Identifier: MIT
#pragma once

#include "recnet_job.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Runs the job in oneDNN, with weights, biases and layers in between in float32, or all of them in bfloat16 with sums
/// in float32. A run, of which an untimed one is the first, converts the input and the
/// output, but not the weights.
/// `isa` limits the instruction set, as e2lf::current_isa() names it; the limit of the first call holds for the
/// process. Returns null, or an error message that is valid until the next call.
const char* e2lf_onednn_recnet(const struct E2lfRecnetJob* job, int bfloat16, const char* isa);

/// Returns the version, e.g. "2.6.3".
const char* e2lf_onednn_version(void);

#ifdef __cplusplus
}
#endif
