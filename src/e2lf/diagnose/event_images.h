// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/diagnose/finding.h"

namespace e2lf::diagnose {

/// An orientation of the patterns on the aperture that can be distinguished from the stated one: a half turn cannot,
/// because it only changes the sign of all disparities. Each coordinate from the middle is plus or minus a stated one.
struct OtherOrientation {
  const char *name, *remedy;
  int y_of_y, y_of_x, x_of_y, x_of_x;
};
inline constexpr OtherOrientation kOtherOrientations[] = {
    {"with mirrored patterns",
     "render the patterns by `e2lf codes render --flip-x`, or state the orientation of the views", 1, 0, 0, -1},
    {"with patterns turned by 90 degrees", "render the patterns by `e2lf codes render --rotate 90`", 0, -1, 1, 0},
    {"with patterns mirrored and turned by 90 degrees",
     "render the patterns by `e2lf codes render --flip-x --rotate 90`", 0, 1, 1, 0}};

/// Returns the middle of event images, at most of this size in px.
[[nodiscard]] capture::EventImages middle_of(const capture::EventImages& events, size_t most_height, size_t most_width);

/// Where the patterns may have been on the aperture, other than stated.
struct OtherPlaces {
  std::string name;    ///< such as "with mirrored patterns"
  bool is_order;       ///< the order of the patterns, or else their orientation
  std::string remedy;  ///< as of Finding
  double mismatch;     ///< relative to that of the stated places; below 1 if these places agree better with the events
};

/// Compares the parallax in event images with the places of the patterns. The scene is seen through each pattern from
/// another place on the aperture, so that a point at disparity d is displaced between the images of two patterns by d
/// times the difference of the centres of light. For each pixel, the disparity is searched at which the levels of all
/// patterns agree best; the mean of the remaining differences is the mismatch. It is related to the mismatch of images
/// that were displaced so far that they show different things, because places that are farther apart agree less by
/// chance. Exchanged patterns and the orientations that can be distinguished are compared: a half turn only changes the
/// sign of all disparities. Neither a network nor the constants of the camera are used but for the ratio of the
/// thresholds, `on_per_off`. Flat scenes and scenes in the plane of zero disparity show no difference.
///
/// Returns nothing unless the first pattern is black, at least three others are not, and there is one pattern more than
/// event images; and if a stop is requested meanwhile.
[[nodiscard]] std::vector<OtherPlaces> compare_places(const capture::EventImages& events, const capture::Codes& codes,
                                                      float on_per_off);

/// Returns the finding that other places agree clearly better than the stated ones with the events in the middle of the
/// image, or a note that other places agree as well, so that nothing is known of them: in dim light, and in scenes
/// without depth. Returns nothing if the stated places agree best. The camera states the thresholds; without one, those
/// of the paper's event model are taken. `views` is the orientation of the views relative to the patterns.
[[nodiscard]] std::optional<Finding> check_places(const capture::EventImages& events, const capture::Codes& codes,
                                                  const std::optional<capture::SensorProfile>& camera,
                                                  const std::optional<capture::Orientation>& views = {});

/// Returns the reasons why the event images of a cycle are unlikely to show a scene: images without events, fewer
/// events than one per fifty pixels, counts of 100 per cycle or more in over half of an image, and counts of a single
/// sign. The counts may be sums over several `cycles`.
[[nodiscard]] Findings check_event_images(const capture::EventImages& images, size_t cycles = 1);

}  // namespace e2lf::diagnose
