// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/compare/jobs.h"
#include "e2lf/compare/tables.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// Makes the page of a comparison as a single file: tables, bars for each scene, the PSNR of the views, patterns with
/// their events, and pictures. `command` is shown as the command that made it.
[[nodiscard]] std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                                      const std::string& command);

/// The names of the files of write_tables().
inline constexpr const char* kTableFiles[] = {"index.html", "table.csv", "table.json", "table.tex"};

/// Writes the page and the tables of a comparison to an existing folder. Fails with kIo.
[[nodiscard]] Result<void> write_tables(const std::filesystem::path& folder, const Plan& plan, const Results& results,
                                        const ResultStore& store, const std::string& command);

/// Draws a preview of a light field: its upper left view with an enlarged inset of the middle and, below it, the
/// horizontal EPI of the middle row. If a truth of the same shape is given, the error of this view is drawn beside it,
/// from black for none to white for 0.2 and more. Views wider than 320 px are shrunk. Unless `disparity` is empty, it
/// is drawn below in the colours of depth::colour_picture(), over the range of `true_disparity`, or its own if that is
/// empty.
[[nodiscard]] lightfield::Image look(const lightfield::LightField& field, const lightfield::LightField* truth,
                                     const lightfield::Image& disparity = {},
                                     const lightfield::Image& true_disparity = {});

}  // namespace e2lf::compare
