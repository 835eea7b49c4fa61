// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/compare/config.h"

/// The single list of all keys of a configuration, used for reading and for the table in docs/compare.md; see
/// files/fields.h.
namespace e2lf::compare {

template <typename Method, typename Visitor>
void visit_method(Method& method, Visitor& visit) {
  visit("name", method.name, "name in the tables");
  visit("algorithm", method.algorithm,
        "`network`; `inversion` or `regularised`, [which need no model](#methods-without-a-network); or `event-video`, "
        "[a scan of views](#a-scan-of-views)");
  visit("model", method.model,
        "a model file, which determines the measurement, or the folder of [the release](models.md#the-release); for "
        "`event-video`, a [model of frames](video.md#networks)");
  visit("codes", method.codes,
        "the patterns: a model file, a file of codes or the folder of the release; if empty, those of the model, or "
        "the built-in patterns without a model");
  visit("camera", method.camera,
        "the camera that a network conditioned on the sensor profile receives; if empty, the camera of the sensor");
  visit("passes", method.passes, "the number of passes, as in `e2lf reconstruct --passes`");
  visit("gain", method.gain, "a factor on the result");
  visit("fit_gain", method.fit_gain, "scales each result by its least-squares factor instead");
  visit("precision", method.precision, "the arithmetic of the network: `float32`, `bfloat16` or `auto`");
  visit("optional", method.optional, "skips the method if its files are missing");
}

template <typename Group, typename Visitor>
void visit_group(Group& group, Visitor& visit) {
  visit("name", group.name, "name in the tables");
  visit("scenes", group.scenes,
        "light fields of any format, or `demo` or `demo:SEED` for a rendered scene; the last component of a path may "
        "contain `*`");
  visit("stand_in", group.stand_in, "scenes to use if none of `scenes` exists");
  visit("width", group.width,
        "the width of the central crop in px; 0 takes the whole view, which is 512 px wide for `demo`");
  visit("height", group.height,
        "the height of the crop in px; 0 takes the whole view, which is 384 px high for `demo`");
  visit("step", group.step, "takes every Nth view, which multiplies the disparity by N");
  visit("reverse_rows", group.reverse_rows,
        "the rows of views are stored from bottom to top, as in some Stanford scenes");
  visit("optional", group.optional, "skips the group if neither `scenes` nor `stand_in` exist");
}

template <typename Sensor, typename Visitor>
void visit_sensor(Sensor& sensor, Visitor& visit) {
  visit("name", sensor.name, "name in the tables");
  visit("camera", sensor.camera, "a camera file, or the name of a bundled one: `paper`, `ideal`, `evk4-lcos`");
  visit("tau", sensor.tau, "overrides the contrast threshold of the camera; not for physical pixels");
  visit("sigma_w", sensor.sigma_w, "overrides the noise of the log intensity; not for physical pixels");
  visit("sigma_z", sensor.sigma_z, "overrides the noise of the threshold; not for physical pixels");
  visit("sigma_i", sensor.sigma_i, "noise of intensity images; 0.005 if not given");
  visit("gain", sensor.gain, "a factor on the brightness of the scenes, by which the results are divided again");
  visit("residue", sensor.residue, "the residue, as in `e2lf simulate --residue`; not for physical pixels");
  visit("cycles", sensor.cycles, "the number of cycles from which each light field is reconstructed");
  visit("fit_gain", sensor.fit_gain,
        "sets `fit_gain` for every method, for cameras that the networks were not trained for");
}

template <typename Fields, typename Visitor>
void visit_config(Fields& config, Visitor& visit) {
  visit("name", config.name, "title of the page");
  visit.list("methods", config.methods, [](auto& method, auto& inner) { visit_method(method, inner); });
  visit.list("scenes", config.scenes, [](auto& group, auto& inner) { visit_group(group, inner); });
  visit.list("sensors", config.sensors, [](auto& sensor, auto& inner) { visit_sensor(sensor, inner); });
  visit("seeds", config.seeds, "the seeds of the noise, over which the figures are averaged");
  visit("metrics", config.metrics, "see [metrics](#metrics)");
  visit("pictures", config.pictures, "keeps the images of the first seed for the page");
}

}  // namespace e2lf::compare
