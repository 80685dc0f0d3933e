// SPDX-License-Identifier: BSD-3-Clause
#include "plain_obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "plain_stl.h"
#include "settings/limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

// Statements without a say in where triangles are.
const std::vector<std::string> kPassedOver{
    "vt", "vn",     "vp",    "o",        "g",        "s",   "mg",         "usemtl",    "mtllib", "l",
    "p",  "usemap", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "maplib"};

class ObjText {
 public:
  std::string as_stl(const std::string& bytes) {
    std::istringstream text(bytes);
    stl_ = "solid body\n";
    for (std::string line, more; std::getline(text, line);) {
      ++line_;
      strip(line);
      while (!line.empty() && line.back() == '\\' && std::getline(text, more)) {
        ++line_;
        strip(more);
        line.back() = ' ';
        line += more;
      }
      read(line);
    }
    return stl_ + "endsolid body\n";
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument("is no OBJ file: line " + std::to_string(line_) + ": " + printable(why));
  }

  static void strip(std::string& line) {
    line.erase(std::min(line.find('#'), line.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
  }

  static std::string digits(double value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
  }

  void read(const std::string& line) {
    std::istringstream words(line);
    std::string kind;
    if (!(words >> kind)) return;
    if (kind == "v") return read_vertex(words);
    if (kind == "f") return read_face(words);
    if (std::find(kPassedOver.begin(), kPassedOver.end(), kind) == kPassedOver.end())
      fail("'" + kind.substr(0, 40) + "' stands where v or f is expected");
  }

  void read_vertex(std::istringstream& words) {
    std::string corner;
    for (int axis = 0; axis < 3; ++axis) {
      std::string word;
      words >> word;
      const std::optional<double> value = parse_number<double>(word);
      if (!value || !std::isfinite(*value)) fail("'" + word.substr(0, 40) + "' is not a finite number");
      if (std::abs(*value) > limits::kFilePlace)
        fail(format_number(*value) + " is out of range [" + format_number(-limits::kFilePlace) + ", " +
             format_number(limits::kFilePlace) + "]");
      corner += " " + digits(*value);  // a word of any length may stand for a number, and a face repeats it
    }
    vertices_.push_back(corner);
  }

  // By its number from 1 on, or from the last one back.
  const std::string& vertex(const std::string& word) const {
    const std::optional<long> number = parse_number<long>(word.substr(0, word.find('/')));
    const auto count = static_cast<long>(vertices_.size());
    if (!number || *number == 0 || *number > count || *number < -count)
      fail("'" + word.substr(0, 40) + "' is none of the " + std::to_string(count) + " vertices so far");
    return vertices_[static_cast<std::size_t>(*number > 0 ? *number - 1 : count + *number)];
  }

  void read_face(std::istringstream& words) {
    std::vector<const std::string*> corners;
    for (std::string word; words >> word;) corners.push_back(&vertex(word));
    if (corners.size() < 3) fail("a face has " + std::to_string(corners.size()) + " corners, must have 3 or more");
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (++triangles_ > limits::kTriangles)
        throw std::invalid_argument("holds more than " + std::to_string(limits::kTriangles) +
                                    " triangles; make its mesh coarser");
      stl_ += "facet normal 0 0 0\nouter loop\nvertex" + *corners[0] + "\nvertex" + *corners[i - 1] + "\nvertex" +
              *corners[i] + "\nendloop\nendfacet\n";
    }
  }

  int line_ = 0;
  std::size_t triangles_ = 0;
  std::vector<std::string> vertices_;
  std::string stl_;
};

}  // namespace

std::string plain_obj(const std::string& bytes) { return plain_stl(ObjText().as_stl(bytes)); }

}  // namespace soft_robot_lab
