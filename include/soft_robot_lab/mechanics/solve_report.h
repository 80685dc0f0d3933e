// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Something that is wrong with a state, with place and size. Kinds and their size:
//   inverted_elements    smallest det F                    residual_not_met     residual
//   command_not_reached  what is missing, in `unit`        excessive_tension    the tension
//   untangled            elements laid out anew            slack                the path less the cable, < 0
//   outside_training     0: a reduced model did not know a command, or found no way
//   fast_obstacle        way in a time step that is cut as often as may be: it may have passed through something
//   free_motion          0: nothing resists a rigid motion of the body, which `text` names
//   snapped              by how much a node moved where the way to a rest state became unstable
//   soft_rest            by how much a node may be off a rest state at which little holds the body
//   negative_volume      of a chamber                      coarse_contact        depth between contact points
//   cable_in_silicone    depth below the skin of a cable that is in the air at rest
//   skin_in_silicone     depth, where the scene lists no contact, or in spite of it
//   rigid_overlap        depth of obstacles in one another, `actuator` a free one
struct SolveWarning {
  std::string kind;
  double size = 0.0;
  std::string unit = "1";
  std::string actuator;                            // empty where it is about the body
  std::optional<double> commanded, reached;        // in `unit`
  std::optional<Eigen::Vector3d> rest_position_m;  // of the worst element or node
  std::string text;                                // the same for a reader
};

// Adds to `all`; of two of one kind and actuator the larger stays.
void add_warning(const SolveWarning& warning, std::vector<SolveWarning>& all);

// The stages of a solve, from the plain one to the last resort, and what is counted of each.
enum class SolveStage {
  newton,            // iterations
  line_search,       // of them, those whose step was cut
  convexify,         // of them, those with a convex stiffness in place of the true one
  energy_descent,    // steps down the energy, from where Newton found no way
  halving,           // a time step, or a change of the commands, cut in two
  pseudo_transient,  // steps of a continuation in artificial time, through buckling
  untangle,          // elements laid out anew
  last_resort,       // time steps that took the end of the descent without a solution
  xpbd,              // sweeps
  reduced,           // iterations of a reduced model
  more               // stages beyond kLongestPath, not listed
};

constexpr std::size_t kLongestPath = 100;  // stages that a report lists

// A stage of a solve, and its count.
struct SolvePathStage {
  SolveStage stage = SolveStage::newton;
  int count = 0;
};

const char* name_of(SolveStage stage);

// Whether one may come right after the other; a solve starts with newton, untangle or xpbd.
bool may_follow(SolveStage before, SolveStage after);

// Adds to the end; a stage that is there already is counted on.
void enter(SolveStage stage, int count, std::vector<SolvePathStage>& path);

// What a solve did. One that did not converge says so; an equilibrium then gives back its start, a time step the best
// it had. A time step of xpbd, which does a fixed amount of work, counts as converged where it created no energy, ends
// without inverted elements, and leaves a residual of at most 1: no more than the largest force in the body.
struct SolveReport {
  bool converged = false;
  bool interrupted = false;  // and the state is the one from before
  int iterations = 0;        // Newton iterations (one linear solve each); sweeps of xpbd
  int factorisations = 0;    // of them, those that needed a new matrix
  int steps = 0;             // in time, continuation stages, or of xpbd towards rest
  int rejected_steps = 0;    // iterations repeated shorter or with a shifted matrix
  double residual = 0.0;     // at the end: force residual over the largest force in the body
  double wall_s = 0.0;
  int inverted_elements = 0;
  std::vector<SolvePathStage> path;    // the way it went
  std::vector<SolveWarning> warnings;  // about the state it ended in
  std::string message;                 // empty, or why it stopped short, with place and size
};

}  // namespace soft_robot_lab
