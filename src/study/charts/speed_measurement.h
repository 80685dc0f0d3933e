// SPDX-License-Identifier: BSD-3-Clause
// One run of a rung: how wrong, and at what cost.
#pragma once

#include <string>
#include <vector>

#include "speed_ladder.h"

namespace soft_robot_lab {

struct SpeedRun {
  std::string problem, poissons_ratio, rung, mode;  // mode: settled, equilibrium
  bool bullet = false;
  double size_m = 0.0;
  int nodes = 0;
  int elements = 0;
  // Whether there is an error at all: the run neither blew up nor ran out of time.
  bool ended = false;
  // Bullet: whether it came to the rest state of its own equations, which are those of our linear elements. Where its
  // linear solver stops early it does not, and may by chance stand nearer to the truth than its mesh allows.
  bool own_equilibrium = true;
  // The larger one of two, so that neither side is exact by chance: the error of the first point's displacement,
  // relative to the reference's length; and the root mean square over all points, relative to that of the fine curve.
  double error = 0.0;
  std::vector<double> curve;  // displacements at the end, x y z of each point, over the norm of the fine curve
  // Settled: CPU-seconds per simulated second, counting only the steps in which the solver iterated, so that a body
  // asleep costs nothing and counts for nothing. Equilibrium: CPU-seconds. Without meshing and reading.
  double cost = 0.0;
  double cpu_s = 0.0;             // of the whole run
  double iterations = 0.0;        // settled: per step; equilibrium: all. Ours only.
  double frequency_error = -1.0;  // of the lowest vibration, relative; negative: not asked for
  std::string message;            // what went wrong, or ""
};

struct MeasuringTools {
  std::string mesher;  // as in SceneOptions
  std::string bullet;  // the program bullet_peer; empty: there is none
  double time_step_s = 0.0;
  double judged_s = 0.0;
  double cpu_limit_s = 0.0;  // Bullet only
};

// Short runs are repeated and the cheapest counts, as other work on the machine only adds.
inline constexpr int kRepeats = 3;
inline constexpr double kLong_s = 1.0;  // CPU time above which a run is not repeated
SpeedRun measure(const SpeedProblem& problem, std::size_t poissons_ratio, const SpeedRung& rung, double size,
                 bool settled, const MeasuringTools& tools);

// Relative error of the lowest frequency against `frequency_hz`.
double measure_frequency(const SpeedProblem& problem, const std::string& poissons_ratio, const SpeedRung& rung,
                         double size, double frequency_hz, const MeasuringTools& tools);

// Judges Bullet's runs by our linear elements' on the same mesh, where there is such a run.
void judge_equilibria(std::vector<SpeedRun>& runs);

// How far one gets at what cost: the runs at rest that no other run beats in both, from cheap to exact.
std::vector<SpeedRun> best_of(std::vector<SpeedRun> runs);

}  // namespace soft_robot_lab
