// SPDX-License-Identifier: BSD-3-Clause
// Lamps of the panel: what /diagnostics and the gap say about one session. Knows no window.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <soft_robot_lab/RealityGap.h>

namespace soft_robot_lab {

struct Lamp {
  enum class Level { unknown, ok, warn, error };
  std::string name;  // Simulation, Speed, Reduced, Link, Gap, det F, Contact, Session
  Level level = Level::unknown;
  std::string value;   // short: "1.00 x"; empty where all is well
  std::string reason;  // in full, for the tooltip and the log line
};

class Lamps {
 public:
  // `session` is the namespace of the session's nodes, without slashes at its ends; empty for none.
  explicit Lamps(std::string session = "") : session_(std::move(session)) {}

  void add(const diagnostic_msgs::DiagnosticArray& diagnostics, double now_s);
  void add(const RealityGap& gap, double now_s);

  // Those of parts that the session has; what was not heard of for `silence_s` is unknown.
  std::vector<Lamp> lamps(double now_s) const;

  // Why a rig's motors take no commands: what its lamp says where that is red; else empty.
  std::string link_fault(double now_s) const;

  // Of a reduced model that is trained beside what runs: how far it is, [0, 1], and what is done; none is, else.
  struct Training {
    double share = 0.0;
    std::string text;
  };
  std::optional<Training> training(double now_s) const;

  static constexpr double silence_s = 4.0;

 private:
  struct Heard {
    diagnostic_msgs::DiagnosticStatus status;
    double at_s = 0.0;
  };
  Lamp lamp_of(const std::string& name, const std::string& task, double now_s) const;
  std::optional<double> value_of(const std::string& key, double now_s) const;
  std::optional<std::string> text_of_key(const std::string& key, double now_s) const;
  static Lamp training(const std::string& status);  // "training: 40 %, ..." or "not trained: ..."
  Lamp audited(double error_m, double now_s) const;
  static Lamp squeezed(double least);
  static Lamp contact(double force_n);
  bool lasts(double now_s) const;
  Lamp simulated(double now_s) const;
  Lamp speed(double now_s) const;
  Lamp gap(double now_s) const;

  std::string session_;
  std::map<std::string, Heard> heard_;  // by node and task
  double gap_rms_m_ = 0.0, gap_at_s_ = -1.0;
};

}  // namespace soft_robot_lab
