// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/engine.h"

/// Networks on the devices of torch, by the module that training uses.
namespace e2lf::device {

/// Makes "cuda" and "cuda:N" known to the engine, and "torch-cpu", which is torch on the CPU and needs no GPU to be
/// tested.
void add_torch_devices();

}  // namespace e2lf::device
