// SPDX-License-Identifier: BSD-3-Clause
// Names of topics and services; relative, so that a session can be pushed into a namespace.
#pragma once

namespace soft_robot_lab::topics {

constexpr char actuator_command[] = "actuators/command";
constexpr char simulator_markers[] = "simulator/markers";
constexpr char tracker_markers[] = "tracker/markers";
constexpr char tracker_steps[] = "tracker/steps";  // what each of them was made from
constexpr char tracker_image[] = "tracker/image";  // what a camera sees, with the markers found
constexpr char simulator_actuators[] = "simulator/actuators";
constexpr char simulator_ranges[] = "simulator/actuator_ranges";  // latched: which commands the scene's actuators take
constexpr char simulator_joint_states[] = "simulator/joint_states";  // sensor_msgs/JointState: commands and forces
constexpr char simulator_reaction[] = "simulator/reaction";  // geometry_msgs/WrenchStamped: what holds the robot
constexpr char simulator_surface[] = "simulator/surface";
constexpr char simulator_contacts[] = "simulator/contacts";    // of scenes with contact
constexpr char simulator_obstacles[] = "simulator/obstacles";  // latched: their shapes where they stand
constexpr char simulator_pull[] = "simulator/pull";            // pulls at the skin, as a hand
constexpr char simulator_scene[] = "simulator/scene";          // std_msgs/String, latched: path of the scene that runs
constexpr char simulator_solver[] = "simulator/solver";        // std_msgs/String, latched: newton, xpbd or reduced
constexpr char controller_progress[] = "controller/progress";
constexpr char controller_target[] = "controller/target";     // latched: what the last accepted request asked for
constexpr char target_answer[] = "controller/target_answer";  // OptimisePolicyResult: of a target that was let go
constexpr char target_shown[] =
    "controller/target_shown";                           // Target: where the ball to drag shall stand, not sought yet
constexpr char controller_goal[] = "controller/goal";    // geometry_msgs/PoseStamped: where a marker shall go
constexpr char controller_ghost[] = "controller/ghost";  // latched: where the policy that was found last leads
constexpr char controller_preview[] = "controller/preview";   // latched: where the present commands lead
constexpr char controller_path[] = "controller/path";         // latched: the path that was planned last
constexpr char target_marker[] = "controller/target_marker";  // an interactive marker
constexpr char design_casting[] = "design/casting";           // latched: skin coloured by what casting says of it
constexpr char panel_tips[] = "panel/reachable_tips";         // where the marker rests over all commands
constexpr char overlay[] = "overlay";
constexpr char overlay_labels[] = "overlay/labels";  // its texts, for a display that lays them out
constexpr char overlay_image[] = "overlay/image";    // what a camera sees, with the simulated robot over it
constexpr char reality_gap[] = "reality_gap";        // tracked less simulated markers
constexpr char twin_loads[] = "twin/loads";          // TwinLoads: what acts on the robot from outside
constexpr char twin_markers[] = "twin/markers";      // all markers as the twin has them
constexpr char twin_surface[] = "twin/surface";      // latched: the skin under the estimated loads
constexpr char twin_arrows[] = "twin/arrows";        // visualization_msgs/MarkerArray: the loads
constexpr char twin_untouched[] = "twin/untouched";  // std_srvs/Trigger: nothing touches the robot now
constexpr char motor_state[] = "motor/state";
constexpr char pressure_state[] = "pressure/state";  // of a rig of air
constexpr char rig_shafts[] = "rig/shafts";          // of an emulated rig: the truth
constexpr char plant_markers[] = "plant/markers";    // of the robot that it moves: the truth
constexpr char plant_pull[] = "plant/pull";          // SkinPull: someone pushes it
constexpr char plant_surface[] = "plant/surface";

constexpr char session_recording[] = "session/recording";  // std_msgs/Bool, latched
constexpr char session_record[] = "session/record";        // std_srvs/SetBool

constexpr char simulator_reset[] = "simulator/reset";
constexpr char simulator_stop[] = "simulator/stop";  // what lasts, and the drives where they are
constexpr char simulator_load[] = "simulator/load";
constexpr char simulator_use_solver[] = "simulator/use_solver";
constexpr char motor_zero[] = "motor/zero";
constexpr char motor_stop[] = "motor/stop";    // at once; holds until motor/clear
constexpr char motor_clear[] = "motor/clear";  // faults and the emergency stop
constexpr char rig_command[] = "rig/command";
constexpr char show_balls[] = "rendered_cameras/show_balls";
constexpr char move_camera[] = "rendered_cameras/move";
constexpr char optimise_policy[] = "controller/optimise_policy";
constexpr char execute_policy[] = "controller/execute_policy";
constexpr char fit_model[] = "controller/fit_model";
constexpr char calibrate[] = "tracker/calibrate";
constexpr char check_design[] = "design/check";
constexpr char follow_path[] = "controller/follow_path";  // an action
constexpr char reach[] = "controller/reach";  // an action; of the others above the action has the service's name
constexpr char cancel_policy[] = "controller/cancel";  // what is optimised or executed now

}  // namespace soft_robot_lab::topics
