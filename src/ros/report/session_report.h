// SPDX-License-Identifier: BSD-3-Clause
// One HTML page about a recorded session: how far robot and simulation were apart, when, where, and under what.
#pragma once

#include <string>

namespace soft_robot_lab {

struct SessionReport {
  std::string page;  // FOLDER/report.html; its pictures lie beside it too
  int rest_periods = 0;
  double rest_rms_m = 0.0;  // gap over all of them; 0 where there is none
};

// Throws std::runtime_error for a bag that cannot be read or holds no tracked markers (read_recorded_session), and
// where files cannot be written. `scene`: its file, where it is not the one that the bag names. `configurations`: each
// gets a page of its own.
SessionReport write_session_report(const std::string& bag, const std::string& folder, const std::string& scene = "",
                                   bool configurations = false);

}  // namespace soft_robot_lab
