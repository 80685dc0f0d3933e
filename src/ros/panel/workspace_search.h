// SPDX-License-Identifier: BSD-3-Clause
// The program `workspace` beside the window: where a marker rests over all commands.
#pragma once

#include <functional>

#include <QDateTime>
#include <QProcess>
#include <QString>

#include "reachable_tips.h"

namespace soft_robot_lab {

class WorkspaceSearch {
 public:
  struct Handlers {
    std::function<void(bool runs)> on_change;
    std::function<void(const QString& text)> on_progress;  // and what went wrong
    std::function<void(ReachableTips tips)> on_tips;       // all so far
  };

  explicit WorkspaceSearch(Handlers handlers);
  ~WorkspaceSearch();  // the search ends, and keeps what it has

  // What a search would be about. False where that is the same as before; else what runs ends, and nothing holds that
  // it finds.
  bool follow(const QString& scene, const QString& marker, int actuators);
  bool possible() const { return !scene_.isEmpty() && !marker_.isEmpty() && actuators_ > 0; }
  void toggle();  // starts, or ends what runs

  void set_steps(int steps) { steps_ = steps; }  // of each command of robots with two actuators
  int steps() const { return steps_; }

 private:
  void start();
  void read_progress();
  void load_what_came();
  void finish(int status);
  void load();

  Handlers handlers_;
  QString scene_, marker_;
  int actuators_ = 0, steps_ = 21;
  QString folder_, log_;        // of the search; its last line
  QDateTime started_, loaded_;  // the search; when that was written which is shown
  bool outdated_ = false;       // what runs was asked for before another robot or marker came
  QProcess process_;
};

}  // namespace soft_robot_lab
