// SPDX-License-Identifier: BSD-3-Clause
// What is drawn over a robot is seen, but never lies between the mouse and what stands behind it: the ghost would keep
// the hand from the target inside it, and the tool Pull from the skin.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <OgreSceneManager.h>
#include <rviz/display_context.h>

namespace soft_robot_lab {

// Takes displays out of the scene while rviz draws what the mouse points at, or how far away that is.
class LeftOutOfPicks : public Ogre::SceneManager::Listener {
 public:
  // Those that show topics with these ends: as of "left/overlay" in a namespace.
  LeftOutOfPicks(rviz::DisplayContext& context, std::vector<std::string> topics);
  ~LeftOutOfPicks() override;
  LeftOutOfPicks(const LeftOutOfPicks&) = delete;
  LeftOutOfPicks& operator=(const LeftOutOfPicks&) = delete;

  void preFindVisibleObjects(Ogre::SceneManager* scene, Ogre::SceneManager::IlluminationRenderStage stage,
                             Ogre::Viewport* viewport) override;
  void postFindVisibleObjects(Ogre::SceneManager* scene, Ogre::SceneManager::IlluminationRenderStage stage,
                              Ogre::Viewport* viewport) override;

 private:
  bool is_left_out(rviz::Display& display) const;

  rviz::DisplayContext& context_;
  std::vector<std::string> topics_;
  std::vector<std::pair<Ogre::SceneNode*, Ogre::SceneNode*>> out_;  // nodes now, and their parents
};

}  // namespace soft_robot_lab
