// SPDX-License-Identifier: BSD-3-Clause
#include "left_out_of_picks.h"

#include <algorithm>
#include <utility>

#include <OgreMaterialManager.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <rviz/display.h>
#include <rviz/display_group.h>

namespace soft_robot_lab {

LeftOutOfPicks::LeftOutOfPicks(rviz::DisplayContext& context, std::vector<std::string> topics)
    : context_(context), topics_(std::move(topics)) {
  context_.getSceneManager()->addListener(this);
}

LeftOutOfPicks::~LeftOutOfPicks() { context_.getSceneManager()->removeListener(this); }

bool LeftOutOfPicks::is_left_out(rviz::Display& display) const {
  if (!display.getClassId().startsWith("rviz/Marker") && display.getClassId() != "soft_robot_lab/Skin") return false;
  const std::string topic = display.subProp("Marker Topic")->getValue().toString().toStdString();
  return std::any_of(topics_.begin(), topics_.end(), [&](const std::string& end) {
    return topic == end || (topic.size() > end.size() &&
                            topic.compare(topic.size() - end.size() - 1, std::string::npos, "/" + end) == 0);
  });
}

void LeftOutOfPicks::preFindVisibleObjects(Ogre::SceneManager* /*scene*/,
                                           Ogre::SceneManager::IlluminationRenderStage /*stage*/,
                                           Ogre::Viewport* viewport) {
  if (viewport->getMaterialScheme() == Ogre::MaterialManager::DEFAULT_SCHEME_NAME) return;
  const rviz::DisplayGroup& displays = *context_.getRootDisplayGroup();
  for (int i = 0; i < displays.numDisplays(); ++i) {
    rviz::Display& display = *displays.getDisplayAt(i);
    Ogre::SceneNode* node = display.getSceneNode();
    Ogre::SceneNode* parent = node ? node->getParentSceneNode() : nullptr;
    if (!parent || !is_left_out(display)) continue;
    parent->removeChild(node);
    out_.emplace_back(node, parent);
  }
}

void LeftOutOfPicks::postFindVisibleObjects(Ogre::SceneManager* /*scene*/,
                                            Ogre::SceneManager::IlluminationRenderStage /*stage*/,
                                            Ogre::Viewport* /*viewport*/) {
  for (const auto& [node, parent] : out_) parent->addChild(node);
  out_.clear();
}

}  // namespace soft_robot_lab
