// SPDX-License-Identifier: MIT
#include "e2lf/cli/event_check.h"

#include "e2lf/base/text.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::cli {

Result<double> event_error(const KnownCodes& known, const lightfield::LightField& light_field, float gain,
                           const events::EventImages& given) {
  if (known.codes.num_patterns != given.transitions + 1) {
    return Error{ErrorCode::kShape,
                 cat("the codes have ", known.codes.num_patterns, " patterns, the events ", given.transitions,
                     " transitions; give the codes that the events were made with"),
                 "--codes"};
  }
  sensor::EventModelOptions options;
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(known.event_model));
  options.constants = known.constants;
  options.gain = 1.0F / gain;
  options.constants.sigma_w = options.constants.sigma_z = 0.0F;
  E2LF_ASSIGN_OR_RETURN(const events::EventImages simulated,
                        sensor::simulate_events(known.codes, light_field, options));
  return eval::mean_event_difference(simulated, given);
}

}  // namespace e2lf::cli
