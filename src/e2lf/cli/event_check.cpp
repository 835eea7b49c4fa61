// SPDX-License-Identifier: MIT
#include "e2lf/cli/event_check.h"

#include "e2lf/eval/event_statistics.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::cli {

Result<double> event_error(const KnownCodes& known, const lightfield::LightField& light_field,
                           const events::EventImages& given) {
  sensor::EventModelOptions options;
  E2LF_ASSIGN_OR_RETURN(options.model, sensor::event_model_from_name(known.event_model));
  options.constants = known.constants;
  options.constants.sigma_w = options.constants.sigma_z = 0.0F;
  E2LF_ASSIGN_OR_RETURN(const events::EventImages simulated,
                        sensor::simulate_events(known.codes, light_field, options));
  return eval::mean_event_difference(simulated, given);
}

}  // namespace e2lf::cli
