// SPDX-License-Identifier: BSD-3-Clause
#include "python_state.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "robot/scene/reduction.h"

namespace soft_robot_lab {
namespace {

// A number's bytes stand as x86 has them.
class Writer {
 public:
  template <class Number>
  void number(const Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Number));
  }
  template <class Matrix>
  void matrix(const Matrix& values) {
    number(static_cast<std::int64_t>(values.cols() * (Matrix::ColsAtCompileTime == 1 ? values.rows() : 1)));
    bytes_.append(reinterpret_cast<const char*>(values.data()),
                  sizeof(double) * static_cast<std::size_t>(values.size()));
  }
  // Whether the optional part follows.
  template <class Part>
  bool optional(const std::optional<Part>& part) {
    number(static_cast<std::int64_t>(part.has_value()));
    return part.has_value();
  }
  void drives(const DriveStates& drives) { number(static_cast<std::int64_t>(drives.size())); }
  std::string bytes() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : next_(bytes.data()), left_(bytes.size()) {}

  template <class Number>
  void number(Number& value) {
    take(&value, sizeof(Number));
  }
  template <class Matrix>
  void matrix(Matrix& values) {
    constexpr bool vector = Matrix::ColsAtCompileTime == 1;
    constexpr std::size_t rows = vector ? 1 : Matrix::RowsAtCompileTime;
    const std::size_t count = length(rows * sizeof(double));
    const auto size = static_cast<Eigen::Index>(count);
    values.resize(vector ? size : static_cast<Eigen::Index>(rows), vector ? 1 : size);
    take(values.data(), rows * count * sizeof(double));
  }
  template <class Part>
  bool optional(std::optional<Part>& part) {
    if (length(0) != 0) part.emplace();
    return part.has_value();
  }
  void drives(DriveStates& drives) { drives.resize(length(4 * sizeof(double))); }
  bool at_end() const { return left_ == 0; }

 private:
  // Of so many items of this size, which must still follow.
  std::size_t length(std::size_t item) {
    std::int64_t count = 0;
    number(count);
    if (count < 0 || (item > 0 && static_cast<std::size_t>(count) > left_ / item)) refuse();
    return static_cast<std::size_t>(count);
  }
  void take(void* to, std::size_t size) {
    if (size > left_) refuse();
    if (size > 0) std::memcpy(to, next_, size);
    next_ += size;
    left_ -= size;
  }
  [[noreturn]] static void refuse() { throw std::invalid_argument("state: its bytes are cut off or damaged"); }

  const char* next_;
  std::size_t left_;
};

template <class Archive, class Poses>
void each_of_poses(Archive& archive, Poses& poses) {
  archive.matrix(poses.centers_m);
  archive.matrix(poses.turns);
}

template <class Archive, class Velocities>
void each_of_velocities(Archive& archive, Velocities& velocities) {
  archive.matrix(velocities.linear_m_s);
  archive.matrix(velocities.angular_rad_s);
}

template <class Archive, class Drives>
void each_of_drives(Archive& archive, Drives& drives) {
  archive.drives(drives);
  for (auto& drive : drives) {
    archive.number(drive.command);
    archive.number(drive.actuated_command);
    archive.number(drive.wait_s);
    archive.matrix(drive.memory);
  }
}

template <class Archive, class Contact>
void each_of_contact(Archive& archive, Contact& contact) {
  archive.number(contact.time_s);
  archive.matrix(contact.pressures_pa);
  archive.matrix(contact.anchors_m);
  each_of_poses(archive, contact.free);
  archive.matrix(contact.rigid_forces_n);
  archive.matrix(contact.rigid_ties_m);
  each_of_poses(archive, contact.free_before);
  archive.number(contact.before_s);
}

template <class Archive, class State>
void each_of_previous_step(Archive& archive, State& state) {
  archive.number(state.previous_step_s);
  archive.matrix(state.previous_positions_m);
  archive.matrix(state.previous_velocities_m_s);
  archive.matrix(state.previous_element_multipliers_pa);
  archive.matrix(state.previous_constraint_multipliers);
  archive.matrix(state.previous_pressures_pa);
  each_of_poses(archive, state.previous_free);
  each_of_velocities(archive, state.previous_free_velocities);
  archive.matrix(state.accelerations_m_s2);
  archive.matrix(state.free_forces_n);
}

template <class Archive, class State>
void each_of_full(Archive& archive, State& state) {
  archive.number(state.time_s);
  archive.matrix(state.positions_m);
  archive.matrix(state.velocities_m_s);
  archive.matrix(state.element_multipliers_pa);
  archive.matrix(state.constraint_multipliers);
  each_of_contact(archive, state.contact);
  each_of_velocities(archive, state.free_velocities);
  archive.matrix(state.element_forces_n);
  archive.matrix(state.branch_stress_pa);
  each_of_drives(archive, state.drives);
  archive.matrix(state.hold_inertia_n);
  if (archive.optional(state.rest_residual)) archive.number(*state.rest_residual);
  archive.number(state.inverted_steps);
  each_of_previous_step(archive, state);
}

template <class Archive, class State>
void each_of_reduced(Archive& archive, State& state) {
  archive.number(state.time_s);
  archive.matrix(state.at.q);
  archive.matrix(state.at.pressures);
  archive.matrix(state.at.multipliers);
  archive.matrix(state.at.pushes_n);
  archive.matrix(state.velocity);
  archive.matrix(state.previous_velocity);
  archive.number(state.previous_step_s);
  each_of_drives(archive, state.drives);
}

template <class Archive, class Place>
void each_of(Archive& archive, Place& place) {
  each_of_full(archive, place.full);
  if (archive.optional(place.reduced)) each_of_reduced(archive, *place.reduced);
}

bool same_sizes(const ReducedState& a, const ReducedState& b) {
  if (a.drives.size() != b.drives.size()) return false;
  for (std::size_t i = 0; i < a.drives.size(); ++i)
    if (a.drives[i].memory.size() != b.drives[i].memory.size()) return false;
  return a.at.q.size() == b.at.q.size() && a.at.pressures.size() == b.at.pressures.size() &&
         a.at.multipliers.size() == b.at.multipliers.size() && a.at.pushes_n.size() == b.at.pushes_n.size() &&
         a.velocity.size() == b.velocity.size() &&
         a.previous_velocity.size() == (a.previous_step_s > 0.0 ? b.velocity.size() : a.previous_velocity.size());
}

bool finite(const ReducedState& state) {
  for (const DriveState& drive : state.drives)
    if (!std::isfinite(drive.command) || !std::isfinite(drive.actuated_command) || !std::isfinite(drive.wait_s) ||
        !drive.memory.allFinite())
      return false;
  return std::isfinite(state.time_s) && state.at.q.allFinite() && state.at.pressures.allFinite() &&
         state.at.multipliers.allFinite() && state.at.pushes_n.allFinite() && state.velocity.allFinite() &&
         state.previous_velocity.allFinite() && state.previous_step_s >= 0.0 && state.previous_step_s <= 1.0;
}

void require_fits(const ReducedState& state, const std::shared_ptr<const ReducedModel>& model) {
  if (!same_sizes(state, ReducedSimulation(model).state()))
    throw std::invalid_argument("state: its sizes are not those of this reduced model");
  if (!finite(state)) throw std::invalid_argument("state: of the reduced model not finite");
  for (std::size_t i = 0; i < state.drives.size(); ++i)
    if (state.drives[i].command < model->box.min[i] || state.drives[i].command > model->box.max[i])
      throw std::invalid_argument("state: a command beyond those that this reduced model was trained for");
}

}  // namespace

std::string state_bytes(const PythonState& state) {
  Writer writer;
  each_of(writer, state.place);
  return writer.bytes();
}

PythonState state_of(const std::string& bytes) {
  PythonState state;
  Reader reader(bytes);
  each_of(reader, state.place);
  if (!reader.at_end()) throw std::invalid_argument("state: more bytes than those of a state");
  return state;
}

void go_to_or_stay(SceneMotion& motion, const PythonState& state) {
  SceneMotion::Place to = state.place;
  if (state.model != motion.simulation().model()) to.full.linearisation = nullptr;
  if (to.reduced && !motion.reduction())
    throw std::invalid_argument("state: of a reduced model, which this simulation has not");
  if (to.reduced) require_fits(*to.reduced, motion.reduction()->choice.model);
  const SceneMotion::Place before = motion.place();
  try {
    motion.go_to(to);
  } catch (...) {
    motion.go_to(before);
    throw;
  }
}

}  // namespace soft_robot_lab
