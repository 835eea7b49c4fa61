// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2lf/live/session.h"

namespace e2lf::live {

/// The answer to a request of the page.
struct Response {
  int status = 200;  ///< HTTP status code
  std::string type = "application/json", body = "{}";
};

/// The parameters of a request. They are not trusted: a value that is not a valid number is treated as absent.
using Parameters = std::map<std::string, std::string>;

/// Answers the requests of the page about a session. A picture is sent as the length of a JSON header (four bytes,
/// little-endian), the header {"width", "height", ...}, and 8-bit grey pixels: those of the picture, followed by those
/// of the two EPIs, which have `x` by `views` and `views` by `y` pixels.
///   picture?after=N&x=&y=&focus=&radius=&row=&column=   the newest picture, or 204 if there is none soon
///   depth?after=N                                       the newest disparities, or 204 if there are none soon: int16
///                                                       [y, x] in thousandths of a px of the full size per view step
///                                                       (little-endian; -32768 where they are not finite), followed
///                                                       by their confidence (255 = 1) and a grey picture of the same
///                                                       size; "range" is depth::shown_range(), and "view" is the one
///                                                       that they are of
///   fused                                               Session::fused_cycles(), or 204; "most" is the largest number
///   events                                              the newest events, or 204
///   statistics                                          Session::json() and "recording": Recorder::json()
///   disparity?x=&y=                                     {"disparity"}: Session::disparity_at(), or 204
/// The commands (POST) are record?on=1|0, average?cycles=K, fuse?on=1|0, size?to=auto|full|half|quarter, and
/// brightness. Returns nothing for any other request.
[[nodiscard]] std::optional<Response> answer(Session& session, bool is_command, const std::string& name,
                                             const Parameters& parameters);

/// Returns all figures of the page: Session::json(), and "recording": Recorder::json().
[[nodiscard]] Json statistics(Session& session);

}  // namespace e2lf::live
