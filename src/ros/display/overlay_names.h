// SPDX-License-Identifier: BSD-3-Clause
// Namespaces of the overlay's labels that stand for more than a text at a place.
#pragma once

namespace soft_robot_lab::overlay_names {

constexpr char tension_scale[] = "tension_scale";  // a line of colours; its text: what the last one means
constexpr char error[] = "error";                  // a line from a marker to its target; its text: how long that is
constexpr char gap[] = "gap_rms";                  // a text of the whole robot

}  // namespace soft_robot_lab::overlay_names
