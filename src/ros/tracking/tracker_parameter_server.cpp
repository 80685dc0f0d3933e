// SPDX-License-Identifier: BSD-3-Clause
#include "tracker_parameter_server.h"

#include <utility>

#include "ros/tracking/tracker_parameters.h"

namespace soft_robot_lab {

TrackerParameterServer::TrackerParameterServer(const TrackerSettings& settings, Change change)
    : settings_(settings), change_(std::move(change)) {
  descriptions_ = node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = node_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  publish();
  server_ = node_.advertiseService("set_parameters", &TrackerParameterServer::answer, this);
}

void TrackerParameterServer::publish() const {
  descriptions_.publish(description_message(settings_));
  updates_.publish(config_message(settings_));
}

bool TrackerParameterServer::answer(dynamic_reconfigure::Reconfigure::Request& request,
                                    dynamic_reconfigure::Reconfigure::Response& response) {
  settings_ = with_request(settings_, request.config);
  change_(settings_);
  response.config = config_message(settings_);
  publish();
  return true;
}

}  // namespace soft_robot_lab
