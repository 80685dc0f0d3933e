// SPDX-License-Identifier: BSD-3-Clause
#include "session_panel.h"

#include <algorithm>
#include <clocale>
#include <ctime>

#include <QAbstractItemView>
#include <QCoreApplication>
#include <QDir>
#include <QEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <QGroupBox>
#include <QLineEdit>
#include <QSignalBlocker>
#include <pluginlib/class_list_macros.hpp>
#include <ros/package.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>

#include "framing.h"
#include "plain_text.h"
#include "robot_choices.h"
#include "ros/base/topics.h"
#include "settings/write_file.h"
#include "soft_robot_lab/control/policy.h"

namespace soft_robot_lab {
namespace {

constexpr double pose_duration_s = 1.0;
constexpr int refresh_period_ms = 20;  // a slider that is drawn sends as often
constexpr int rows_at_once = 3;        // of actuators

std::string poses_file() {
  const QString ros_home = qEnvironmentVariable("ROS_HOME", QDir::homePath() + "/.ros");
  return (ros_home + "/soft_robot_lab/poses.txt").toStdString();
}

void add_grid(QGridLayout* grid, const std::vector<QWidget*>& widgets, int columns) {
  for (int i = 0; i < static_cast<int>(widgets.size()); ++i)
    grid->addWidget(widgets[static_cast<std::size_t>(i)], i / columns, i % columns);
  grid->setContentsMargins(0, 0, 0, 0);
}

// Where it is not, its hint says why, in the window's status bar too.
void enable(QPushButton* button, const QString& why_not) {
  if (!button->property("hint").isValid()) button->setProperty("hint", button->toolTip());
  const QString hint = button->property("hint").toString() + (why_not.isEmpty() ? "" : ".\nNot now: " + why_not);
  button->setEnabled(why_not.isEmpty());
  if (hint == button->toolTip()) return;
  button->setToolTip(hint);
  button->setStatusTip(why_not.isEmpty() ? "" : "Not now: " + why_not);
}

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
  auto* column = new QVBoxLayout(this);
  column->setSpacing(4);
  lamps_ = plain_label("", this);
  lamps_->setTextFormat(Qt::RichText);  // of lamp_text()
  lamps_->setWordWrap(true);
  QFont small = font();
  small.setPointSizeF(0.88 * small.pointSizeF());  // so that those of a session with contact stand in a line
  lamps_->setFont(small);
  message_ = plain_label("Waits for a session.", this);
  message_->setWordWrap(true);
  message_->setMinimumHeight(3 * message_->fontMetrics().lineSpacing());
  message_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  column->addWidget(lamps_);
  column->addWidget(make_chooser());
  column->addWidget(make_actuators(), 1);
  column->addWidget(make_target());
  column->addWidget(make_buttons());
  column->addWidget(make_poses());
  column->addWidget(make_views(), 2);
  column->addWidget(message_);
  connect(&timer_, &QTimer::timeout, this, [this] { refresh(); });
}

QPushButton* SessionPanel::button(const QString& text, const QString& hint, const std::function<void()>& press) {
  auto* made = new QPushButton(text, this);
  made->setToolTip(hint);
  made->setMinimumWidth(made->fontMetrics().horizontalAdvance(text) + 16);  // narrower than the style's own
  connect(made, &QPushButton::clicked, this, press);
  return made;
}

// The robots that come with the package, and any file.
QWidget* SessionPanel::make_chooser() {
  scene_ = new QComboBox(this);
  scene_->setToolTip("The robot that is simulated. Another is meshed beside the one that runs");
  for (const auto& [label, file] : robot_choices(ros::package::getPath("soft_robot_lab") + "/config/robots"))
    scene_->addItem(QString::fromStdString(label), QString::fromStdString(file));
  scene_->addItem("Another file ...");
  connect(scene_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) { choose_scene(index); });
  solver_ = new QComboBox(this);
  solver_->setToolTip("What moves the simulation, from where it is. A reduced model that is not kept is trained first");
  solver_->addItems({"newton", "xpbd", "reduced"});
  connect(solver_, QOverload<int>::of(&QComboBox::activated), this, [this] {
    const QString name = solver_->currentText();
    if (name.toStdString() == link_->solver()) return;
    report_success("Loads the scene for " + name + " ...");
    link_->use_solver(name.toStdString());
  });
  training_ = new QProgressBar(this);
  training_->setRange(0, 100);
  training_->setVisible(false);
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->addWidget(scene_, 0, 0);
  grid->addWidget(solver_, 0, 1);
  grid->addWidget(training_, 1, 0, 1, 2);
  grid->setColumnStretch(0, 1);
  return box;
}

QWidget* SessionPanel::make_actuators() {
  area_ = new QScrollArea(this);
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  area_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* inside = new QWidget(area_);
  rows_ = new QVBoxLayout(inside);
  rows_->setContentsMargins(0, 0, 4, 0);
  empty_ = plain_label("No actuators yet.", inside);
  rows_->addWidget(empty_);
  rows_->addStretch(1);
  area_->setWidget(inside);
  return area_;
}

QWidget* SessionPanel::make_target() {
  auto* box = new QGroupBox("Target [mm, robot_base]", this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(4, 2, 4, 2);
  marker_ = new QComboBox(box);
  marker_->setToolTip("The marker that shall reach the target");
  method_ = new QComboBox(box);
  method_->addItems({"gauss_newton", "rmsprop", "pid", "pid_projected", "cma_es", "differential_evolution"});
  method_->setMinimumContentsLength(8);
  method_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  grid->addWidget(marker_, 0, 0);
  grid->addWidget(method_, 0, 1, 1, 2);
  for (int axis = 0; axis < 3; ++axis) {
    target_mm_[axis] = new NumberBox(box);
    target_mm_[axis]->setDecimals(1);
    target_mm_[axis]->setRange(-9999.0, 9999.0);
    target_mm_[axis]->setPrefix(QString("xyz"[axis]) + " ");
    target_mm_[axis]->setMinimumWidth(0);
    connect(target_mm_[axis], qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this] { show_target(); });
    grid->addWidget(target_mm_[axis], 1, axis);
  }
  connect(marker_, QOverload<int>::of(&QComboBox::activated), this, [this] {
    shown_targets_ = link_->targets();
    write_target();
    show_target();
  });
  return box;
}

QWidget* SessionPanel::make_buttons() {
  auto* box = new QWidget(this);
  optimise_ = button("&Optimise", "Finds the commands that bring the marker to the target", [this] { optimise(); });
  execute_ = button("&Execute", "Plays what was found last", [this] { link_->execute(); });
  stop_ = button("&Stop", "Ends searches and policies; the drives hold where they are. A rig's motors stop until Clear",
                 [this] { link_->stop(); });
  reset_ = button("&Reset", "Back to the scene's start; a rig goes to its rest commands", [this] { link_->reset(); });
  record_ = button("Recor&d", "Records the session into a bag, until it is pressed again",
                   [this] { link_->record(!link_->recording()); });
  record_->setCheckable(true);
  zero_ = button("&Zero", "The robot hangs at rest: here is zero for the motors", [this] { link_->zero(); });
  clear_ = button("&Clear", "The motors may move again", [this] { link_->clear(); });
  calibrate_ = button("C&alibrate", "Finds where the cameras stand: first without balls", [this] { calibrate(); });
  add_grid(new QGridLayout(box), {optimise_, execute_, stop_, reset_, record_, calibrate_, zero_, clear_}, 5);
  return box;
}

QWidget* SessionPanel::make_poses() {
  auto* box = new QWidget(this);
  pose_ = new QComboBox(box);
  pose_->setEditable(true);
  pose_->setInsertPolicy(QComboBox::NoInsert);
  pose_->lineEdit()->setPlaceholderText("pose");
  pose_->setToolTip("The name of a pose of this robot: one that is kept, or a new one to store");
  store_ = button("S&tore", "Keeps the values above under that name, for this robot", [this] { store_pose(); });
  play_ = button("Pla&y", "Moves the robot to that pose, within a second where its drives are as fast",
                 [this] { play_pose(); });
  save_ = button("Save ...", "Writes that pose into a policy file, for play_policy_node and simulate",
                 [this] { save_pose(); });
  forget_ = button("For&get", "Removes that pose", [this] { forget_pose(); });
  pose_->setMinimumContentsLength(6);
  pose_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  auto* grid = new QGridLayout(box);
  add_grid(grid, {pose_, store_, play_, save_, forget_}, 5);
  grid->setColumnStretch(0, 1);
  return box;
}

QWidget* SessionPanel::make_views() {
  auto* tabs = new QTabWidget(this);
  plot_ = new PlotView(tabs);
  workspace_ = new WorkspaceView(
      [this](const ReachableTips& tips, const TipQuantity& coloured_by) {
        if (link_) link_->show_tips(tips, coloured_by);
      },
      [this](const ReachableTip& tip) { reach(tip); }, tabs);
  tabs->addTab(plot_, "P&lot");
  tabs->addTab(workspace_, "&Workspace");
  QWidget* title = plot_->title();
  tabs->setCornerWidget(title);
  connect(tabs, &QTabWidget::currentChanged, title, [=] { title->setVisible(tabs->currentWidget() == plot_); });
  return tabs;
}

void SessionPanel::onInitialize() {
  if (!link_) connect_to(session_);
  left_out_ = std::make_unique<LeftOutOfPicks>(
      *vis_manager_, std::vector<std::string>{topics::controller_ghost, topics::controller_preview, topics::overlay,
                                              topics::panel_tips, topics::design_casting});
  window()->installEventFilter(this);
  timer_.start(refresh_period_ms);
}

void SessionPanel::connect_to(const QString& session) {
  session_ = session;
  link_ = std::make_unique<PanelLink>(session.toStdString());
  shown_revision_ = shown_targets_ = -1;
}

void SessionPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString session;
  config.mapGetString("Session", &session);
  if (int steps = 0; config.mapGetInt("Workspace Steps", &steps)) workspace_->set_steps(std::clamp(steps, 2, 200));
  connect_to(session);
}

void SessionPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Session", session_);
  config.mapSetValue("Workspace Steps", workspace_->steps());
}

void SessionPanel::refresh() {
  if (!link_) return;
  if (!ros::ok()) return end();
  watch_turns();
  link_->listen();
  refresh_rows();
  refresh_scene();
  refresh_solver();
  refresh_view();
  refresh_target();
  refresh_plot();
  refresh_workspace();
  refresh_buttons();
  refresh_lamps();
  for (const CallOutcome& outcome : link_->take_outcomes()) report(outcome);
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
  const double now_s = PanelLink::now_s();
  turns_.turn(now_s, static_cast<double>(work.tv_sec) + 1e-9 * static_cast<double>(work.tv_nsec));
  if (now_s < diagnosed_s_ + 1.0) return;
  diagnosed_s_ = now_s;
  link_->diagnose(turns_.take());
}

void SessionPanel::refresh_rows() {
  const ActuatorValues& values = link_->values();
  if (values.revision() != shown_revision_) {
    for (ActuatorEditor* editor : editors_) editor->deleteLater();
    editors_.clear();
    for (const ActuatorRow& row : values.rows()) {
      const auto edit = [this, name = row.name](double value) {
        link_->values().edit(name, value, PanelLink::now_s());
      };
      editors_.push_back(new ActuatorEditor(row, static_cast<int>(editors_.size()) + 1, edit, this));
      rows_->insertWidget(rows_->count() - 1, editors_.back());
    }
    empty_->setVisible(editors_.empty());
    show_whole_rows();
    shown_revision_ = values.revision();
    if (!editors_.empty()) report_success("Move a slider, or type a number.");
  }
  for (std::size_t i = 0; i < editors_.size(); ++i) editors_[i]->show_row(values.rows()[i]);
}

// No row is cut where there is no need to scroll, nor the last one that fits.
void SessionPanel::show_whole_rows() {
  if (editors_.empty()) return;
  const int rows = std::min(rows_at_once, static_cast<int>(editors_.size()));
  const int row_px = editors_.front()->sizeHint().height() + rows_->spacing();
  area_->setMinimumHeight(rows * row_px);
  area_->setMaximumHeight(static_cast<int>(editors_.size()) * row_px + rows_->spacing());
}

// Follows what runs.
void SessionPanel::refresh_scene() {
  const QString path = QString::fromStdString(link_->scene());
  if (path != posed_) {
    posed_ = path;
    wanted_.reset();
    poses_.set_scene(link_->scene());
    read_poses();
  }
  if (path.isEmpty() || path == scene_->currentData().toString() || scene_->view()->isVisible()) return;
  int index = scene_->findData(path);
  if (index < 0) {
    index = scene_->count() - 1;
    scene_->insertItem(index, QString::fromStdString(label_of(link_->scene())), path);
  }
  if (!link_->busy()) scene_->setCurrentIndex(index);
}

// Follows what the session was asked for; the lamps say what moves the robot meanwhile.
void SessionPanel::refresh_solver() {
  const int index = solver_->findText(QString::fromStdString(link_->solver()));
  solver_->setVisible(index >= 0);
  solver_->setEnabled(!link_->busy() && link_->offers(topics::simulator_use_solver));
  if (index >= 0 && !link_->busy() && !solver_->view()->isVisible()) solver_->setCurrentIndex(index);
  const auto training = link_->training();
  training_->setVisible(training.has_value());
  if (!training) return;
  training_->setValue(static_cast<int>(100.0 * training->share + 0.5));
  training_->setFormat("trains a reduced model: %p %");
  training_->setToolTip(QString::fromStdString(training->text));
}

// Once for each robot; then the camera is the user's.
void SessionPanel::refresh_view() {
  if (!link_->robot_box() || framed_ == link_->scene()) return;
  framed_ = link_->scene();
  rviz::ViewController* view = vis_manager_->getViewManager()->getCurrent();
  if (!view || view->getClassId() != "rviz/Orbit") return;
  const auto angle = [&](const char* name) { return view->subProp(name)->getValue().toDouble(); };
  const QWidget* window = vis_manager_->getRenderPanel();
  const double aspect = static_cast<double>(std::max(window->width(), 1)) / std::max(window->height(), 1);
  const Framing framing = framing_of(*link_->robot_box(), {angle("Yaw"), angle("Pitch")}, aspect);
  view->subProp("Target Frame")->setValue(QString::fromStdString(link_->robot_frame()));
  view->subProp("Distance")->setValue(framing.distance_m);
  for (int axis = 0; axis < 3; ++axis)
    view->subProp("Focal Point")->subProp(QString("XYZ"[axis]))->setValue(framing.focus_m[axis]);
}

// Ten times a second is enough for an eye.
void SessionPanel::refresh_plot() {
  link_->plot(marker_->currentText().toStdString());
  if (++undrawn_ * refresh_period_ms < 100) return;
  undrawn_ = 0;
  plot_->show_history(link_->history());
}

// Of tips that are chosen fast one after the other the last counts.
void SessionPanel::refresh_workspace() {
  workspace_->follow(QString::fromStdString(link_->scene()), marker_->currentText(),
                     static_cast<int>(link_->values().rows().size()));
  if (!wanted_ || link_->busy()) return;
  link_->optimise("gauss_newton", marker_->currentText().toStdString(), *wanted_);
  wanted_.reset();
}

// Follows what is searched for, and of which marker; a number that is being typed stays, unless another robot came.
void SessionPanel::refresh_target() {
  QStringList names;
  for (const std::string& name : link_->markers()) names << QString::fromStdString(name);
  QStringList shown;
  for (int i = 0; i < marker_->count(); ++i) shown << marker_->itemText(i);
  if (names != shown) {
    marker_->clear();
    marker_->addItems(names);
    const int tip = names.indexOf("tip");  // else the last, as the controller's ball
    marker_->setCurrentIndex(tip >= 0 ? tip : names.size() - 1);
    shown_targets_ = -1;
  }
  if (shown_targets_ == link_->targets() || names.isEmpty()) return;
  shown_targets_ = link_->targets();
  if (const int asked = names.indexOf(QString::fromStdString(link_->target_marker())); asked >= 0)
    marker_->setCurrentIndex(asked);
  write_target();
}

void SessionPanel::write_target() {
  const auto target = link_->target(marker_->currentText().toStdString());
  if (!target) return;
  const bool another_robot = target_of_ != link_->robots();
  target_of_ = link_->robots();
  const double position_m[3] = {target->x, target->y, target->z};
  for (int axis = 0; axis < 3; ++axis) {
    const QSignalBlocker quiet(target_mm_[axis]);
    if (another_robot || !target_mm_[axis]->hasFocus()) target_mm_[axis]->setValue(1e3 * position_m[axis]);
  }
}

Eigen::Vector3d SessionPanel::target_m() const {
  return 1e-3 * Eigen::Vector3d(target_mm_[0]->value(), target_mm_[1]->value(), target_mm_[2]->value());
}

// What is chosen here is what stands in the scene.
void SessionPanel::show_target() {
  if (link_ && marker_->count() > 0) link_->show_target(marker_->currentText().toStdString(), target_m());
}

void SessionPanel::refresh_buttons() {
  const bool free = !link_->busy();
  const bool has_pose = pose_->count() > 0;
  const QString no_search = QString::fromStdString(link_->why_not(topics::optimise_policy));
  const QString no_policy = QString::fromStdString(link_->why_not(topics::execute_policy));
  enable(optimise_, no_search.isEmpty() && marker_->count() == 0 ? "the robot has no markers" : no_search);
  enable(execute_, no_policy);
  enable(play_, no_policy.isEmpty() && !has_pose ? "no pose is kept for this robot" : no_policy);
  for (QPushButton* one : {forget_, save_}) one->setEnabled(has_pose);
  scene_->setEnabled(free && link_->offers(topics::simulator_load));
  store_->setEnabled(!editors_.empty());
  reset_->setEnabled(link_->offers(topics::simulator_reset));
  record_->setVisible(link_->offers(topics::session_record));
  record_->setChecked(link_->recording());
  zero_->setVisible(link_->offers(topics::motor_zero));
  clear_->setVisible(link_->offers(topics::motor_clear));
  calibrate_->setVisible(link_->offers(topics::calibrate));
  calibrate_->setEnabled(free);
}

void SessionPanel::refresh_lamps() {
  const std::vector<Lamp> lamps = link_->lamps();
  QStringList texts;
  for (const Lamp& lamp : lamps) texts << lamp_text(lamp);
  const QString text = texts.join("&nbsp;&nbsp; ");
  if (text != lamps_->text()) lamps_->setText(text);
  lamps_->setToolTip(lamp_reasons(lamps));
}

void SessionPanel::read_poses() {
  try {
    poses_.read_file(poses_file());
  } catch (const std::exception& error) {
    report_failure(error.what());
  }
  refresh_poses();
}

void SessionPanel::refresh_poses() {
  const QString before = pose_->currentText();
  pose_->clear();
  for (const std::string& name : poses_.names()) pose_->addItem(QString::fromStdString(name));
  if (const int index = pose_->findText(before); index >= 0) pose_->setCurrentIndex(index);
}

void SessionPanel::report(const CallOutcome& outcome) {
  if (outcome.title.empty()) return;
  if (outcome.title == "Calibrate" && outcome.success) {
    with_balls_ = !with_balls_;
    calibrate_->setText(with_balls_ ? "C&al. balls" : "C&alibrate");
    calibrate_->setToolTip(with_balls_ ? "Second step: the balls are in their places" : "First step: without balls");
  }
  const QString text =
      QString::fromStdString(outcome.title + ": " + (outcome.message.empty() ? "done" : outcome.message));
  if (!outcome.success) return report_failure(text);
  report_success(text);
}

void SessionPanel::report_success(const QString& text) {
  message_->setStyleSheet("");
  message_->setText(text);
}

void SessionPanel::report_failure(const QString& text) {
  message_->setStyleSheet("color: #c62828");
  message_->setText(text);
}

void SessionPanel::optimise() {
  link_->optimise(method_->currentText().toStdString(), marker_->currentText().toStdString(), target_m());
  report_success("Searches ...");
}

void SessionPanel::store_pose() {
  std::string name;
  const auto store = [&] { name = poses_.store(pose_->currentText().trimmed().toStdString(), link_->values().rows()); };
  if (!change_poses(store)) return;
  pose_->setCurrentText(QString::fromStdString(name));
  report_success("Stored '" + QString::fromStdString(name) + "'.");
}

void SessionPanel::forget_pose() {
  const std::string name = pose_->currentText().toStdString();
  if (change_poses([&] { poses_.remove(name); })) report_success("Forgot '" + QString::fromStdString(name) + "'.");
}

// In the user's folder, where another window may have written meanwhile.
bool SessionPanel::change_poses(const std::function<void()>& change) {
  try {
    poses_.read_file(poses_file());
    change();
    poses_.write_file(poses_file());
    refresh_poses();
    return true;
  } catch (const std::exception& error) {
    report_failure(error.what());
    return false;
  }
}

void SessionPanel::choose_scene(int index) {
  QString path = scene_->itemData(index).toString();
  const QString folder = QFileInfo(QString::fromStdString(link_->scene())).absolutePath();
  if (path.isEmpty()) path = QFileDialog::getOpenFileName(this, "A robot's or scene's file", folder, "YAML (*.yaml)");
  if (path.isEmpty() || path == QString::fromStdString(link_->scene())) return;
  report_success("Meshes " + QFileInfo(path).fileName() + " ...");
  link_->load(path.toStdString());
}

void SessionPanel::save_pose() {
  try {
    const Policy pose = poses_.policy(pose_->currentText().toStdString(), link_->values().rows(), pose_duration_s);
    const QString path = QFileDialog::getSaveFileName(
        this, "Policy file", QDir::homePath() + "/" + pose_->currentText() + ".yaml", "YAML (*.yaml)");
    if (path.isEmpty()) return;
    write_file(path.toStdString(),
               policy_yaml({pose.names, {{pose.steps[0].time_s, pose.steps[0].values}}, pose.robot}));
    report_success("Written: " + path);
  } catch (const std::exception& error) {
    report_failure(error.what());
  }
}

void SessionPanel::play_pose() {
  try {
    link_->play(poses_.policy(pose_->currentText().toStdString(), link_->values().rows(), pose_duration_s));
  } catch (const std::invalid_argument& error) {
    report_failure(error.what());
  }
}

void SessionPanel::reach(const ReachableTip& tip) { wanted_ = tip.position_m; }

void SessionPanel::calibrate() { link_->calibrate(with_balls_); }

}  // namespace soft_robot_lab

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::SessionPanel, rviz::Panel)
