// SPDX-License-Identifier: BSD-3-Clause
#include "button_box.h"

#include "buttons.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

ButtonBox::ButtonBox(PanelContext& panel, TargetBox& target, QWidget* parent)
    : QWidget(parent), panel_(panel), target_(target) {
  const auto button = [this](const QString& text, const QString& hint, const std::function<void()>& press) {
    return make_button(text, hint, press, this);
  };
  optimise_ =
      button("&Optimise", "Finds the commands that bring the marker to the target", [this] { target_.optimise(); });
  execute_ = button("&Execute", "Plays what was found last", [this] { panel_.link->execute(); });
  stop_ = button("&Stop", "Ends searches and policies; the drives hold where they are. A rig's motors stop until Clear",
                 [this] { panel_.link->stop(); });
  reset_ =
      button("&Reset", "Back to the scene's start; a rig goes to its rest commands", [this] { panel_.link->reset(); });
  record_ = button("Recor&d", "Records the session into a bag, until it is pressed again",
                   [this] { panel_.link->record(!panel_.link->state().recording()); });
  record_->setCheckable(true);
  zero_ = button("&Zero", "The robot hangs at rest: here is zero for the motors", [this] { panel_.link->zero(); });
  clear_ = button("&Clear", "The motors may move again", [this] { panel_.link->clear(); });
  calibrate_ = button("C&alibrate", "Finds where the cameras stand: first without balls",
                      [this] { panel_.link->calibrate(with_balls_); });
  add_grid(new QGridLayout(this), {optimise_, execute_, stop_, reset_, record_, calibrate_, zero_, clear_}, 5);
}

void ButtonBox::refresh() {
  const PanelLink& link = *panel_.link;
  const QString no_search = QString::fromStdString(link.why_not(topics::optimise_policy));
  enable(optimise_, no_search.isEmpty() && !target_.has_markers() ? "the robot has no markers" : no_search);
  enable(execute_, QString::fromStdString(link.why_not(topics::execute_policy)));
  reset_->setEnabled(link.offers(topics::simulator_reset));
  record_->setVisible(link.offers(topics::session_record));
  record_->setChecked(link.state().recording());
  zero_->setVisible(link.offers(topics::motor_zero));
  clear_->setVisible(link.offers(topics::motor_clear));
  calibrate_->setVisible(link.offers(topics::calibrate));
  calibrate_->setEnabled(!link.busy());
}

void ButtonBox::show_calibrated() {
  with_balls_ = !with_balls_;
  calibrate_->setText(with_balls_ ? "C&al. balls" : "C&alibrate");
  calibrate_->setToolTip(with_balls_ ? "Second step: the balls are in their places" : "First step: without balls");
}

}  // namespace soft_robot_lab
