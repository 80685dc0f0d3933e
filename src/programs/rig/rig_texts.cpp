// SPDX-License-Identifier: BSD-3-Clause
#include "rig_texts.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr double kStep_m = 6.25e-5;    // a spool of 2 mm radius, 200 steps a turn
constexpr double kStep_ml = 0.0503;    // a bore of 40 mm over a spindle of 8 mm a turn, 200 steps a turn
constexpr double kUsualSpeed = 320.0;  // full steps/s, where the robot's file has no limit

// By how much the robot on the rig differs from its model.
constexpr double kStiffnessRatio = 1.15, kDensityRatio = 1.02, kElementRatio = 0.75;
constexpr double kFriction = 0.06, kCompliance_m_n = 4e-5, kBeyondLimit = 0.1;
constexpr double kOffsets_m[] = {0.0004, -0.0003, 0.0002, -0.0002, 0.0003, -0.0004};
constexpr double kTubes_ml[] = {4, 7, 5, 6, 3, 8};
constexpr int kCablePlay_steps[] = {6, 5, 4, 7, 5, 6};
constexpr int kSyringePlay_steps[] = {3, 4, 2, 3, 4, 2};
constexpr const char* kShifts[] = {"{translation_m: [0.0015, -0.0010, 0.0009], rotation_deg: [0.05, -0.10, 0.05]}",
                                   "{translation_m: [0.0008, 0.0012, 0.0014], rotation_deg: [-0.08, 0.06, 0.04]}"};

// For comments: one line, whatever stands in a name.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return printable(text);
}

// A name as a word of YAML: in quotes where it is more than letters, digits and _.
std::string yaml_word(const std::string& name) {
  const bool plain = std::isalpha(static_cast<unsigned char>(name[0])) && name != "y" && name != "n" && name != "yes" &&
                     name != "no" && name != "on" && name != "off" && name != "true" && name != "false" &&
                     name != "null" && std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return c < 128 && (std::isalnum(c) || c == '_' || c == '.' || c == '/');
                     });
  return plain ? name : quote(name);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

// The numbers of a drive as they are usually given: tens of steps.
double speed_steps_s(const Driven& drive) {
  if (drive.speed <= 0.0) return kUsualSpeed;
  const double steps_s = drive.speed / (drive.syringe ? kStep_ml : kStep_m);
  return std::clamp(10.0 * std::ceil(steps_s / 10.0), 20.0, 15600.0);
}

std::string drive_text(const Driven& drive) {
  const double speed = speed_steps_s(drive);
  const double ramp = std::min((drive.syringe ? 10.0 : 50.0) * speed, 59000.0);
  std::ostringstream text;
  text << "{max_speed_steps_s: " << format_number(speed) << ", acceleration_steps_s2: " << format_number(ramp)
       << ", deceleration_steps_s2: " << format_number(ramp) << ", microsteps: 16}";
  return text.str();
}

std::string moved_text(const Driven& drive) {
  if (drive.syringe)
    return "syringe: {step_ml: " + format_number(kStep_ml) + ", min_ml: " + format_number(drive.min_command) +
           ", max_ml: " + format_number(drive.max_command) + "}";
  return "cable: {rest_length_m: " + format_number(drive.rest_length_m) + ", step_m: " + format_number(kStep_m) +
         ", min_contraction: " + format_number(drive.min_command) +
         ", max_contraction: " + format_number(drive.max_command) + "}";
}

bool any(const std::vector<Driven>& drives, bool syringe) {
  return std::any_of(drives.begin(), drives.end(), [&](const Driven& drive) { return drive.syringe == syringe; });
}

void write_differing_cable(std::ostream& text, const Driven& drive, std::size_t i) {
  const double offset_m = kOffsets_m[i % std::size(kOffsets_m)];
  const double most_m = 0.005 * drive.rest_length_m;
  text << "    " << yaml_word(drive.name) << ":\n";
  if (drive.model != "springs")  // which have a law of their own
    text << "      model: friction\n      friction_coefficient: "
         << format_number(std::min(drive.friction_coefficient + kFriction, 2.0))
         << "\n      compliance_m_n: " << format_number(drive.compliance_m_n + kCompliance_m_n) << "\n";
  text << "      length_offset_m: "
       << format_number(drive.length_offset_m + rounded(std::clamp(offset_m, -most_m, most_m), 1e-5))
       << "   # not as long as when its drive was zeroed\n      min_contraction: "
       << format_number(std::max(drive.min_command - kBeyondLimit, 0.05))
       << "\n      pull_speed_m_s: 0   # as fast as the shaft turns\n";
  if (drive.delayed) text << "      pull_delay_s: 0\n";
}

void write_differing_chamber(std::ostream& text, const Driven& drive, std::size_t i) {
  text << "    " << yaml_word(drive.name)
       << ": {tube_volume_ml: " << format_number(drive.tube_volume_ml + kTubes_ml[i % std::size(kTubes_ml)])
       << ", flow_ml_s: 0}   # a longer tube than believed; as fast as the shaft turns\n";
}

void write_differing_body(std::ostream& text, const YamlNode& robot, const Simulation& simulation) {
  const YamlNode body = robot.child("body");
  text << "  body:\n";
  if (!body.has("mesh"))
    text << "    element_size_m: "
         << format_number(rounded(kElementRatio * body.number_or("element_size_m", 0.01), 1e-6))
         << "   # finer than the model's\n";
  const double density_kg_m3 = std::round(kDensityRatio * simulation.body().material().density_kg_m3);
  const auto material = body.optional_child("material");
  const double ratio = kStiffnessRatio * (material ? material->number_or("stiffness_ratio", 1.0) : 1.0);
  text << "    material: {stiffness_ratio: " << format_number(ratio)
       << ", density_kg_m3: " << format_number(density_kg_m3) << "}\n";
  if (!body.has("hysteresis"))
    text << "    hysteresis: {stiffness_ratio: 0.1, relaxation_time_s: 3}   # it creeps for some seconds\n";
}

// The least of 1, 2, 5, 10, 20 ... kPa that leaves room to see a pressure beyond the limit.
double sensor_range_pa(double most_pa) {
  constexpr double kRoom = 1.1;
  for (double decade_pa = 1000.0; decade_pa < 1e6; decade_pa *= 10.0)
    for (const double factor : {1.0, 2.0, 5.0})
      if (factor * decade_pa >= kRoom * most_pa) return factor * decade_pa;
  return 3.0e6;  // where two hundredths are as much as a tolerance can be
}

// A colour of the stickers, as a tracker looks for it.
struct Hue {
  std::string name;
  int middle_deg;
};

Hue hue_of(const Eigen::Vector3d& colour) {
  const double value = colour.maxCoeff(), chroma = value - colour.minCoeff();
  if (value < 0.2 || chroma < 0.55 * value)
    throw std::invalid_argument("markers.colour of the cameras' file: [" + format_number(colour.x()) + ", " +
                                format_number(colour.y()) + ", " + format_number(colour.z()) +
                                "] is too grey or too dark to be found by its colour; allowed: the largest part at "
                                "least 0.2, the smallest at most 0.45 of it");
  double hue = 0.0;
  if (value == colour.x()) hue = 60.0 * (colour.y() - colour.z()) / chroma;
  if (value == colour.y()) hue = 120.0 + 60.0 * (colour.z() - colour.x()) / chroma;
  if (value == colour.z()) hue = 240.0 + 60.0 * (colour.x() - colour.y()) / chroma;
  const int middle_deg = static_cast<int>(std::lround(hue / 10.0) * 10 + 360) % 360;
  static constexpr const char* names[] = {"red", "yellow", "green", "cyan", "blue", "magenta"};
  return {names[((middle_deg + 30) / 60) % 6], middle_deg};
}

}  // namespace

std::string motors_text(const std::string& name, const std::vector<Driven>& drives) {
  std::ostringstream text;
  text << "# The rig that drives " << one_line(name) << ", as new_rig wrote it: " << drives.size()
       << (drives.size() == 1 ? " motor" : " motors") << " of 200 steps a turn.\n";
  if (any(drives, false)) text << "# A motor that pulls a cable has a spool of 2 mm radius.\n";
  if (any(drives, true))
    text << "# A motor that moves a plunger does so over a spindle of 8 mm a turn, in a syringe of 40 mm bore. Its "
            "command\n"
            "# is ml of travel, up to nine tenths of what the robot's file allows.\n";
  text << "device: /dev/soft_robot_lab_rig     # by config/udev/99-soft-robot-lab.rules, or a name below "
          "/dev/serial/by-id\nwatchdog_s: 0.5\ndrive: "
       << drive_text(drives.front())
       << "\nmotors:                             # in the order of the chain, from the board on\n";
  for (const Driven& drive : drives) {
    text << "  - name: " << yaml_word(drive.name) << "\n    " << moved_text(drive) << "\n    direction: 1\n";
    if (drive_text(drive) != drive_text(drives.front())) text << "    drive: " << drive_text(drive) << "\n";
  }
  return text.str();
}

bool by_air(const std::vector<Driven>& drives) { return drives.front().air; }

std::string pressures_text(const std::string& name, const std::vector<Driven>& drives) {
  double most_pa = 0.0;
  for (const Driven& drive : drives) most_pa = std::max(most_pa, drive.max_command);
  const double range_pa = sensor_range_pa(most_pa);
  std::ostringstream text;
  text << "# The rig that fills " << one_line(name) << ", as new_rig wrote it: for each chamber a pair of valves and a "
       << "sensor.\n# Commands are gauge pressures [Pa], up to nine tenths of what the robot's file allows.\n"
       << "device: /dev/soft_robot_lab_rig     # by config/udev/99-soft-robot-lab.rules, or a name below "
          "/dev/serial/by-id\nwatchdog_s: 0.5                     # then the air is let out\nsensor: {full_pa: "
       << format_number(range_pa)
       << ", zero_v: 0.5, full_v: 4.5}\nwatch: {tolerance_pa: " << format_number(0.02 * range_pa)
       << ", least_change_pa: " << format_number(0.003 * range_pa)
       << ", fault_s: 0.3}\nchannels:                           # in the order of the board's pins\n";
  for (const Driven& drive : drives)
    text << "  - {name: " << yaml_word(drive.name) << ", max_pa: " << format_number(drive.max_command)
         << ", valves: {deadband_pa: " << format_number(0.01 * range_pa) << "}}\n";
  return text.str();
}

std::string plant_text(const std::string& name, const std::string& include, const YamlNode& robot,
                       const Simulation& simulation, const std::vector<Driven>& drives, const CameraSetup& cameras) {
  std::ostringstream text;
  text << "# The " << one_line(name)
       << " that an emulated rig moves: like its model, but not quite, as robots are. new_rig wrote it.\n"
       << "# Neither the controller nor the tracker knows of it.\nrobot:\n  include: " << yaml_word(include) << "\n";
  write_differing_body(text, robot, simulation);
  for (const std::string section : {"cables", "chambers", "actuators"}) {
    bool begun = false;
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (drives[i].section != section || drives[i].air) continue;
      if (!begun) text << "  " << section << ":\n";
      begun = true;
      drives[i].syringe ? write_differing_chamber(text, drives[i], i) : write_differing_cable(text, drives[i], i);
    }
  }
  if (!by_air(drives)) text << "backlash_steps:                         # of spools, and of spindles and plungers\n";
  for (std::size_t i = 0; i < drives.size() && !by_air(drives); ++i)
    text << "  " << yaml_word(drives[i].name) << ": "
         << (drives[i].syringe ? kSyringePlay_steps : kCablePlay_steps)[i % std::size(kCablePlay_steps)] << "\n";
  text << "cameras:                                # each stands 2 mm beside where it is believed, a little turned\n";
  for (std::size_t i = 0; i < cameras.cameras.size(); ++i)
    text << "  " << yaml_word(cameras.cameras[i].pose.name) << ": " << kShifts[i % std::size(kShifts)] << "\n";
  return text.str();
}

std::string tracker_text(const std::string& name, const std::vector<std::string>& markers, const CameraSetup& cameras) {
  std::map<std::string, int> colours;
  std::map<std::string, std::string> of_marker;
  for (const Sticker& sticker : cameras.stickers(markers)) {
    const Hue hue = hue_of(sticker.colour);
    colours.insert({hue.name, hue.middle_deg});
    of_marker[sticker.name] = hue.name;
  }
  std::ostringstream text;
  text << "# How " << one_line(name) << "'s markers look: stickers of "
       << format_number(1000 * cameras.markers.diameter_m)
       << " mm on pale silicone. new_rig wrote it.\ndetector:\n  colours:\n";
  for (const auto& [colour, middle_deg] : colours)
    text << "    " << colour << ": [{hue_deg: [" << (middle_deg + 330) % 360 << ", " << (middle_deg + 30) % 360
         << "], saturation: [0.45, 1], value: [0.12, 1]}]\n";
  text << "marker_radius_m: " << format_number(cameras.markers.diameter_m / 2) << "\n";
  if (colours.size() > 1) {
    text << "marker_colours:\n";
    for (const auto& [marker, colour] : of_marker) text << "  " << yaml_word(marker) << ": " << colour << "\n";
  }
  return text.str();
}

std::string balls_text(const std::string& name, const BallPlacement& placement) {
  std::ostringstream text;
  text << "# White balls around " << one_line(name)
       << ", none of which it hides from its cameras as it hangs. new_rig wrote it.\n"
       << "radius_m: " << format_number(placement.radius_m)
       << "\nposition_sigma_m: 0.00005   # how well the positions below are known: a machined holder\nballs:\n";
  for (const PlacedBall& ball : placement.balls)
    text << "  - {name: " << ball.name << ", position_m: [" << format_number(ball.position_m.x()) << ", "
         << format_number(ball.position_m.y()) << ", " << format_number(ball.position_m.z()) << "]}\n";
  return text.str();
}

std::string poses_text(const CameraSetup& cameras) {
  std::ostringstream text;
  text << "# Where the cameras stand, as if calibrated exactly; a calibration writes over it.\ncameras:\n";
  text.precision(12);
  for (const RigCamera& camera : cameras.cameras) {
    const Eigen::Vector3d at_m = camera.pose.world_from_camera.translation();
    const Eigen::Quaterniond turn(camera.pose.world_from_camera.linear());
    text << "  - {name: " << yaml_word(camera.pose.name) << ", position_m: [" << at_m.x() << ", " << at_m.y() << ", "
         << at_m.z() << "], quaternion_xyzw: [" << turn.x() << ", " << turn.y() << ", " << turn.z() << ", " << turn.w()
         << "]}\n";
  }
  return text.str();
}

}  // namespace soft_robot_lab
