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

#include "ros/topics.h"

namespace soft_robot_lab {

PullTool::PullTool() {
  shortcut_key_ = 'h';
  gain_ = new rviz::FloatProperty("Newtons per metre", 20.0f, "By how much the pull grows with the way of the mouse",
                                  getPropertyContainer());
  gain_->setMin(0.01f);
  gain_->setMax(10000.0f);
  topic_ = new rviz::StringProperty("Topic", topics::simulator_pull, "Where soft_robot_lab/SkinPull goes",
                                    getPropertyContainer());
  connect(topic_, &rviz::Property::changed, this, [this] { advertise(); });
}

PullTool::~PullTool() = default;

void PullTool::onInitialize() {
  setName("Pull");
  setDescription("Drag the skin with the left button: the robot is pulled while you hold it");
  arrow_ = std::make_unique<rviz::Arrow>(scene_manager_);
  arrow_->setColor(0.85f, 0.35f, 0.05f, 1.0f);
  arrow_->getSceneNode()->setVisible(false);
  advertise();
}

void PullTool::advertise() { pulls_ = node_.advertise<SkinPull>(topic_->getStdString(), 10); }

void PullTool::activate() { setStatus("Drag the skin with the left button: the farther, the harder it is pulled."); }
void PullTool::deactivate() { let_go(); }

void PullTool::update(float /*wall_dt*/, float /*ros_dt*/) {
  if (hold_m_ && force_n_ != Ogre::Vector3::ZERO) send(force_n_);
}

int PullTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.leftDown()) {
    take_hold(event);
  } else if (event.leftUp()) {
    let_go();
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
  frame_ = context_->getFixedFrame().toStdString();
}

// In the plane that faces the eye.
void PullTool::drag(rviz::ViewportMouseEvent& event) {
  Ogre::Plane plane(event.viewport->getCamera()->getDerivedDirection(), *hold_m_);
  Ogre::Vector3 mouse_m;
  if (!rviz::getPointOnPlaneFromWindowXY(event.viewport, plane, event.x, event.y, mouse_m)) return;
  const Ogre::Vector3 way_m = mouse_m - *hold_m_;
  force_n_ = gain_->getFloat() * way_m;
  arrow_->setPosition(*hold_m_);
  if (way_m.length() > 1e-6f) arrow_->setDirection(way_m);
  const float length_m = way_m.length(), width_m = 0.002f;
  arrow_->set(0.85f * length_m, width_m, 0.15f * length_m, 2.0f * width_m);
  arrow_->getSceneNode()->setVisible(length_m > 1e-6f);
  setStatus(QString("Pulls with %1 N").arg(static_cast<double>(force_n_.length()), 0, 'f', 2));
  send(force_n_);
}

void PullTool::let_go() {
  if (hold_m_) send(Ogre::Vector3::ZERO);
  hold_m_.reset();
  force_n_ = Ogre::Vector3::ZERO;
  arrow_->getSceneNode()->setVisible(false);
}

void PullTool::send(const Ogre::Vector3& force_n) {
  SkinPull pull;
  pull.header.stamp = ros::Time::now();
  pull.header.frame_id = frame_;
  pull.point.x = hold_m_->x;
  pull.point.y = hold_m_->y;
  pull.point.z = hold_m_->z;
  pull.force.x = force_n.x;
  pull.force.y = force_n.y;
  pull.force.z = force_n.z;
  pulls_.publish(pull);
}

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::PullTool, rviz::Tool)
