// SPDX-License-Identifier: BSD-3-Clause
#include "node_process.h"

#include <cstdint>

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

namespace soft_robot_lab {
namespace {

// Where its XML-RPC server listens.
bool look_up(const std::string& node, std::string& host, std::uint32_t& port) {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  return ros::master::execute("lookupNode", request, response, uri, false) &&
         ros::network::splitURI(static_cast<std::string&>(uri), host, port);
}

}  // namespace

std::optional<pid_t> answering_process(const std::string& node, double limit_s) {
  std::string host;
  std::uint32_t port = 0;
  if (!look_up(node, host, port)) return std::nullopt;
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcDispatch dispatch;
  if (!client.executeNonBlock("getPid", request)) return std::nullopt;
  dispatch.addSource(&client, XmlRpc::XmlRpcDispatch::WritableEvent | XmlRpc::XmlRpcDispatch::Exception);
  dispatch.work(limit_s);
  const bool answered = client.executeCheckDone(response);
  dispatch.removeSource(&client);
  if (!answered || client.isFault() || response.getType() != XmlRpc::XmlRpcValue::TypeArray || response.size() < 3)
    return std::nullopt;
  return static_cast<int>(response[2]);
}

}  // namespace soft_robot_lab
