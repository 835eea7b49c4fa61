// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/compare/config.h"

/// The single list of all keys of a configuration, used for reading and for the table in docs/compare.md. visit(key,
/// field, meaning) is called for each field, and visit.list(key, list, fields) for each list of objects.
namespace e2lf::compare {

template <typename Visitor>
void visit_method(MethodConfig& method, Visitor& visit) {
  visit("name", method.name, "as the tables have it");
  visit(
      "algorithm", method.algorithm,
      "or `inversion`, `regularised`, [which need no model](#methods-without-a-network), or `event-video`, [a scan of "
      "views](#a-scan-of-views)");
  visit("model", method.model,
        "a model file, or the folder of [the release](models.md#the-release); it says what is measured. Of "
        "`event-video` a "
        "[model of frames](video.md#networks)");
  visit("codes", method.codes,
        "patterns: a model file, a file of codes, the release's folder; empty: the model's, without a model the "
        "built-in ones");
  visit("camera", method.camera,
        "the camera that a network conditioned on the sensor profile receives; empty: the camera of the sensor");
  visit("passes", method.passes, "as `e2lf reconstruct --passes`");
  visit("gain", method.gain, "multiplies the result");
  visit("fit_gain", method.fit_gain, "multiply it by the factor that suits it best instead");
  visit("precision", method.precision, "arithmetic of the network; or `bfloat16`, `auto`");
  visit("optional", method.optional, "leave the method out where its files are not there");
}

template <typename Visitor>
void visit_group(GroupConfig& group, Visitor& visit) {
  visit("name", group.name, "as the tables have it");
  visit("scenes", group.scenes,
        "light fields of any format; `demo` or `demo:SEED` for a rendered one; the last part of a path may hold `*`");
  visit("stand_in", group.stand_in, "scenes to take where none of these is there");
  visit("width", group.width, "of the middle part that is taken, px; 0: all, of `demo` 512");
  visit("height", group.height, "likewise; of `demo` 384");
  visit("step", group.step, "take every so many views");
  visit("reverse_rows", group.reverse_rows, "view rows are stored bottom to top, as in some Stanford scenes");
  visit("optional", group.optional, "leave the group out where neither its scenes nor those that stand in are there");
}

template <typename Visitor>
void visit_sensor(SensorConfig& sensor, Visitor& visit) {
  visit("name", sensor.name, "as the tables have it");
  visit("camera", sensor.camera, "a camera file, or one of the bundled: `paper`, `ideal`, `evk4-lcos`");
  visit("tau", sensor.tau, "contrast threshold in place of the camera's; not for physical pixels");
  visit("sigma_w", sensor.sigma_w, "noise of the log intensity, likewise");
  visit("sigma_z", sensor.sigma_z, "noise of the threshold, likewise");
  visit("sigma_i", sensor.sigma_i, "noise of intensity images; not given: 0.005");
  visit("gain", sensor.gain, "brightness of the scenes; results are divided by it");
  visit("residue", sensor.residue, "as `e2lf simulate --residue`; not for physical pixels");
  visit("cycles", sensor.cycles, "of which one light field is made");
  visit("fit_gain", sensor.fit_gain, "`fit_gain` for every method: for cameras that a network was not made for");
}

template <typename Visitor>
void visit_config(Config& config, Visitor& visit) {
  visit("name", config.name, "title of the page");
  visit.list("methods", config.methods, [](auto& method, auto& inner) { visit_method(method, inner); });
  visit.list("scenes", config.scenes, [](auto& group, auto& inner) { visit_group(group, inner); });
  visit.list("sensors", config.sensors, [](auto& sensor, auto& inner) { visit_sensor(sensor, inner); });
  visit("seeds", config.seeds, "of the noise; figures are means over them");
  visit("metrics", config.metrics, "see [metrics](#metrics)");
  visit("pictures", config.pictures, "keep pictures of the first seed for the page");
}

}  // namespace e2lf::compare
