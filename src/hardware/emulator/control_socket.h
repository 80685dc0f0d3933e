// SPDX-License-Identifier: BSD-3-Clause
// A Unix socket that takes lines of text and answers each with one.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace soft_robot_lab {

class ControlSocket {
 public:
  explicit ControlSocket(const std::string& path);  // throws std::runtime_error
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  // Serves whoever is there, without waiting.
  void serve(const std::function<std::string(const std::string&)>& answer);

 private:
  void accept_all();
  bool serve(int client, std::string& text, const std::function<std::string(const std::string&)>& answer);

  std::string path_;
  int listener_ = -1;
  std::map<int, std::string> clients_;  // what each has sent of a line so far
};

}  // namespace soft_robot_lab
