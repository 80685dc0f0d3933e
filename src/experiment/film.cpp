#include "experiment/film.h"

#include <stdexcept>

namespace soft_robot_lab {
namespace {

//         2
//        / \          a face with mid-edge nodes 3 (01), 4 (12), 5 (20)
//       5---4         becomes four triangles
//      / \ / \        .
//     0---3---1
constexpr int kQuarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

Eigen::Matrix3Xi skin_triangles(const TetMesh& mesh) {
  if (mesh.faces.rows() == 3) return mesh.faces;
  Eigen::Matrix3Xi triangles(3, 4 * mesh.faces.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int quarter = 0; quarter < 4; ++quarter)
      for (int corner = 0; corner < 3; ++corner)
        triangles(corner, 4 * face + quarter) = mesh.faces(kQuarters[quarter][corner], face);
  return triangles;
}

}  // namespace

SeenRobot seen_robot(const Simulation& simulation, const CameraRig& rig) {
  std::vector<std::string> names;
  for (const Marker& marker : simulation.markers()) names.push_back(marker.name());
  SeenRobot robot;
  robot.triangles = skin_triangles(simulation.body().mesh());
  robot.colour = rig.robot_colour;
  robot.stickers = rig.stickers(names);
  return robot;
}

SeenState seen_state(const Simulation& simulation) {
  SeenState state{simulation.state().positions_m, Eigen::Matrix3Xd(3, simulation.markers().size())};
  for (Eigen::Index i = 0; i < state.stickers_m.cols(); ++i)
    state.stickers_m.col(i) = simulation.marker_position(static_cast<int>(i));
  return state;
}

std::vector<FilmMoment> move_through(Simulation& simulation, const std::vector<CablePull>& pulls, double hold_s,
                                     double rate_hz) {
  const SolveReport rest = simulation.solve_equilibrium();
  if (!rest.converged) throw std::runtime_error("the robot's rest state was not found: " + rest.message);
  std::vector<FilmMoment> film;
  const int moments = static_cast<int>(hold_s * rate_hz);
  for (const CablePull& pull : pulls) {
    simulation.set_command(simulation.actuators().at(0)->name(), pull.left);
    simulation.set_command(simulation.actuators().at(1)->name(), pull.right);
    for (int i = 0; i < moments; ++i) {
      simulation.step();
      const SeenState before = seen_state(simulation);
      simulation.step();
      const double time_s = static_cast<double>(film.size()) / rate_hz;
      film.push_back({time_s, {seen_state(simulation), before, simulation.options().time_step_s}});
    }
  }
  return film;
}

FilmCrew::FilmCrew(const CameraRig& rig, const SeenRobot& robot, const SeenState& rest, std::uint64_t seed)
    : stage_(rig.surroundings, robot, rest) {
  for (const RigCamera& camera : rig.cameras) cameras_.push_back(make_camera(camera, stage_, seed++));
}

std::vector<RgbdFrame> FilmCrew::take(const FilmMoment& moment) {
  std::vector<RgbdFrame> frames;
  for (RenderedCamera& camera : cameras_) frames.push_back(camera.take(stage_, moment.motion, moment.time_s, frame_));
  ++frame_;
  return frames;
}

std::vector<TrackerCamera> tracker_cameras(const CameraRig& rig) {
  std::vector<TrackerCamera> cameras;
  for (const RigCamera& camera : rig.cameras)
    cameras.push_back({camera.pose.name, camera.model, camera.pose.world_from_camera});
  return cameras;
}

std::vector<TrackedMarker> tracked_markers(const Simulation& simulation) {
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : simulation.markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  return markers;
}

}  // namespace soft_robot_lab
