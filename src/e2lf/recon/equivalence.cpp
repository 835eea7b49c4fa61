// SPDX-License-Identifier: MIT
#include "e2lf/recon/equivalence.h"

#include <cmath>
#include <cstdlib>

#include "e2lf/recon/inversion.h"
#include "e2lf/recon/placed_images.h"
#include "e2lf/sensor/coded_intensity.h"

namespace e2lf::recon {
namespace {

/// The seeds of the three recordings differ by this number, so that they do not collide with neighbouring seeds of a
/// user.
constexpr uint64_t kSeedStep = uint64_t{1} << 40;

double relative_error(const capture::CodedIntensities& found, const capture::CodedIntensities& truth, size_t black,
                      float gain) {
  double errors = 0, squares = 0;
  for (size_t n = 0; n < truth.count; ++n) {
    if (n == black) continue;
    for (size_t i = 0; i < truth.image_size(); ++i) {
      const double expected = static_cast<double>(gain * truth.image(n)[i]);
      errors += std::pow(static_cast<double>(found.image(n)[i]) - expected, 2);
      squares += expected * expected;
    }
  }
  return squares > 0 ? std::sqrt(errors / squares) : 0;
}

double difference(const capture::EventImages& a, const capture::EventImages& b) {
  double sum = 0;
  for (size_t i = 0; i < a.values.size(); ++i) sum += std::pow(a.values[i] - b.values[i], 2);
  return std::sqrt(sum / static_cast<double>(a.values.size()));
}

double events_per_pixel(const capture::EventImages& images) {
  double sum = 0;
  for (const int16_t count : images.values) sum += std::abs(count);
  return sum / static_cast<double>(images.image_size());
}

}  // namespace

Result<Equivalence> measure_equivalence(const capture::Codes& codes, const std::vector<size_t>& order,
                                        const lightfield::LightField& scene, const sensor::EventModelOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities truth, sensor::coded_intensities(codes, scene));
  E2LF_ASSIGN_OR_RETURN(const capture::EventImages images, sensor::simulate_events(truth, options));
  E2LF_ASSIGN_OR_RETURN(const size_t black, black_pattern(images, codes));
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities plain,
                        invert_events(images, {black, options.constants, false}));
  E2LF_ASSIGN_OR_RETURN(const capture::CodedIntensities centred,
                        invert_events(images, {black, options.constants, true}));
  Equivalence result;
  result.intensity_error = relative_error(plain, truth, black, options.gain);
  result.centred_error = relative_error(centred, truth, black, options.gain);

  const capture::Codes other = capture::permuted(codes, order);
  sensor::EventModelOptions again = options;
  again.seed += kSeedStep;
  E2LF_ASSIGN_OR_RETURN(const capture::EventImages permuted, sensor::simulate_events(other, scene, again));
  again.seed += kSeedStep;
  E2LF_ASSIGN_OR_RETURN(const capture::EventImages repeated, sensor::simulate_events(other, scene, again));
  result.permuted_error = difference(permute_events(images, order), permuted);
  result.repeated_error = difference(repeated, permuted);
  result.events_per_pixel = events_per_pixel(images);
  result.permuted_events_per_pixel = events_per_pixel(permuted);
  return result;
}

}  // namespace e2lf::recon
