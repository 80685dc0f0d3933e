// SPDX-License-Identifier: BSD-3-Clause
#include "message_layout.h"

#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

// Of what has one size; 0 for a text or a type of its own.
std::size_t size_of(const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"bool", 1},  {"int8", 1},   {"uint8", 1},   {"byte", 1},   {"char", 1},
      {"int16", 2}, {"uint16", 2}, {"int32", 4},   {"uint32", 4}, {"float32", 4},
      {"int64", 8}, {"uint64", 8}, {"float64", 8}, {"time", 8},   {"duration", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

// Types without a package are of the package that names them; Header is std_msgs'.
std::string full_name(const std::string& type, const std::string& within) {
  if (size_of(type) > 0 || type == "string" || type.find('/') != std::string::npos) return type;
  if (type == "Header") return "std_msgs/Header";
  return within.substr(0, within.find('/') + 1) + type;
}

}  // namespace

// Goes through a message's bytes.
class MessageLayout::Walk {
 public:
  Walk(const MessageLayout& layout, const std::vector<std::uint8_t>& bytes) : layout_(layout), bytes_(bytes) {}

  void message(const std::string& type) {
    for (const Field& field : layout_.fields_.at(type)) {
      const std::size_t count = field.list && field.count == 0 ? length(field.name) : field.count;
      if (const std::size_t size = size_of(field.type); size > 0) {
        skip(count, size, field.name);
        continue;
      }
      require(count, 1, field.name);
      for (std::size_t i = 0; i < count; ++i) field.type == "string" ? text(field.name) : message(field.type);
    }
  }

 private:
  void require(std::size_t count, std::size_t size, const std::string& name) const {
    if (count > (bytes_.size() - at_) / size)
      throw std::runtime_error(name + " announces " + std::to_string(count) + " items, more than there are bytes");
  }
  void skip(std::size_t count, std::size_t size, const std::string& name) {
    require(count, size, name);
    at_ += count * size;
  }
  std::size_t length(const std::string& name) {
    std::uint32_t length = 0;
    const std::size_t from = at_;
    skip(1, sizeof length, name);
    std::memcpy(&length, bytes_.data() + from, sizeof length);
    return length;
  }
  void text(const std::string& name) { skip(length(name), 1, name); }

  const MessageLayout& layout_;
  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
};

MessageLayout::MessageLayout(const std::string& type, const std::string& definition) : type_(type) {
  std::istringstream all(definition);
  std::string of = type, lines;
  for (std::string line; std::getline(all, line);) {
    if (line.compare(0, 5, "MSG: ") == 0) {
      add_type(of, lines);
      of = line.substr(5);
      lines.clear();
    } else if (line.compare(0, 4, "====") != 0) {
      lines += line + "\n";
    }
  }
  add_type(of, lines);
}

void MessageLayout::add_type(const std::string& type, const std::string& lines) {
  std::vector<Field>& fields = fields_[type];
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    Field field;
    const bool constant = line.find('=') < line.find('#');
    if (constant || !(words >> field.type >> field.name)) continue;
    if (const std::size_t bracket = field.type.find('['); bracket != std::string::npos) {
      field.list = true;
      field.count = static_cast<std::size_t>(std::strtoul(field.type.c_str() + bracket + 1, nullptr, 10));
      field.type.resize(bracket);
    }
    field.type = full_name(field.type, type);
    fields.push_back(field);
  }
}

void MessageLayout::require_fits(const std::vector<std::uint8_t>& bytes) const { Walk(*this, bytes).message(type_); }

}  // namespace soft_robot_lab
