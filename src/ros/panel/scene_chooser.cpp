// SPDX-License-Identifier: BSD-3-Clause
#include "scene_chooser.h"

#include <QAbstractItemView>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <ros/package.h>

#include "robot_choices.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

// The robots that come with the package, and any file.
SceneChooser::SceneChooser(PanelContext& panel, QWidget* parent)
    : QWidget(parent),
      panel_(panel),
      scene_(new QComboBox(this)),
      solver_(new QComboBox(this)),
      training_(new QProgressBar(this)) {
  scene_->setToolTip("The robot that is simulated. Another is meshed beside the one that runs");
  for (const auto& [label, file] : robot_choices(ros::package::getPath("soft_robot_lab") + "/config/robots"))
    scene_->addItem(QString::fromStdString(label), QString::fromStdString(file));
  scene_->addItem("Another file ...");
  connect(scene_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) { choose_scene(index); });
  solver_->setToolTip("What moves the simulation, from where it is. A reduced model that is not kept is trained first");
  solver_->addItems({"newton", "xpbd", "reduced"});
  connect(solver_, QOverload<int>::of(&QComboBox::activated), this, [this] { choose_solver(); });
  training_->setRange(0, 100);
  training_->setVisible(false);
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->addWidget(scene_, 0, 0);
  grid->addWidget(solver_, 0, 1);
  grid->addWidget(training_, 1, 0, 1, 2);
  grid->setColumnStretch(0, 1);
}

void SceneChooser::choose_scene(int index) {
  const QString runs = QString::fromStdString(panel_.link->state().scene());
  QString path = scene_->itemData(index).toString();
  if (path.isEmpty())
    path = QFileDialog::getOpenFileName(this, "A robot's or scene's file", QFileInfo(runs).absolutePath(),
                                        "YAML (*.yaml)");
  if (path.isEmpty() || path == runs) return;
  panel_.status.show_success("Meshes " + QFileInfo(path).fileName() + " ...");
  panel_.link->load(path.toStdString());
}

void SceneChooser::choose_solver() {
  const QString name = solver_->currentText();
  if (name.toStdString() == panel_.link->state().solver()) return;
  panel_.status.show_success("Loads the scene for " + name + " ...");
  panel_.link->use_solver(name.toStdString());
}

void SceneChooser::refresh() {
  refresh_scene();
  refresh_solver();
  refresh_training();
}

void SceneChooser::refresh_scene() {
  const std::string& runs = panel_.link->state().scene();
  const QString path = QString::fromStdString(runs);
  scene_->setEnabled(!panel_.link->busy() && panel_.link->offers(topics::simulator_load));
  if (path.isEmpty() || path == scene_->currentData().toString() || scene_->view()->isVisible()) return;
  int index = scene_->findData(path);
  if (index < 0) {
    index = scene_->count() - 1;
    scene_->insertItem(index, QString::fromStdString(label_of(runs)), path);
  }
  if (!panel_.link->busy()) scene_->setCurrentIndex(index);
}

// What the session was asked for; the lamps say what moves the robot meanwhile.
void SceneChooser::refresh_solver() {
  const bool busy = panel_.link->busy();
  const int index = solver_->findText(QString::fromStdString(panel_.link->state().solver()));
  solver_->setVisible(index >= 0);
  solver_->setEnabled(!busy && panel_.link->offers(topics::simulator_use_solver));
  if (index >= 0 && !busy && !solver_->view()->isVisible()) solver_->setCurrentIndex(index);
}

void SceneChooser::refresh_training() {
  const auto training = panel_.link->training();
  training_->setVisible(training.has_value());
  if (!training) return;
  training_->setValue(static_cast<int>(100.0 * training->share + 0.5));
  training_->setFormat("trains a reduced model: %p %");
  training_->setToolTip(QString::fromStdString(training->text));
}

}  // namespace soft_robot_lab
