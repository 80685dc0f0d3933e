// SPDX-License-Identifier: BSD-3-Clause
// The fields of a message type, as its definition has them, to judge bytes by before they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace soft_robot_lab {

class MessageLayout {
 public:
  // `definition`: as ros::message_traits::definition gives it, with those of all types that it holds.
  MessageLayout(const std::string& type, const std::string& definition);

  // roscpp takes the memory of a list before it reads its items, however many are announced. Throws std::runtime_error
  // where a list or a text would go beyond the end of the bytes.
  void require_fits(const std::vector<std::uint8_t>& bytes) const;

 private:
  struct Field {
    std::string type, name;
    bool list = false;
    std::size_t count = 1;  // of a list of fixed length; 0: the length stands before it
  };
  class Walk;

  void add_type(const std::string& type, const std::string& lines);

  std::string type_;
  std::map<std::string, std::vector<Field>> fields_;  // by the type that has them
};

}  // namespace soft_robot_lab
