// SPDX-License-Identifier: BSD-3-Clause
#include "pose_box.h"

#include <QDir>
#include <QFileDialog>
#include <QLineEdit>

#include "buttons.h"
#include "ros/base/topics.h"
#include "settings/write_file.h"
#include "soft_robot_lab/control/policy.h"

namespace soft_robot_lab {
namespace {

constexpr double pose_duration_s = 1.0;

std::string poses_file() {
  const QString ros_home = qEnvironmentVariable("ROS_HOME", QDir::homePath() + "/.ros");
  return (ros_home + "/soft_robot_lab/poses.txt").toStdString();
}

}  // namespace

PoseBox::PoseBox(PanelContext& panel, QWidget* parent) : QWidget(parent), panel_(panel), pose_(new QComboBox(this)) {
  pose_->setEditable(true);
  pose_->setInsertPolicy(QComboBox::NoInsert);
  pose_->lineEdit()->setPlaceholderText("pose");
  pose_->setToolTip("The name of a pose of this robot: one that is kept, or a new one to store");
  pose_->setMinimumContentsLength(6);
  pose_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  store_ = make_button(
      "S&tore", "Keeps the values above under that name, for this robot", [this] { store(); }, this);
  play_ = make_button(
      "Pla&y", "Moves the robot to that pose, within a second where its drives are as fast", [this] { play(); }, this);
  save_ = make_button(
      "Save ...", "Writes that pose into a policy file, for play_policy_node and simulate", [this] { save(); }, this);
  forget_ = make_button(
      "For&get", "Removes that pose", [this] { forget(); }, this);
  auto* grid = new QGridLayout(this);
  add_grid(grid, {pose_, store_, play_, save_, forget_}, 5);
  grid->setColumnStretch(0, 1);
}

void PoseBox::refresh() {
  const SessionState& state = panel_.link->state();
  const QString path = QString::fromStdString(state.scene());
  if (path != scene_) {
    scene_ = path;
    poses_.set_scene(state.scene());
    read();
  }
  const bool has_pose = pose_->count() > 0;
  const QString no_policy = QString::fromStdString(panel_.link->why_not(topics::execute_policy));
  enable(play_, no_policy.isEmpty() && !has_pose ? "no pose is kept for this robot" : no_policy);
  for (QPushButton* one : {forget_, save_}) one->setEnabled(has_pose);
  store_->setEnabled(!state.values().rows().empty());
}

void PoseBox::read() {
  try {
    poses_.read_file(poses_file());
  } catch (const std::exception& error) {
    panel_.status.show_failure(error.what());
  }
  show_names();
}

void PoseBox::show_names() {
  const QString before = pose_->currentText();
  pose_->clear();
  for (const std::string& name : poses_.names()) pose_->addItem(QString::fromStdString(name));
  if (const int index = pose_->findText(before); index >= 0) pose_->setCurrentIndex(index);
}

// In the user's folder, where another window may have written meanwhile.
bool PoseBox::change(const std::function<void()>& change) {
  try {
    poses_.read_file(poses_file());
    change();
    poses_.write_file(poses_file());
    show_names();
    return true;
  } catch (const std::exception& error) {
    panel_.status.show_failure(error.what());
    return false;
  }
}

void PoseBox::store() {
  std::string stored;
  const auto store = [&] {
    stored = poses_.store(pose_->currentText().trimmed().toStdString(), panel_.link->state().values().rows());
  };
  if (!change(store)) return;
  pose_->setCurrentText(QString::fromStdString(stored));
  panel_.status.show_success("Stored '" + QString::fromStdString(stored) + "'.");
}

void PoseBox::forget() {
  const std::string forgotten = name();
  if (change([&] { poses_.remove(forgotten); }))
    panel_.status.show_success("Forgot '" + QString::fromStdString(forgotten) + "'.");
}

void PoseBox::save() {
  try {
    const Policy pose = poses_.policy(name(), panel_.link->state().values().rows(), pose_duration_s);
    const QString path = QFileDialog::getSaveFileName(
        this, "Policy file", QDir::homePath() + "/" + pose_->currentText() + ".yaml", "YAML (*.yaml)");
    if (path.isEmpty()) return;
    write_file(path.toStdString(),
               policy_yaml({pose.names, {{pose.steps[0].time_s, pose.steps[0].values}}, pose.robot}));
    panel_.status.show_success("Written: " + path);
  } catch (const std::exception& error) {
    panel_.status.show_failure(error.what());
  }
}

void PoseBox::play() {
  try {
    panel_.link->play(poses_.policy(name(), panel_.link->state().values().rows(), pose_duration_s));
  } catch (const std::invalid_argument& error) {
    panel_.status.show_failure(error.what());
  }
}

}  // namespace soft_robot_lab
