// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/program/verb.h"

namespace e2lf::info {}

/// The verbs.
namespace e2lf::cli {
using namespace info;
using namespace program;

int run_accumulate(const std::vector<std::string>& arguments);
int run_animate(const std::vector<std::string>& arguments);
int run_calibrate(const std::vector<std::string>& arguments);
int run_camera(const std::vector<std::string>& arguments);
int run_check(const std::vector<std::string>& arguments);
int run_codes(const std::vector<std::string>& arguments);
int run_codes_play(const std::vector<std::string>& arguments);
int run_compare(const std::vector<std::string>& arguments);
int run_convert(const std::vector<std::string>& arguments);
int run_demo(const std::vector<std::string>& arguments);
int run_depth(const std::vector<std::string>& arguments);
int run_epi(const std::vector<std::string>& arguments);
int run_eval(const std::vector<std::string>& arguments);
int run_info(const std::vector<std::string>& arguments);
int run_live(const std::vector<std::string>& arguments);
int run_model(const std::vector<std::string>& arguments);
int run_pack(const std::vector<std::string>& arguments);
int run_reconstruct(const std::vector<std::string>& arguments);
int run_record(const std::vector<std::string>& arguments);
int run_refocus(const std::vector<std::string>& arguments);
int run_resume(const std::vector<std::string>& arguments);
int run_simulate(const std::vector<std::string>& arguments);
int run_train(const std::vector<std::string>& arguments);
int run_video(const std::vector<std::string>& arguments);
int run_view(const std::vector<std::string>& arguments);

}  // namespace e2lf::cli
