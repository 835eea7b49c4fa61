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
       "turn the grid of views by 180 degrees, beyond what files say: every disparity changes its sign");
  flag("--flip-x", flags.flip_x, "let left and right views change places: disparities from left to right change sign");
  flag("--flip-y", flags.flip_y, "let upper and lower views change places: disparities from top to bottom change sign");
}

void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views) {
  const char* const group = kLightFieldOptions;
  if (has_views) {
    app.add_option("--views", flags.views, "take so many views per axis, the central ones; 0 = all")
        ->check(whole_number(0, 65535))
        ->group(group);
  }
  app.add_option("--step", flags.step, "take every so many views, which makes the disparity so many times larger")
      ->check(whole_number(1, 65535))
      ->group(group);
  app.add_option("--white", flags.white, "the stored number that is white, as 255; default: the largest of the type")
      ->check(positive_number())
      ->group(group);
  app.add_option(
         "--view-columns", flags.view_columns,
         "views in a row of the grid whose views are numbered one by one (input_Cam000.png ...); default: found")
      ->check(whole_number(1, 10000))
      ->group(group);
  app.add_option("--lenslet-views", flags.lenslet_views,
                 "views per axis under a microlens of a mosaic that does not say")
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
