// SPDX-License-Identifier: MIT
#pragma once

#include "recnet_job.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Runs the job in float32. Returns null, or an error message that is valid until the next call.
const char* e2lf_torch_recnet(const struct E2lfRecnetJob* job);

/// Returns the version, e.g. "1.13.1".
const char* e2lf_torch_version(void);

#ifdef __cplusplus
}
#endif
