// custom_sensor_model
// Simulates events with a sensor model of its own, in which OFF events require twice the change of ON events, and
// reconstructs a light field from them. Prints the PSNR of the closed-form reconstruction, which assumes equal
// thresholds, for equal and for different thresholds.
#include <cmath>
#include <cstdio>
#include <e2lf/eval/metrics.h>
#include <e2lf/lightfield/scene.h>
#include <e2lf/recon/inversion.h>
#include <e2lf/sensor/event_model.h>

namespace {

using namespace e2lf;

/// Counts the threshold crossings from each pattern to the next. Each pixel keeps its reference after its last event.
capture::EventImages count_events(const capture::CodedIntensities& intensities,
                                  const capture::SensorConstants& constants, float off_factor) {
  capture::EventImages events(intensities.count - 1, intensities.height, intensities.width);
  for (size_t pixel = 0; pixel < intensities.image_size(); ++pixel) {
    float reference = std::log(intensities.image(0)[pixel] + constants.eps);
    for (size_t k = 1; k < intensities.count; ++k) {
      const float change = std::log(intensities.image(k)[pixel] + constants.eps) - reference;
      const float threshold = change > 0 ? constants.tau : off_factor * constants.tau;
      const auto count = static_cast<int16_t>(change / threshold);
      reference += threshold * count;
      events.image(k - 1)[pixel] = count;
    }
  }
  return events;
}

Result<double> psnr(const lightfield::LightField& truth, float off_factor) {
  const capture::Codes codes = capture::default_codes();
  const capture::SensorConstants constants;
  E2LF_ASSIGN_OR_RETURN(const auto intensities, sensor::coded_intensities(codes, truth));
  const auto events = count_events(intensities, constants, off_factor);
  E2LF_ASSIGN_OR_RETURN(const auto light_field, recon::reconstruct_by_inversion(events, codes, constants));
  E2LF_ASSIGN_OR_RETURN(const auto metrics, eval::compare(truth, light_field));
  return metrics.mean.psnr_db;
}

}  // namespace

int main() {
  const auto truth = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 96, 96});
  for (const float off_factor : {1.0F, 2.0F}) {
    const auto result = psnr(truth, off_factor);
    if (!result) {
      std::fprintf(stderr, "%s\n", result.error().text().c_str());
      return 1;
    }
    std::printf("OFF threshold x %.0f: %.1f dB\n", static_cast<double>(off_factor), *result);
  }
  return 0;
}
