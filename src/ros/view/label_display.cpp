// SPDX-License-Identifier: BSD-3-Clause
#include "label_display.h"

#include <algorithm>
#include <optional>

#include <OgreCamera.h>
#include <OgreHardwarePixelBuffer.h>
#include <OgreMaterialManager.h>
#include <OgreResourceGroupManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <OgreTextureManager.h>
#include <OgreViewport.h>
#include <Overlay/OgreOverlay.h>
#include <Overlay/OgreOverlayManager.h>
#include <Overlay/OgrePanelOverlayElement.h>
#include <pluginlib/class_list_macros.hpp>
#include <rviz/display_context.h>
#include <rviz/display_group.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/int_property.h>
#include <rviz/properties/ros_topic_property.h>
#include <rviz/render_panel.h>
#include <rviz/validate_floats.h>
#include <rviz/view_manager.h>

#include "hear_topic.h"
#include "ros/display/overlay_names.h"
#include "skin_display.h"

namespace soft_robot_lab {
namespace {

using MarkerMessage = visualization_msgs::Marker;

QColor qt_colour(const std_msgs::ColorRGBA& c) {
  return QColor::fromRgbF(std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f));
}

}  // namespace

// From the fixed frame to pixels of the window.
class LabelDisplay::Projection {
 public:
  Projection(const rviz::RenderPanel& panel, rviz::FrameManager& frames)
      : frames_(frames),
        window_px_(panel.getViewport()->getActualWidth(), panel.getViewport()->getActualHeight()),
        clip_(panel.getCamera()->getProjectionMatrix() * panel.getCamera()->getViewMatrix()) {}

  QSize window_px() const { return window_px_; }

  // None of what lies behind the eye.
  std::optional<Eigen::Vector2d> pixel(const Ogre::Vector3& at) const {
    const Ogre::Vector4 clip = clip_ * Ogre::Vector4(at.x, at.y, at.z, 1.0f);
    if (!(clip.w > 1e-6f)) return std::nullopt;
    return Eigen::Vector2d(0.5 * window_px_.width() * (1.0 + static_cast<double>(clip.x / clip.w)),
                           0.5 * window_px_.height() * (1.0 - static_cast<double>(clip.y / clip.w)));
  }

  std::optional<Eigen::Vector2d> pixel(const std_msgs::Header& header, const geometry_msgs::Point& point) const {
    geometry_msgs::Pose pose;
    pose.position = point;
    pose.orientation.w = 1.0;
    Ogre::Vector3 position;
    Ogre::Quaternion turn;
    if (!frames_.transform(header.frame_id, ros::Time(), pose, position, turn)) return std::nullopt;
    return pixel(position);
  }

  bool contains(const Eigen::Vector2d& at) const {
    return at.x() >= 0.0 && at.y() >= 0.0 && at.x() < window_px_.width() && at.y() < window_px_.height();
  }

 private:
  rviz::FrameManager& frames_;
  QSize window_px_;
  Ogre::Matrix4 clip_;
};

LabelDisplay::LabelDisplay() {
  topic_ = new rviz::RosTopicProperty(
      "Marker Topic", "", QString::fromStdString(ros::message_traits::datatype<visualization_msgs::MarkerArray>()),
      "visualization_msgs/MarkerArray of texts", this);
  connect(topic_, &rviz::Property::changed, this, [this] { subscribe(); });
  text_size_px_ = new rviz::IntProperty("Text Size", 13, "Height of letters in the window, in pixels", this);
  text_size_px_->setMin(6);
  text_size_px_->setMax(60);
}

LabelDisplay::~LabelDisplay() {
  if (!initialized()) return;
  Ogre::OverlayManager& overlays = Ogre::OverlayManager::getSingleton();
  overlays.destroy(overlay_);
  overlays.destroyOverlayElement(panel_);
  Ogre::MaterialManager::getSingleton().remove(material_->getHandle());
  if (texture_) Ogre::TextureManager::getSingleton().remove(texture_->getHandle());
}

void LabelDisplay::onInitialize() {
  static int count = 0;
  const Ogre::String name = "soft_robot_lab_labels_" + std::to_string(count++);
  material_ =
      Ogre::MaterialManager::getSingleton().create(name, Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  material_->setLightingEnabled(false);
  material_->setDepthCheckEnabled(false);
  material_->setDepthWriteEnabled(false);
  material_->setSceneBlending(Ogre::SBF_ONE, Ogre::SBF_ONE_MINUS_SOURCE_ALPHA);  // of premultiplied colours
  Ogre::OverlayManager& overlays = Ogre::OverlayManager::getSingleton();
  panel_ = static_cast<Ogre::PanelOverlayElement*>(overlays.createOverlayElement("Panel", name));
  panel_->setDimensions(1.0f, 1.0f);  // of the window
  overlay_ = overlays.create(name);
  overlay_->add2D(panel_);
}

void LabelDisplay::onEnable() { subscribe(); }

void LabelDisplay::onDisable() {
  subscriber_.shutdown();
  heard_.clear();
  overlay_->hide();
}

void LabelDisplay::reset() {
  Display::reset();
  heard_.clear();
}

void LabelDisplay::setTopic(const QString& topic, const QString& /*datatype*/) { topic_->setString(topic); }

void LabelDisplay::subscribe() {
  subscriber_.shutdown();
  subscriber_ = hear_topic<visualization_msgs::MarkerArray>(*this, update_nh_, topic_->getTopicStd(),
                                                            [this](const auto& m) { take(m); });
}

void LabelDisplay::take(const visualization_msgs::MarkerArray& array) {
  for (const MarkerMessage& marker : array.markers) {
    const auto key = std::make_pair(marker.ns, marker.id);
    if (marker.action == MarkerMessage::DELETEALL) {
      heard_.clear();
    } else if (marker.action != MarkerMessage::ADD) {
      heard_.erase(key);
    } else if (rviz::validateFloats(marker.points) && rviz::validateFloats(marker.pose.position)) {
      heard_[key] = {marker, marker.lifetime.isZero() ? ros::TIME_MAX : ros::Time::now() + marker.lifetime};
    }
  }
}

void LabelDisplay::forget_old() {
  const ros::Time now = ros::Time::now();
  for (auto one = heard_.begin(); one != heard_.end();) one = one->second.until < now ? heard_.erase(one) : ++one;
}

void LabelDisplay::update(float /*wall_dt*/, float /*ros_dt*/) {
  forget_old();
  const rviz::RenderPanel* panel = context_->getViewManager()->getRenderPanel();
  if (heard_.empty() || !panel || !panel->getViewport()) return overlay_->hide();
  const Projection seen(*panel, *context_->getFrameManager());
  if (seen.window_px().isEmpty()) return;
  QFont font;
  font.setPixelSize(qRound(text_size_px_->getInt() * panel->devicePixelRatioF()));
  LabelPicture now = picture(seen);
  const bool same_size = texture_ && QSize(static_cast<int>(texture_->getWidth()),
                                           static_cast<int>(texture_->getHeight())) == seen.window_px();
  if (overlay_->isVisible() && same_size && font == shown_font_ && look_alike(now, shown_)) return;
  show(painter_.paint(now, covered(seen), seen.window_px(), font));
  shown_ = std::move(now);
  shown_font_ = font;
}

LabelPicture LabelDisplay::picture(const Projection& seen) const {
  LabelPicture all;
  for (const auto& [key, heard] : heard_) add(heard.marker, seen, all);
  // A distance to a target first, then in the order of names, which does not change.
  std::stable_partition(all.texts.begin(), all.texts.end(), [](const LabelPicture::Text& text) { return text.strong; });
  return all;
}

void LabelDisplay::add(const MarkerMessage& marker, const Projection& seen, LabelPicture& picture) const {
  const QString text = QString::fromStdString(marker.text);
  const std::string key = marker.ns + " " + std::to_string(marker.id);
  if (marker.ns == overlay_names::tension_scale) {
    for (const std_msgs::ColorRGBA& rgba : marker.colors) picture.scale.push_back(qt_colour(rgba));
    picture.scale_end = text;
  } else if (marker.ns == overlay_names::gap) {
    picture.caption = text;
  } else if (marker.type == MarkerMessage::LINE_STRIP && marker.points.size() == 2) {
    const auto from = seen.pixel(marker.header, marker.points[0]), to = seen.pixel(marker.header, marker.points[1]);
    if (!from || !to) return;
    picture.aims.push_back({*from, *to});
    if (seen.contains(*to)) picture.texts.push_back({key, text, *to, true});
  } else if (const auto at = seen.pixel(marker.header, marker.pose.position); at && seen.contains(*at)) {
    picture.texts.push_back({key, text, *at, false});
  }
}

// By all skins that are shown.
CoveredCells LabelDisplay::covered(const Projection& seen) const {
  CoveredCells cells({seen.window_px().width(), seen.window_px().height()});
  const rviz::DisplayGroup& displays = *context_->getRootDisplayGroup();
  for (int i = 0; i < displays.numDisplays(); ++i) {
    const auto* display = dynamic_cast<SkinDisplay*>(displays.getDisplayAt(i));
    if (!display) continue;
    const Ogre::Matrix4& frame = display->getSceneNode()->_getFullTransform();
    const std::vector<Eigen::Vector3f>& corners = display->skin().corners_m();
    std::optional<Eigen::Vector2d> at[3];
    for (std::size_t corner = 0; corner < corners.size(); ++corner) {
      const Eigen::Vector3f& place = corners[corner];
      at[corner % 3] = seen.pixel(frame * Ogre::Vector3(place.x(), place.y(), place.z()));
      if (corner % 3 == 2 && at[0] && at[1] && at[2]) cells.add_triangle(*at[0], *at[1], *at[2]);
    }
  }
  return cells;
}

void LabelDisplay::show(const QImage& image) {
  const auto width = static_cast<Ogre::uint32>(image.width()), height = static_cast<Ogre::uint32>(image.height());
  Ogre::Pass* pass = material_->getTechnique(0)->getPass(0);
  if (!texture_ || texture_->getWidth() != width || texture_->getHeight() != height) {
    pass->removeAllTextureUnitStates();
    if (texture_) Ogre::TextureManager::getSingleton().remove(texture_->getHandle());
    texture_ = Ogre::TextureManager::getSingleton().createManual(
        material_->getName(), Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME, Ogre::TEX_TYPE_2D, width, height,
        0, Ogre::PF_A8R8G8B8, Ogre::TU_DYNAMIC_WRITE_ONLY);
    Ogre::TextureUnitState* unit = pass->createTextureUnitState(texture_->getName());
    unit->setTextureFiltering(Ogre::TFO_NONE);
    unit->setTextureAddressingMode(Ogre::TextureUnitState::TAM_CLAMP);
    panel_->setMaterialName(material_->getName(), material_->getGroup());
  }
  const Ogre::PixelBox box(width, height, 1, Ogre::PF_A8R8G8B8, const_cast<uchar*>(image.constBits()));
  texture_->getBuffer()->blitFromMemory(box);
  overlay_->show();
  context_->queueRender();
}

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::LabelDisplay, rviz::Display)
