// SPDX-License-Identifier: BSD-3-Clause
// Loose things that rub on what moves: free obstacles, and bodies without holds.
//
// What friction holds goes along. A rest state of so long a way has another solution too: what holds the thing slips
// past it, and leaves it behind. Only the way in short parts says which of the two comes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "simulation_parts.h"

namespace soft_robot_lab {

class Grip {
 public:
  static constexpr double kShort = 0.05;  // a way, over half the least extent of what is held

  // Of the present state, which stands at the first of these times.
  Grip(const SimulationParts& parts, double from_s, double to_s);

  bool has_loose_things() const;
  bool carries() const;      // what it holds, by a way that is known
  bool moves_alike() const;  // all that rubs on it, so that it presses as hard on the way as at its end
  // Whether something rubs here that does not there.
  bool rubs_more_than(const Grip& before) const;
  // Whether what holds it goes so little that it cannot be left behind.
  bool goes_a_short_way() const;
  // That state's bodies by the way of their holds, and what is held by the mean way of what rubs on it.
  void carry(SimulationState& state) const;
  // Whether all that is held went along to there, more than it stayed.
  bool took_along(const SimulationState& to) const;
  // How far what rubs on it slipped on the way to there, at most, over half the least extent of what is held.
  double slip(const SimulationState& to) const;
  double least_size_m() const;  // half the least extent of the smallest loose thing

 private:
  using Way = std::optional<Eigen::Isometry3d>;
  // The free obstacles, and after them the bodies, of which some are held.
  struct Thing {
    bool loose = true;
    double size_m = 0.0;  // half its least extent, of what is loose
    Way way;              // where it is known
    double way_m = 0.0;   // of what is loose: of the place that goes furthest
    bool alike = true;    // it is that of all that rubs on it
  };
  // A place of an obstacle as that is stated, or a contact point of the skin.
  struct Side {
    int obstacle = -1;
    Eigen::Vector3d local_m = Eigen::Vector3d::Zero();
  };
  struct Rub {
    int thing = 0, other = -1;  // among the things; -1: an obstacle that moves
    double force_n = 0.0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    Side one, two;
    ContactTouch touch;  // of skin
    Way way;             // of an obstacle that moves
  };
  // Which two rub there: the things, and the obstacle.
  using Sides = std::array<int, 3>;
  static Sides sides(const Rub& rub) { return {rub.thing, rub.other, rub.two.obstacle}; }
  // Of all places where the same two rub: the mean, by force.
  struct Slipped {
    int thing = 0;
    double mean_m = 0.0, force_n = 0.0;
  };

  void find_things(double from_s, double to_s);
  void add_skin_touches(double from_s, double to_s);
  void add_rigid_touches(double from_s, double to_s);
  void add(Rub rub);
  void find_ways();
  void note_way(int thing, const Eigen::Vector3d& position_m);
  Way way_of_other(const Rub& rub, int thing) const;
  Way mean_way(int thing) const;
  // Whether what rubs on a thing goes that way, but for so much of it.
  bool all_go(int thing, const Eigen::Isometry3d& way, double differing) const;
  Way way_of_obstacle(int obstacle, double from_s, double to_s) const;
  Eigen::Vector3d slip_m(const Rub& rub, const SimulationState& to) const;
  std::vector<Slipped> slips(const SimulationState& to) const;
  const Thing& thing(int i) const { return things_[static_cast<std::size_t>(i)]; }
  Thing& thing(int i) { return things_[static_cast<std::size_t>(i)]; }

  const SimulationParts& parts_;
  const ContactTerm& contact_;
  Eigen::Matrix3Xd start_m_;  // of the nodes
  ContactState start_contact_;
  std::vector<Thing> things_;
  std::vector<Rub> rubs_;
};

}  // namespace soft_robot_lab
