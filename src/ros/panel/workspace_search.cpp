// SPDX-License-Identifier: BSD-3-Clause
#include "workspace_search.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <QCryptographicHash>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QStandardPaths>
#include <QThread>

namespace soft_robot_lab {

WorkspaceSearch::WorkspaceSearch(Handlers handlers) : handlers_(std::move(handlers)) {
  QObject::connect(&process_, &QProcess::readyReadStandardError, &process_, [this] { read_progress(); });
  QObject::connect(&process_, QOverload<int, QProcess::ExitStatus>::of(&QProcess::finished), &process_,
                   [this](int status) { finish(status); });
}

WorkspaceSearch::~WorkspaceSearch() {
  process_.disconnect();
  process_.terminate();
  if (process_.state() != QProcess::NotRunning && !process_.waitForFinished(2000)) process_.kill();
}

bool WorkspaceSearch::follow(const QString& scene, const QString& marker, int actuators) {
  actuators_ = actuators;
  if (scene == scene_ && marker == marker_) return false;
  scene_ = scene;
  marker_ = marker;
  outdated_ = process_.state() != QProcess::NotRunning;
  process_.terminate();
  return true;
}

void WorkspaceSearch::toggle() {
  if (process_.state() == QProcess::NotRunning) {
    start();
  } else {
    process_.terminate();
  }
}

// With less than all cores, and after the session where these are scarce.
void WorkspaceSearch::start() {
  const QByteArray key = QCryptographicHash::hash((scene_ + "\n" + marker_).toUtf8(), QCryptographicHash::Md5).toHex();
  folder_ =
      QStandardPaths::writableLocation(QStandardPaths::GenericCacheLocation) + "/soft_robot_lab/workspaces/" + key;
  if (!QDir().mkpath(folder_)) return handlers_.on_progress("Cannot write " + folder_);
  QStringList arguments = {"-n",   "10",       "rosrun", "soft_robot_lab", "workspace",
                           scene_, "--output", folder_,  "--marker",       marker_};
  arguments << "--threads" << QString::number(std::max(1, QThread::idealThreadCount() - 1));
  if (actuators_ > 2)
    arguments << "--samples" << QString::number(steps_ * steps_);
  else
    arguments << "--steps" << QString::number(steps_);
  log_.clear();
  handlers_.on_change(true);
  handlers_.on_progress("Begins ...");
  started_ = QDateTime::currentDateTime();
  process_.setStandardInputFile(QProcess::nullDevice());
  process_.start("nice", arguments);
}

void WorkspaceSearch::read_progress() {
  const QString text = QString::fromUtf8(process_.readAllStandardError()).trimmed();
  if (text.isEmpty() || outdated_) return;
  log_ = text.section('\n', -1);
  load_what_came();
  handlers_.on_progress(QString(log_).remove("workspace: "));
}

// What the program has written since it was started; what it found before that may be another robot's by now.
void WorkspaceSearch::load_what_came() {
  const QDateTime written = QFileInfo(folder_ + "/results.csv").lastModified();
  if (!written.isValid() || written < started_ || written == loaded_) return;
  loaded_ = written;
  try {
    load();
  } catch (const std::exception&) {  // nothing of this marker yet: the end says so
  }
}

void WorkspaceSearch::finish(int status) {
  handlers_.on_change(false);
  if (std::exchange(outdated_, false)) return;  // what it found is another robot's or marker's
  if (status > 1 || process_.exitStatus() == QProcess::CrashExit)
    return handlers_.on_progress(log_.isEmpty() ? "rosrun soft_robot_lab workspace failed" : log_);
  try {
    load();
  } catch (const std::exception& error) {
    handlers_.on_progress(error.what());
  }
}

void WorkspaceSearch::load() {
  QFile file(folder_ + "/results.csv");
  if (!file.open(QIODevice::ReadOnly)) throw std::runtime_error("cannot read " + file.fileName().toStdString());
  handlers_.on_tips(read_reachable_tips(file.readAll().toStdString(), marker_.toStdString()));
}

}  // namespace soft_robot_lab
