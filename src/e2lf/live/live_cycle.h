// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/polarity_check.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/arrival_clock.h"
#include "e2lf/live/size_choice.h"

namespace e2lf::live {

/// A pattern cycle as the camera delivered it.
struct LiveCycle {
  capture::Measurement counts;  ///< event images, summed over the last `cycles` cycles
  size_t cycles = 1;
  uint64_t number = 0;  ///< number of the cycle in the recording
  int64_t begin_us = 0, end_us = 0;
  uint64_t events = 0;
  float confidence = 1;
  cycles::CyclePolarity polarity = cycles::CyclePolarity::kUnknown;
  double cycle_s = 0;              ///< time from the previous cycle to this one; 0 = unknown
  Clock::time_point last_event{};  ///< arrival of its last event at this host
};

/// The light field of a cycle.
struct LiveField {
  lightfield::LightField light_field;  ///< upright, as computed by the network; see `black` and `gain`
  LiveCycle cycle;                     ///< always in full resolution
  PictureSize size = PictureSize::kFull;
  float black = 0, gain = 1;  ///< displayed values are gain * (value - black)
  double reconstruct_s = 0;
  uint64_t serial = 0;  ///< counts the light fields from 1
};

}  // namespace e2lf::live
