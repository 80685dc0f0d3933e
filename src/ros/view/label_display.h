// SPDX-License-Identifier: BSD-3-Clause
// An rviz display of the overlay's labels: of a fixed size in the window, beside what they name, apart from one another
// and off the skins that are shown.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <OgreMaterial.h>
#include <OgreTexture.h>
#include <ros/subscriber.h>
#include <rviz/display.h>
#include <visualization_msgs/MarkerArray.h>

#include "label_picture.h"

namespace Ogre {
class Overlay;
class PanelOverlayElement;
}  // namespace Ogre
namespace rviz {
class IntProperty;
class RosTopicProperty;
}  // namespace rviz

namespace soft_robot_lab {

class LabelDisplay : public rviz::Display {
  Q_OBJECT
 public:
  LabelDisplay();
  ~LabelDisplay() override;

  void update(float wall_dt, float ros_dt) override;
  void reset() override;
  void setTopic(const QString& topic, const QString& datatype) override;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;

 private:
  class Projection;

  void subscribe();
  void take(const visualization_msgs::MarkerArray& array);
  void forget_old();
  LabelPicture picture(const Projection& seen) const;
  void add(const visualization_msgs::Marker& marker, const Projection& seen, LabelPicture& picture) const;
  CoveredCells covered(const Projection& seen) const;
  void show(const QImage& image);

  rviz::RosTopicProperty* topic_;
  rviz::IntProperty* text_size_px_;
  ros::Subscriber subscriber_;
  Ogre::Overlay* overlay_ = nullptr;
  Ogre::PanelOverlayElement* panel_ = nullptr;
  Ogre::MaterialPtr material_;
  Ogre::TexturePtr texture_;
  struct Heard {
    visualization_msgs::Marker marker;
    ros::Time until;
  };
  std::map<std::pair<std::string, int>, Heard> heard_;
  LabelPainter painter_;
  LabelPicture shown_;  // as large as the texture, in letters of `shown_font_`
  QFont shown_font_;
};

}  // namespace soft_robot_lab
