// SPDX-License-Identifier: BSD-3-Clause
// The values that the panel shows for actuators, and what of them is to be sent. Knows no window.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ActuatorRanges.h>
#include <soft_robot_lab/ActuatorState.h>

namespace soft_robot_lab {

// One actuator as it is shown: metres as millimetres, large pressures as kPa. All numbers are in the unit that is
// shown.
struct ActuatorRow {
  std::string name;
  std::string unit;               // to be written behind numbers; empty for contraction and beta
  double command_per_unit = 1.0;  // of the command, for one that is shown
  double rest = 0.0;              // the command that asks for nothing
  double min = 0.0;
  double max = 0.0;
  double step = 0.001;   // of the slider
  int decimals = 4;      // of the typed number; finer than the step
  double shown = 0.0;    // the number that is shown is the number that is sent
  std::string measured;  // "0.912, 3.1 N": as reached within the drive's speed, and what it measures

  double command() const { return command_per_unit * shown; }  // in its own unit

  int positions() const;                // of the slider, counted from 0
  int position_of(double value) const;  // nearest
  int position() const { return position_of(shown); }
  double value_at(int slider_position) const;
};

class ActuatorValues {
 public:
  // Rows begin anew, at the model's values. Throws std::invalid_argument for lists of different lengths, and for ranges
  // that are empty or not finite; then there are no rows.
  void set_ranges(const ActuatorRanges& ranges);

  // What holds now, whoever asked for it. A row that was just edited keeps its value until its own command holds, or
  // `timeout_s` has passed without. Returns whether a row changed what it shows.
  bool add_state(const ActuatorState& state, double now_s);

  // Rounds to what is shown, and keeps within the limits; what was shown before is not sent again. An unknown name is
  // ignored.
  void edit(const std::string& name, double value, double now_s);
  void edit_all_to_rest(double now_s);
  void edit_all_to_reached(double now_s);  // stops drives that are on their way

  // What was edited since the last call; no names where nothing was.
  ActuatorCommand take_command();

  const std::vector<ActuatorRow>& rows() const { return rows_; }
  int revision() const { return revision_; }  // grows where rows come or go, not where values change

  static constexpr double timeout_s = 1.0;

 private:
  struct Edit {
    double command;
    double since_s;
    bool sent;
  };
  ActuatorRow* find(const std::string& name);
  bool follow(ActuatorRow& row, double command, double now_s);

  std::vector<ActuatorRow> rows_;
  std::map<std::string, Edit> edits_;  // that do not hold yet
  std::map<std::string, double> commands_, reached_;
  int revision_ = 0;
};

}  // namespace soft_robot_lab
