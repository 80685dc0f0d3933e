// SPDX-License-Identifier: BSD-3-Clause
// An rviz tool that takes hold of the skin under the mouse and pulls at it while it is dragged: the farther, the
// harder. The other buttons move the camera as ever.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <OgreVector3.h>
#include <ros/ros.h>
#include <rviz/tool.h>

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
  void send(const Ogre::Vector3& force_n);
  void advertise();

  ros::NodeHandle node_;
  ros::Publisher pulls_;
  rviz::FloatProperty* gain_;
  rviz::StringProperty* topic_;
  std::unique_ptr<rviz::Arrow> arrow_;
  std::optional<Ogre::Vector3> hold_m_;  // where the skin was taken hold of, in `frame_`
  std::string frame_;                    // the fixed one then: rviz lets go at its end, when it has none any more
  Ogre::Vector3 force_n_ = Ogre::Vector3::ZERO;
};

}  // namespace soft_robot_lab
