// SPDX-License-Identifier: BSD-3-Clause
#include "pull_tool.h"

#include <OgreCamera.h>
#include <OgrePlane.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <pluginlib/class_list_macros.hpp>
#include <rviz/display_context.h>
#include <rviz/geometry.h>
#include <rviz/ogre_helpers/arrow.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/render_panel.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/view_controller.h>
#include <rviz/viewport_mouse_event.h>
#include <soft_robot_lab/SkinPull.h>

#include "ros/base/topics.h"
#include "ros/view/skin_display.h"

namespace soft_robot_lab {

PullTool::PullTool() {
  shortcut_key_ = 'h';
  stiffness_n_m_ = new rviz::FloatProperty("Newtons per metre", 20.0f, "Of the spring from the skin to the mouse",
                                           getPropertyContainer());
  stiffness_n_m_->setMin(0.01f);
  stiffness_n_m_->setMax(1000.0f);
  topic_ = new rviz::StringProperty("Topic", topics::simulator_pull, "Where soft_robot_lab/SkinPull goes",
                                    getPropertyContainer());
  connect(topic_, &rviz::Property::changed, this, [this] { advertise(); });
}

PullTool::~PullTool() = default;

void PullTool::onInitialize() {
  setName("Pull");
  setDescription("Drag the skin with the left button: a spring pulls it to the mouse while you hold it");
  arrow_ = std::make_unique<rviz::Arrow>(scene_manager_);
  arrow_->setColor(0.85f, 0.35f, 0.05f, 1.0f);
  arrow_->getSceneNode()->setVisible(false);
  advertise();
}

void PullTool::advertise() { pulls_ = node_.advertise<SkinPull>(topic_->getStdString(), 10); }

void PullTool::activate() { say_what_to_do(); }
void PullTool::deactivate() { let_go(); }

void PullTool::say_what_to_do() { setStatus("Drag the skin with the left button: a spring pulls it to the mouse."); }

void PullTool::update(float /*wall_dt*/, float /*ros_dt*/) {
  if (!hold_m_ || !hand_m_) return;
  send(*hand_m_, stiffness_n_m_->getFloat());
  show();
}

int PullTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.leftDown()) {
    take_hold(event);
  } else if (event.leftUp()) {
    let_go();
    say_what_to_do();
  } else if (hold_m_ && event.left()) {
    drag(event);
  } else if (event.panel->getViewController()) {
    event.panel->getViewController()->handleMouseEvent(event);
  }
  return Render;
}

void PullTool::take_hold(rviz::ViewportMouseEvent& event) {
  Ogre::Vector3 point_m;
  if (!context_->getSelectionManager()->get3DPoint(event.viewport, event.x, event.y, point_m)) return;
  hold_m_ = point_m;
  hand_m_.reset();
  const SkinDisplay* skin = find_skin(*context_, topics::simulator_surface);
  if (skin && skin->skin().triangle_count() > 0) {
    const Ogre::Vector3 local_m = skin->getSceneNode()->convertWorldToLocalPosition(point_m);
    held_ = skin->skin().nearest({local_m.x, local_m.y, local_m.z});
  }
  frame_ = context_->getFixedFrame().toStdString();
}

// In the plane that faces the eye.
void PullTool::drag(rviz::ViewportMouseEvent& event) {
  Ogre::Plane plane(event.viewport->getCamera()->getDerivedDirection(), *hold_m_);
  Ogre::Vector3 mouse_m;
  if (!rviz::getPointOnPlaneFromWindowXY(event.viewport, plane, event.x, event.y, mouse_m)) return;
  hand_m_ = mouse_m;
  send(mouse_m, stiffness_n_m_->getFloat());
  show();
}

// Where the skin that was taken hold of is now; where it was, if its display is gone.
Ogre::Vector3 PullTool::held_m() const {
  const SkinDisplay* skin = find_skin(*context_, topics::simulator_surface);
  if (!skin || held_.triangle >= skin->skin().triangle_count()) return *hold_m_;
  const Eigen::Vector3f local_m = skin->skin().at(held_);
  return skin->getSceneNode()->convertLocalToWorldPosition({local_m.x(), local_m.y(), local_m.z()});
}

void PullTool::show() {
  const Ogre::Vector3 from_m = held_m(), way_m = *hand_m_ - from_m;
  const float length_m = way_m.length(), width_m = 0.002f;
  arrow_->setPosition(from_m);
  if (length_m > 1e-6f) arrow_->setDirection(way_m);
  arrow_->set(0.85f * length_m, width_m, 0.15f * length_m, 2.0f * width_m);
  arrow_->getSceneNode()->setVisible(length_m > 1e-6f);
  const float force_n = stiffness_n_m_->getFloat() * length_m;
  setStatus(QString("Pulls with %1 N: %2 N/m over %3 mm")
                .arg(static_cast<double>(force_n), 0, 'f', 2)
                .arg(static_cast<double>(stiffness_n_m_->getFloat()))
                .arg(1e3 * static_cast<double>(length_m), 0, 'f', 1));
}

void PullTool::let_go() {
  if (hold_m_) send(*hold_m_, 0.0f);
  hold_m_.reset();
  hand_m_.reset();
  arrow_->getSceneNode()->setVisible(false);
}

void PullTool::send(const Ogre::Vector3& hand_m, float stiffness_n_m) {
  SkinPull pull;
  pull.header.stamp = ros::Time::now();
  pull.header.frame_id = frame_;
  for (const auto& [place, from] : {std::pair(&pull.point, *hold_m_), std::pair(&pull.hand, hand_m)}) {
    place->x = from.x;
    place->y = from.y;
    place->z = from.z;
  }
  pull.stiffness_n_m = stiffness_n_m;
  pulls_.publish(pull);
}

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::PullTool, rviz::Tool)
