// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/light_field_flags.h"

#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/flags/option_types.h"

namespace e2lf::cli {

void add_orientation_options(CLI::App& app, OrientationFlags& flags) {
  const auto flag = [&](const char* name, bool& value, const char* help) {
    app.add_flag(name, value, help)->group(kOrientationOptions);
  };
  flag("--turn-views", flags.turn_views,
       "turn the grid of views by 180 degrees in addition to what files state, which changes the sign of every "
       "disparity");
  flag("--flip-x", flags.flip_x, "exchange left and right views, which changes the sign of horizontal disparities");
  flag("--flip-y", flags.flip_y, "exchange upper and lower views, which changes the sign of vertical disparities");
}

void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views) {
  const char* const group = kLightFieldOptions;
  if (has_views) {
    app.add_option("--views", flags.views, "number of central views to read per axis; 0 = all")
        ->check(whole_number(0, 65535))
        ->group(group);
  }
  app.add_option("--step", flags.step, "read every N-th view, which multiplies the disparity by N")
      ->check(whole_number(1, 65535))
      ->group(group);
  app.add_option("--white", flags.white, "stored value that is white, e.g. 255; default: the largest of the type")
      ->check(positive_number())
      ->group(group);
  app.add_option("--view-columns", flags.view_columns,
                 "number of views in a row of the grid, if views are numbered consecutively (input_Cam000.png ...); "
                 "default: detected")
      ->check(whole_number(1, 10000))
      ->group(group);
  app.add_option("--lenslet-views", flags.lenslet_views,
                 "number of views per axis below a microlens, for mosaics that do not state it")
      ->check(whole_number(1, 1000))
      ->group(group);
}

lightfield::ReadOptions read_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options;
  for (lightfield::AxisViews* views : {&options.views_y, &options.views_x}) {
    views->count = flags.views;
    views->step = flags.step;
  }
  options.white = flags.white;
  options.view_columns = flags.view_columns;
  options.lenslet_views = flags.lenslet_views;
  options.orientation = flags.orientation.value();
  return options;
}

}  // namespace e2lf::cli
