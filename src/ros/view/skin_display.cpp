// SPDX-License-Identifier: BSD-3-Clause
#include "skin_display.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <OgreCamera.h>
#include <OgreManualObject.h>
#include <OgreResourceGroupManager.h>
#include <OgreMaterialManager.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <pluginlib/class_list_macros.hpp>
#include <rviz/display_context.h>
#include <rviz/display_group.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/ros_topic_property.h>
#include <rviz/validate_floats.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>

#include "hear_topic.h"

namespace soft_robot_lab {
namespace {

constexpr float kDensest = 0.92f;    // opacity of a translucent skin where it turns away from the eye
constexpr float kRimShade = 0.22f;   // by which an opaque skin is darker there
constexpr float kEdgeShade = 0.30f;  // of the skin's colour
constexpr float kEdgeOpacity = 0.55f;
constexpr float kLift = 0.998f;  // of the way to the eye: edges lie before the skin that they belong to

Eigen::Vector3f eigen(const Ogre::Vector3& v) { return {v.x, v.y, v.z}; }
Ogre::Vector3 ogre(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

Ogre::MaterialPtr unlit_material(const Ogre::String& name) {
  Ogre::MaterialPtr material =
      Ogre::MaterialManager::getSingleton().create(name, Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  material->setReceiveShadows(false);
  material->setLightingEnabled(false);
  material->setCullingMode(Ogre::CULL_NONE);
  return material;
}

void set_translucent(const Ogre::MaterialPtr& material, bool translucent) {
  material->setSceneBlending(translucent ? Ogre::SBT_TRANSPARENT_ALPHA : Ogre::SBT_REPLACE);
  material->setDepthWriteEnabled(!translucent);
}

void begin(Ogre::ManualObject& object, const Ogre::MaterialPtr& material, Ogre::RenderOperation::OperationType type,
           std::size_t corners) {
  object.estimateVertexCount(corners);
  if (object.getBoundingBox().isNull()) {  // for the first time
    object.begin(material->getName(), type, material->getGroup());
  } else {
    object.beginUpdate(0);
  }
}

}  // namespace

SkinDisplay::SkinDisplay() {
  topic_ = new rviz::RosTopicProperty(
      "Marker Topic", "", QString::fromStdString(ros::message_traits::datatype<visualization_msgs::Marker>()),
      "visualization_msgs/Marker of triangles", this);
  connect(topic_, &rviz::Property::changed, this, [this] { subscribe(); });
  edges_shown_ = new rviz::BoolProperty("Edges", true, "Draws creases, and where the skin turns away", this);
  connect(edges_shown_, &rviz::Property::changed, this, [this] { changed_ = true; });
}

SkinDisplay::~SkinDisplay() {
  if (!initialized()) return;
  scene_manager_->destroyManualObject(triangles_);
  scene_manager_->destroyManualObject(edges_);
  for (const Ogre::MaterialPtr& material : {material_, edge_material_})
    Ogre::MaterialManager::getSingleton().remove(material->getHandle());
}

void SkinDisplay::onInitialize() {
  static int count = 0;
  const Ogre::String name = "soft_robot_lab_skin_" + std::to_string(count++);
  material_ = unlit_material(name);
  edge_material_ = unlit_material(name + "_edges");
  set_translucent(edge_material_, true);
  triangles_ = scene_manager_->createManualObject(name);
  edges_ = scene_manager_->createManualObject(name + "_edges");
  for (Ogre::ManualObject* object : {triangles_, edges_}) {
    object->setDynamic(true);
    scene_node_->attachObject(object);
  }
  clear();
}

void SkinDisplay::onEnable() { subscribe(); }

void SkinDisplay::onDisable() {
  subscriber_.shutdown();
  clear();
}

void SkinDisplay::reset() {
  Display::reset();
  clear();
  subscribe();  // what is latched comes again
}

void SkinDisplay::setTopic(const QString& topic, const QString& /*datatype*/) { topic_->setString(topic); }

std::string SkinDisplay::topic() const { return topic_->getTopicStd(); }

const SkinDisplay* find_skin(rviz::DisplayContext& context, const std::string& topic) {
  const rviz::DisplayGroup& displays = *context.getRootDisplayGroup();
  for (int i = 0; i < displays.numDisplays(); ++i) {
    const auto* skin = dynamic_cast<SkinDisplay*>(displays.getDisplayAt(i));
    if (skin && QString::fromStdString("/" + skin->topic()).endsWith(QString::fromStdString("/" + topic))) return skin;
  }
  return nullptr;
}

void SkinDisplay::subscribe() {
  subscriber_.shutdown();  // or what is latched would not come again
  subscriber_ = hear_topic<visualization_msgs::Marker>(*this, update_nh_, topic(), [this](const auto& m) { take(m); });
}

void SkinDisplay::take(const visualization_msgs::Marker& marker) {
  using Marker = visualization_msgs::Marker;
  if (marker.action != Marker::ADD) return clear();
  const bool whole = marker.type == Marker::TRIANGLE_LIST && marker.points.size() % 3 == 0 &&
                     (marker.colors.empty() || marker.colors.size() == marker.points.size());
  if (!whole || !rviz::validateFloats(marker.points) || !rviz::validateFloats(marker.colors)) {
    clear();
    return setStatus(rviz::StatusProperty::Error, "Message",
                     "Not whole triangles of finite corners, each with a colour");
  }
  setStatus(rviz::StatusProperty::Ok, "Message", "OK");
  show(marker);
}

void SkinDisplay::show(const visualization_msgs::Marker& marker) {
  std::vector<Eigen::Vector3f> corners_m;
  for (const geometry_msgs::Point& point : marker.points)
    corners_m.push_back(
        Eigen::Vector3d(point.x * marker.scale.x, point.y * marker.scale.y, point.z * marker.scale.z).cast<float>());
  const auto colour = [](const std_msgs::ColorRGBA& c) { return Ogre::ColourValue(c.r, c.g, c.b, c.a); };
  colours_.assign(corners_m.size(), colour(marker.color));
  std::transform(marker.colors.begin(), marker.colors.end(), colours_.begin(), colour);
  skin_.set_corners(std::move(corners_m));
  header_ = marker.header;
  pose_ = marker.pose;
  translucent_ = marker.color.a < 0.9998f;
  set_translucent(material_, translucent_);
  changed_ = true;
}

void SkinDisplay::clear() {
  skin_.set_corners({});
  colours_.clear();
  for (Ogre::ManualObject* object : {triangles_, edges_}) object->setVisible(false);
}

void SkinDisplay::update(float /*wall_dt*/, float /*ros_dt*/) {
  if (skin_.triangle_count() == 0) return;
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  if (!context_->getFrameManager()->transform(header_.frame_id, ros::Time(), pose_, position, orientation)) {
    const QString frame = QString::fromStdString(header_.frame_id);
    setStatus(rviz::StatusProperty::Error, "Frame", "No transform from " + frame + " to " + fixed_frame_);
    return;
  }
  deleteStatus("Frame");
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  const rviz::ViewController* view = context_->getViewManager()->getCurrent();
  if (!view) return;
  const Ogre::Vector3 eye = orientation.Inverse() * (view->getCamera()->getDerivedPosition() - position);
  if (!changed_ && eye.positionEquals(drawn_from_, 1e-6f)) return;
  draw(eye);
}

void SkinDisplay::draw(const Ogre::Vector3& eye) {
  changed_ = false;
  drawn_from_ = eye;
  draw_triangles(eigen(eye));
  draw_edges(eigen(eye));
  context_->queueRender();
}

Ogre::ColourValue SkinDisplay::seen_colour(int corner, const Eigen::Vector3f& eye_m) const {
  Ogre::ColourValue colour = colours_[static_cast<std::size_t>(corner)];
  const float away = std::pow(1.0f - skin_.facing(corner, eye_m), 3.0f);
  if (translucent_) {
    colour.a += away * std::max(0.0f, kDensest - colour.a);
  } else {
    const float alpha = colour.a;
    colour *= 1.0f - kRimShade * away;
    colour.a = alpha;
  }
  return colour;
}

// An opaque skin is drawn whole: its depths are its order.
void SkinDisplay::draw_triangles(const Eigen::Vector3f& eye_m) {
  std::vector<int> order(static_cast<std::size_t>(skin_.triangle_count()));
  std::iota(order.begin(), order.end(), 0);
  if (translucent_) order = skin_.sorted_from(eye_m);
  triangles_->setVisible(!order.empty());
  if (order.empty()) return;
  begin(*triangles_, material_, Ogre::RenderOperation::OT_TRIANGLE_LIST, 3 * order.size());
  for (const int triangle : order)
    for (int corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
      triangles_->position(ogre(skin_.corners_m()[static_cast<std::size_t>(corner)]));
      triangles_->colour(seen_colour(corner, eye_m));
    }
  triangles_->end();
}

void SkinDisplay::draw_edges(const Eigen::Vector3f& eye_m) {
  std::vector<int> ends;
  if (edges_shown_->getBool())
    for (const SeenSkin::Edge& edge : skin_.edges())
      if (skin_.is_drawn(edge, eye_m)) ends.insert(ends.end(), {edge.from, edge.to});
  edges_->setVisible(!ends.empty());
  if (ends.empty()) return;
  begin(*edges_, edge_material_, Ogre::RenderOperation::OT_LINE_LIST, ends.size());
  for (const int corner : ends) {
    const Ogre::ColourValue& skin = colours_[static_cast<std::size_t>(corner)];
    edges_->position(ogre(eye_m + kLift * (skin_.corners_m()[static_cast<std::size_t>(corner)] - eye_m)));
    edges_->colour(kEdgeShade * skin.r, kEdgeShade * skin.g, kEdgeShade * skin.b, kEdgeOpacity * std::sqrt(skin.a));
  }
  edges_->end();
}

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::SkinDisplay, rviz::Display)
