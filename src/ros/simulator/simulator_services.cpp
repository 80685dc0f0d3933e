// SPDX-License-Identifier: BSD-3-Clause
#include "simulator_services.h"

#include <utility>

#include "ros/base/log_text.h"
#include "ros/base/topics.h"
#include "ros/messages/message_limits.h"

namespace soft_robot_lab {

SimulatorServices::~SimulatorServices() {
  changes_.stop();
  control_.stop();
}

void SimulatorServices::serve_control(Trigger reset, Trigger stop,
                                      std::function<void(NodeDiagnosis::Status&)> diagnose) {
  servers_.push_back(trigger(topics::simulator_reset, std::move(reset)));
  servers_.push_back(trigger(topics::simulator_stop, std::move(stop)));
  diagnosis_.add("simulation", std::move(diagnose));
  diagnosis_.start(&control_queue_);
  control_.start();
}

void SimulatorServices::serve_changes(Change<LoadScene> load, Change<UseSolver> use_solver) {
  servers_.push_back(change<LoadScene>(topics::simulator_load, std::move(load)));
  servers_.push_back(change<UseSolver>(topics::simulator_use_solver, std::move(use_solver)));
  changes_.start();
}

ros::ServiceServer SimulatorServices::trigger(const std::string& name, Trigger handler) {
  auto options = ros::AdvertiseServiceOptions::create<std_srvs::Trigger>(
      name,
      [handler = std::move(handler)](auto& /*request*/, auto& response) {
        handler(response);
        return true;
      },
      ros::VoidConstPtr(), &control_queue_);
  return node_.advertiseService(options);
}

template <typename Service>
ros::ServiceServer SimulatorServices::change(const std::string& name, Change<Service> handler) {
  auto options = ros::AdvertiseServiceOptions::create<Service>(
      name,
      [name, handler = std::move(handler)](auto& request, auto& response) {
        try {
          require_in_limits<typename Service::Request>(request);
          response.message = handler(request);
          response.success = true;
        } catch (const std::exception& error) {
          response.success = false;
          response.message = answer_text(error);
          ROS_WARN("%s refused: %s", name.c_str(), log_text(error.what()).c_str());
        }
        return true;
      },
      ros::VoidConstPtr(), &changes_queue_);
  return node_.advertiseService(options);
}

}  // namespace soft_robot_lab
