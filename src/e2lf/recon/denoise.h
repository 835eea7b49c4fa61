// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::recon {

/// Computes the sums of `values` [y, x] over the square window of `radius` around each pixel. Border pixels are
/// repeated.
[[nodiscard]] std::vector<float> box_sums(std::span<const float> values, size_t height, size_t width, size_t radius);

/// Replaces the coded intensity after each transition k (patterns 1..N-1) by a local Wiener estimate of its logarithm
/// over a window of `radius`: mean + max(0, variance - noise) / variance * (value - mean). The noise follows from the
/// event model: sigma_w^2 + tau^2 / 12 (quantisation) + (E_k sigma_z)^2 (the threshold noise, once per event). Flat
/// areas are averaged, and edges that exceed the noise are preserved.
void denoise_intensities(capture::CodedIntensities& intensities, const capture::EventImages& images,
                         const capture::SensorConstants& constants, size_t radius);

}  // namespace e2lf::recon
