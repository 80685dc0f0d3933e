// SPDX-License-Identifier: BSD-3-Clause
// A socket whose other end answers lines of text with lines of text.
#pragma once

#include <string>

namespace soft_robot_lab {

class LineSocket {
 public:
  explicit LineSocket(int socket) : socket_(socket) {}  // takes it over
  ~LineSocket();
  LineSocket(const LineSocket&) = delete;
  LineSocket& operator=(const LineSocket&) = delete;

  // Throws std::runtime_error when the other end is gone, and std::invalid_argument for what is not one line of text:
  // it would be taken for several, and every answer after it for another's.
  std::string ask(const std::string& line);
  void close();

 private:
  std::string read_line();

  int socket_;
  std::string received_;
};

}  // namespace soft_robot_lab
