// SPDX-License-Identifier: BSD-3-Clause
#include "step_monitor.h"

#include "ros/simulator/least_determinant.h"

namespace soft_robot_lab {

void RealTimeFactor::update(double session_s) {
  const double wall_s = std::chrono::duration<double>(Clock::now() - wall_start_).count();
  if (wall_s < 1.0) return;
  value_ = (session_s - session_start_s_) / wall_s;
  wall_start_ = Clock::now();
  session_start_s_ = session_s;
}

void StepMonitor::add_step(const SolveReport& report) {
  last_report_ = report;
  if (!report.converged) ++unconverged_steps_;
  for (const SolveWarning& warning : report.warnings) add_warning(warning, warnings_);
}

void StepMonitor::add_refusal(const std::string& why) {
  ++refused_commands_;
  last_refusal_ = why;
}

namespace {

using Status = NodeDiagnosis::Status;

void diagnose_solver(const RunningScene& scene, const BackgroundTraining& training, Status& status) {
  const SceneMotion& motion = scene.motion;
  const bool xpbd = scene.simulation->options().method == SolverOptions::Method::xpbd;
  status.add("solver", motion.reduced() ? "reduced" : xpbd ? "xpbd" : "newton");
  const std::string progress = training.status();
  if (!progress.empty()) status.add("reduced model", progress);
  if (!motion.reduction()) return;
  status.add("modes", motion.reduction()->choice.model->energy.modes());
  status.add("audited error [m]", motion.audits().largest_estimate_m);
  status.add("trusted error [m]", motion.audits().limit_m);
}

void diagnose_contact(const Simulation& simulation, Status& status) {
  const std::vector<ContactReading> contacts = simulation.contacts();
  double contact_n = 0.0;
  for (const ContactReading& contact : contacts) contact_n += contact.normal_force_n;
  if (!contacts.empty()) status.add("contact force [N]", contact_n);
}

}  // namespace

void StepMonitor::diagnose(RunningScene& scene, const BackgroundTraining& training, Status& status) {
  for (const SolveWarning& warning : scene.simulation->unmodelled_contact()) add_warning(warning, warnings_);
  if (unconverged_steps_ > 0) {
    status.summary(Status::WARN, "steps that did not converge: " + last_report_.message);
  } else if (!warnings_.empty()) {
    status.summary(Status::WARN, warnings_.front().text);
  } else if (training.failed()) {
    status.summary(Status::WARN, training.status());
  } else {
    status.summary(Status::OK, "runs");
  }
  const TetMesh& mesh = scene.simulation->body().mesh();
  status.add("scene", scene.path);
  status.add("elements", mesh.tet_count());
  status.add("nodes", mesh.node_count());
  status.add("expected error", scene.fidelity ? expected_error_text(*scene.fidelity) : "not asked for");
  status.add("fidelity", scene.fidelity ? sentence(*scene.fidelity) : "not asked for");
  status.add("steps not converged in the last second", unconverged_steps_);
  diagnose_solver(scene, training, status);
  status.add("iterations", last_report_.iterations);
  status.add("residual", last_report_.residual);
  status.add("inverted elements", last_report_.inverted_elements);
  status.add("least det F", least_determinant(mesh, scene.simulation->state().positions_m));
  diagnose_contact(*scene.simulation, status);
  for (const SolveWarning& warning : warnings_)
    status.add(warning.kind + (warning.actuator.empty() ? "" : " " + warning.actuator), warning.text);
  status.add("real-time factor", real_time_factor_.value());
  status.add("refused commands", refused_commands_);
  status.add("last refusal", last_refusal_);
  unconverged_steps_ = 0;
  warnings_.clear();
}

}  // namespace soft_robot_lab
