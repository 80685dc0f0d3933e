// SPDX-License-Identifier: BSD-3-Clause
// An rviz tool that takes hold of the skin under the mouse and pulls at it by a spring to the mouse while it is
// dragged. The other buttons move the camera as ever.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <OgreVector3.h>
#include <ros/ros.h>
#include <rviz/tool.h>

#include "ros/view/seen_skin.h"

namespace rviz {
class Arrow;
class FloatProperty;
class StringProperty;
}  // namespace rviz

namespace soft_robot_lab {

class PullTool : public rviz::Tool {
  Q_OBJECT
 public:
  PullTool();
  ~PullTool() override;

  void onInitialize() override;
  void activate() override;
  void deactivate() override;
  void update(float wall_dt, float ros_dt) override;  // repeats the pull
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  void take_hold(rviz::ViewportMouseEvent& event);
  void drag(rviz::ViewportMouseEvent& event);
  void let_go();
  void say_what_to_do();  // in the line below the window
  void send(const Ogre::Vector3& hand_m, float stiffness_n_m);
  Ogre::Vector3 held_m() const;
  void show();
  void advertise();

  ros::NodeHandle node_;
  ros::Publisher pulls_;
  rviz::FloatProperty* stiffness_n_m_;
  rviz::StringProperty* topic_;
  std::unique_ptr<rviz::Arrow> arrow_;
  std::optional<Ogre::Vector3> hold_m_;  // where the skin was taken hold of, in `frame_`
  std::string frame_;                    // the fixed one then: rviz lets go at its end, when it has none any more
  SeenSkin::Place held_;                 // of the simulated skin
  std::optional<Ogre::Vector3> hand_m_;  // where the mouse is
};

}  // namespace soft_robot_lab
