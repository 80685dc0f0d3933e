// SPDX-License-Identifier: BSD-3-Clause
#include "frame_recorder.h"

#include <stdexcept>
#include <string>

namespace soft_robot_lab {
namespace {

SeenRobot seen_robot(const Simulation& simulation, const Skin& skin, const CameraSetup& rig) {
  std::vector<std::string> names;
  for (const Marker& marker : simulation.markers()) names.push_back(marker.name());
  return {skin.triangles(), rig.robot_colour, rig.stickers(names)};
}

}  // namespace

FrameRecorder::FrameRecorder(const Simulation& simulation, const CameraSetup& rig, const FrameRecorderOptions& options)
    : simulation_(simulation),
      skin_(simulation.body().mesh()),
      stage_(rig.surroundings, seen_robot(simulation, skin_, rig), seen(simulation.body().mesh().nodes_m)) {
  for (RigCamera camera : rig.cameras) {
    if (options.sensor) camera.sensor = *options.sensor;
    cameras_.push_back(make_camera(camera, stage_, options.seed));
  }
}

Capture FrameRecorder::take(const SimulationState& previous, const SimulationState& present, double stamp_s) {
  const Eigen::Index node_count = simulation_.body().mesh().nodes_m.cols();
  if (previous.positions_m.cols() != node_count || present.positions_m.cols() != node_count)
    throw std::invalid_argument("a filmed state must have " + std::to_string(node_count) + " nodes");
  const double interval_s = present.time_s - previous.time_s;
  const SeenMotion motion{seen(present.positions_m), seen(previous.positions_m), interval_s};
  Capture capture;
  for (RenderedCamera& camera : cameras_) capture.frames.push_back(camera.take(stage_, motion, stamp_s, frame_));
  ++frame_;
  capture.markers_m = motion.present.stickers_m;
  for (const RenderedCamera& camera : cameras_) {
    std::vector<MarkerView>& views = capture.views.emplace_back();
    for (int marker = 0; marker < capture.markers_m.cols(); ++marker) views.push_back(view(marker, camera.camera()));
  }
  return capture;
}

SeenState FrameRecorder::seen(const Eigen::Matrix3Xd& positions_m) const {
  SeenState state{skin_.vertices_m(positions_m), {}};
  state.stickers_m.resize(3, static_cast<Eigen::Index>(simulation_.markers().size()));
  for (Eigen::Index i = 0; i < state.stickers_m.cols(); ++i)
    state.stickers_m.col(i) = simulation_.markers()[static_cast<std::size_t>(i)].position(positions_m);
  return state;
}

MarkerView FrameRecorder::view(int marker, const ExactCamera& camera) const {
  const Eigen::Vector3d point = camera.world_from_camera().inverse() * stage_.state().stickers_m.col(marker);
  MarkerView view;
  view.depth_m = point.z();
  if (point.z() <= 0) return view;
  view.pixel = camera.model().project(point);
  const StickerSight sight = stage_.sight(marker, camera.world_from_camera().translation());
  view.centre_seen = sight.centre_seen && camera.model().sees(view.pixel);
  view.share_seen = camera.model().sees(view.pixel) ? sight.share_seen : 0;
  return view;
}

}  // namespace soft_robot_lab
