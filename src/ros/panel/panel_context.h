// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the panel share: the session, and the line that says what came of things.
#pragma once

#include <memory>

#include "panel_link.h"
#include "status_line.h"

namespace soft_robot_lab {

struct PanelContext {
  std::unique_ptr<PanelLink> link;  // null until the panel stands in its window; parts are refreshed from then on
  StatusLine status;
};

}  // namespace soft_robot_lab
