// SPDX-License-Identifier: BSD-3-Clause
// An rviz display of a skin (a marker of triangles, coloured by its corners): translucent ones show their layers from
// the farthest to the nearest, and nothing of their far sides; edges are drawn, and what turns away from the eye is
// denser, as in glass.
#pragma once

#include <string>
#include <vector>

#include <OgreColourValue.h>
#include <OgreMaterial.h>
#include <OgreVector3.h>
#include <ros/subscriber.h>
#include <rviz/display.h>
#include <visualization_msgs/Marker.h>

#include "seen_skin.h"

namespace Ogre {
class ManualObject;
}
namespace rviz {
class BoolProperty;
class RosTopicProperty;
}  // namespace rviz

namespace soft_robot_lab {

class SkinDisplay : public rviz::Display {
  Q_OBJECT
 public:
  SkinDisplay();
  ~SkinDisplay() override;

  void update(float wall_dt, float ros_dt) override;
  void reset() override;
  void setTopic(const QString& topic, const QString& datatype) override;

  std::string topic() const;
  // In the frame of the display's scene node; without corners where nothing is shown.
  const SeenSkin& skin() const { return skin_; }

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;

 private:
  void subscribe();
  void take(const visualization_msgs::Marker& marker);
  void show(const visualization_msgs::Marker& marker);
  void clear();
  void draw(const Ogre::Vector3& eye);
  void draw_triangles(const Eigen::Vector3f& eye_m);
  void draw_edges(const Eigen::Vector3f& eye_m);
  Ogre::ColourValue seen_colour(int corner, const Eigen::Vector3f& eye_m) const;

  rviz::RosTopicProperty* topic_;
  rviz::BoolProperty* edges_shown_;
  ros::Subscriber subscriber_;
  Ogre::ManualObject *triangles_ = nullptr, *edges_ = nullptr;  // of the scene
  Ogre::MaterialPtr material_, edge_material_;
  std_msgs::Header header_;
  geometry_msgs::Pose pose_;
  SeenSkin skin_;
  std::vector<Ogre::ColourValue> colours_;  // of the corners
  bool translucent_ = false, changed_ = false;
  Ogre::Vector3 drawn_from_ = Ogre::Vector3::ZERO;
};

// The first that shows a topic with this end, as "left/simulator/surface"; null where there is none.
const SkinDisplay* find_skin(rviz::DisplayContext& context, const std::string& topic);

}  // namespace soft_robot_lab
