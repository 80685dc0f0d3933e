#pragma once

#include <string>

namespace soft_robot_lab {

// What a solve did. A solve that did not converge says so, and leaves the best state it had. A time step of
// gauss_seidel, which does a fixed amount of work, counts as converged where it created no energy; its residual tells
// how exact it was.
struct SolveReport {
  bool converged = false;
  int iterations = 0;      // Newton iterations (one linear solve each); sweeps of gauss_seidel
  int factorisations = 0;  // of them, those that needed a new matrix
  int steps = 0;           // time steps or continuation stages
  int rejected_steps = 0;  // iterations repeated shorter or with a shifted matrix
  double residual = 0.0;   // at the end: force residual over the largest force in the body
  double wall_s = 0.0;
  int inverted_elements = 0;
  std::string message;  // empty, or why it stopped short, with place and size
};

}  // namespace soft_robot_lab
