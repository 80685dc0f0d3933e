// SPDX-License-Identifier: BSD-3-Clause
#include "session_panel.h"

#include <algorithm>
#include <clocale>
#include <ctime>

#include <QCoreApplication>
#include <QDir>
#include <QEvent>
#include <QFileInfo>
#include <QVBoxLayout>
#include <pluginlib/class_list_macros.hpp>
#include <ros/package.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>

#include "framing.h"
#include "plain_text.h"
#include "ros/base/machine_time.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr int refresh_period_ms = 20;  // a slider that is drawn sends as often

// Whether the rviz file in a window's title, "NAME[*] - RViz", is one of this package that rviz was started with.
bool shows_own_view(const QString& title) {
  const QDir views(QString::fromStdString(ros::package::getPath("soft_robot_lab") + "/config/rviz"));
  const QStringList words = QCoreApplication::arguments();
  return std::any_of(words.begin(), words.end(), [&](const QString& word) {
    const QFileInfo file(word);
    return file.isFile() && file.dir().canonicalPath() == views.canonicalPath() && title.startsWith(file.fileName());
  });
}

}  // namespace

SessionPanel::SessionPanel(QWidget* parent) : rviz::Panel(parent) {
  std::setlocale(LC_NUMERIC, "C");  // Qt has taken the user's: files and messages have decimal points
  lamps_ = plain_label("", this);
  lamps_->setTextFormat(Qt::RichText);  // of lamp_text()
  lamps_->setWordWrap(true);
  QFont small = font();
  small.setPointSizeF(0.88 * small.pointSizeF());  // so that those of a session with contact stand in a line
  lamps_->setFont(small);
  chooser_ = new SceneChooser(panel_, this);
  actuators_ = new ActuatorList(panel_, this);
  target_ = new TargetBox(panel_, this);
  buttons_ = new ButtonBox(panel_, *target_, this);
  poses_ = new PoseBox(panel_, this);
  views_ = new ViewTabs(panel_, this);
  auto* column = new QVBoxLayout(this);
  column->setSpacing(4);
  column->addWidget(lamps_);
  column->addWidget(chooser_);
  column->addWidget(actuators_, 1);
  column->addWidget(target_);
  column->addWidget(buttons_);
  column->addWidget(poses_);
  column->addWidget(views_, 2);
  column->addWidget(panel_.status.make_label(this));
  connect(&timer_, &QTimer::timeout, this, [this] { refresh(); });
}

void SessionPanel::onInitialize() {
  if (!panel_.link) connect_to(session_);
  left_out_ = std::make_unique<LeftOutOfPicks>(
      *vis_manager_,
      std::vector<std::string>{topics::controller_ghost, topics::controller_preview, topics::controller_path,
                               topics::overlay, topics::panel_tips, topics::design_casting});
  window()->installEventFilter(this);
  timer_.start(refresh_period_ms);
}

void SessionPanel::connect_to(const QString& session) {
  session_ = session;
  panel_.link = std::make_unique<PanelLink>(session.toStdString());
  actuators_->begin_anew();
  target_->begin_anew();
}

void SessionPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString session;
  config.mapGetString("Session", &session);
  if (int steps = 0; config.mapGetInt("Workspace Steps", &steps)) views_->set_steps(std::clamp(steps, 2, 200));
  connect_to(session);
}

void SessionPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Session", session_);
  config.mapSetValue("Workspace Steps", views_->steps());
}

void SessionPanel::refresh() {
  if (!panel_.link) return;
  if (!ros::ok()) return end();
  watch_turns();
  panel_.link->listen();
  actuators_->refresh();
  chooser_->refresh();
  refresh_view();
  target_->refresh();
  views_->refresh(target_->marker(), refresh_period_ms);
  buttons_->refresh();
  poses_->refresh();
  refresh_lamps();
  for (const CallOutcome& outcome : panel_.link->take_outcomes()) report(outcome);
}

// The panel has moved the camera of a view that belongs to the package, so rviz shall not ask to save that.
bool SessionPanel::eventFilter(QObject* window, QEvent* event) {
  auto* whole = qobject_cast<QWidget*>(window);
  if (event->type() == QEvent::Close && whole && shows_own_view(whole->windowTitle())) whole->setWindowModified(false);
  return rviz::Panel::eventFilter(window, event);
}

// rviz would draw on into the window that it closes now, which Mesa's drawing by software seldom survives.
void SessionPanel::end() {
  vis_manager_->stopUpdate();
  timer_.stop();
}

void SessionPanel::watch_turns() {
  timespec work{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &work);
  const double now_s = machine_time_s();
  turns_.turn(now_s, static_cast<double>(work.tv_sec) + 1e-9 * static_cast<double>(work.tv_nsec));
  if (now_s < diagnosed_s_ + 1.0) return;
  diagnosed_s_ = now_s;
  panel_.link->diagnose(turns_.take());
}

// Once for each robot; then the camera is the user's.
void SessionPanel::refresh_view() {
  const SessionState& state = panel_.link->state();
  if (!state.robot_box() || framed_ == state.scene()) return;
  framed_ = state.scene();
  rviz::ViewController* view = vis_manager_->getViewManager()->getCurrent();
  if (!view || view->getClassId() != "rviz/Orbit") return;
  const auto angle = [&](const char* name) { return view->subProp(name)->getValue().toDouble(); };
  const QWidget* window = vis_manager_->getRenderPanel();
  const double aspect = static_cast<double>(std::max(window->width(), 1)) / std::max(window->height(), 1);
  const Framing framing = framing_of(state.robot_box()->box_m, {angle("Yaw"), angle("Pitch")}, aspect);
  view->subProp("Target Frame")->setValue(QString::fromStdString(state.robot_box()->frame));
  view->subProp("Distance")->setValue(framing.distance_m);
  for (int axis = 0; axis < 3; ++axis)
    view->subProp("Focal Point")->subProp(QString("XYZ"[axis]))->setValue(framing.focus_m[axis]);
}

void SessionPanel::refresh_lamps() {
  const std::vector<Lamp> lamps = panel_.link->lamps();
  QStringList texts;
  for (const Lamp& lamp : lamps) texts << lamp_text(lamp);
  const QString text = texts.join("&nbsp;&nbsp; ");
  if (text != lamps_->text()) lamps_->setText(text);
  lamps_->setToolTip(lamp_reasons(lamps));
}

void SessionPanel::report(const CallOutcome& outcome) {
  if (outcome.title.empty()) return;
  if (outcome.title == "Calibrate" && outcome.success) buttons_->show_calibrated();
  const QString text =
      QString::fromStdString(outcome.title + ": " + (outcome.message.empty() ? "done" : outcome.message));
  if (!outcome.success) return panel_.status.show_failure(text);
  panel_.status.show_success(text);
}

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::SessionPanel, rviz::Panel)
