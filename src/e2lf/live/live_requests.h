// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2lf/live/session.h"

namespace e2lf::live {

/// What a page is answered.
struct Answer {
  int status = 200;  ///< as of HTTP
  std::string type = "application/json", body = "{}";
};

/// The parameters of a request, which may come from anyone: numbers that are none count as absent.
using Parameters = std::map<std::string, std::string>;

/// Answers the requests of the page about a session. A picture is four bytes (little-endian) with the length of a JSON
/// header, the header, and grey pixels of 8 bits: {"width", "height", ...} of the picture and, behind it, of the two
/// EPIs of `x` by `views` and `views` by `y` pixels.
///   picture?after=N&x=&y=&focus=&radius=&row=&column=   the newest picture, or 204 if none comes soon
///   events                                              the newest events, or 204
///   statistics                                          Session::json() and "recording": Recorder::json()
/// and, as commands (POST): record?on=1|0, average?cycles=K, size?to=auto|full|half|quarter, brightness.
/// Returns nothing for another request.
[[nodiscard]] std::optional<Answer> answer(Session& session, bool is_command, const std::string& name,
                                           const Parameters& parameters);

}  // namespace e2lf::live
