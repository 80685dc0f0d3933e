// SPDX-License-Identifier: BSD-3-Clause
#include "plain_stl.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>

#include "settings/limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kHeader = 80, kStart = kHeader + 4, kFacet = 50, kCorners = 9;  // bytes; floats of a facet

[[noreturn]] void fail(const std::string& why) { throw std::invalid_argument("is no STL file: " + printable(why)); }

void require_few(std::size_t triangles) {
  if (triangles == 0) throw std::invalid_argument("holds no triangles");
  if (triangles > limits::kTriangles)
    throw std::invalid_argument("holds " + std::to_string(triangles) + " triangles, at most " +
                                std::to_string(limits::kTriangles) + " are read; make its mesh coarser");
}

// Of a file's unit, which a scale of [0.001, 1000] makes metres. Gmsh computes without end, or ends by a signal,
// beyond.
constexpr double kLargest = limits::kFilePlace, kSmallestBody = 1e-9;

// Of all corners, along the axes.
class Extent {
 public:
  // `where` is the line or facet.
  void add(std::size_t axis, double value, const std::string& where) {
    if (!std::isfinite(value)) fail(where + " has a corner that is no finite number");
    if (!(std::abs(value) <= kLargest))
      throw std::invalid_argument(where + ": " + format_number(value) + " is out of range [" +
                                  format_number(-kLargest) + ", " + format_number(kLargest) + "]");
    min_[axis] = std::min(min_[axis], value);
    max_[axis] = std::max(max_[axis], value);
  }

  void require_a_body() const {
    double longest = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, max_[axis] - min_[axis]);
    if (longest < kSmallestBody)
      throw std::invalid_argument("its body is " + format_number(longest) + " large, out of range [" +
                                  format_number(kSmallestBody) + ", " + format_number(2 * kLargest) + "]");
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<double, 3> min_{kNone, kNone, kNone}, max_{-kNone, -kNone, -kNone};
};

// Least byte first.
std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

std::size_t announced(const std::string& bytes) { return word_at(bytes, kHeader); }

bool has_announced_size(const std::string& bytes) {
  return bytes.size() >= kStart && bytes.size() == kStart + kFacet * announced(bytes);
}

std::string plain_binary(const std::string& bytes) {
  if (bytes.size() < kStart) fail("it has " + std::to_string(bytes.size()) + " bytes, a binary one at least 84");
  const std::size_t triangles = announced(bytes), held = (bytes.size() - kStart) / kFacet;
  if (triangles > held)
    fail("it announces " + std::to_string(triangles) + " triangles, and has bytes for " + std::to_string(held));
  require_few(triangles);
  Extent extent;
  for (std::size_t facet = 0; facet < triangles; ++facet) {
    for (std::size_t i = 3; i < 3 + kCorners; ++i) {  // after its normal
      const std::uint32_t word = word_at(bytes, kStart + kFacet * facet + 4 * i);
      float value;
      std::memcpy(&value, &word, sizeof value);
      extent.add(i % 3, value, "facet " + std::to_string(facet));
    }
  }
  extent.require_a_body();
  return std::string(kHeader, '\0') + bytes.substr(kHeader, 4 + kFacet * triangles);
}

// Words of text, which know their lines.
class StlText {
 public:
  explicit StlText(const std::string& bytes) : bytes_(bytes) {}

  std::string word() {
    while (at_ < bytes_.size() && is_blank(bytes_[at_])) line_ += bytes_[at_++] == '\n' ? 1 : 0;
    const std::size_t start = at_;
    while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
    std::string found = bytes_.substr(start, at_ - start);
    for (char& c : found) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return found;
  }

  void expect(const std::string& words) {
    for (std::size_t start = 0; start < words.size();) {
      const std::size_t end = std::min(words.find(' ', start), words.size());
      const std::string wanted = words.substr(start, end - start), found = word();
      if (found != wanted) fail_here("'" + found.substr(0, 40) + "' stands where '" + wanted + "' is expected");
      start = end + 1;
    }
  }

  // Three numbers, with a blank before each.
  std::string corner(Extent& extent) {
    std::string text;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string found = word();
      const std::optional<double> value = parse_number<double>(found);
      if (!value || !std::isfinite(*value)) fail_here("'" + found.substr(0, 40) + "' is not a finite number");
      extent.add(axis, *value, "line " + std::to_string(line_));
      text += " " + found;
    }
    return text;
  }

  void skip_words(int count) {
    for (int i = 0; i < count; ++i) word();
  }

  void skip_line() { at_ = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size()); }

  [[noreturn]] void fail_here(const std::string& why) const { fail("line " + std::to_string(line_) + ": " + why); }

 private:
  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  const std::string& bytes_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// After the word "facet".
void copy_facet(StlText& text, Extent& extent, std::string& to) {
  text.expect("normal");
  text.skip_words(3);  // whatever they are: normals follow from the corners
  to += "facet normal 0 0 0\nouter loop\n";
  text.expect("outer loop");
  for (int corner = 0; corner < 3; ++corner) {
    text.expect("vertex");
    to += "vertex" + text.corner(extent) + "\n";
  }
  text.expect("endloop endfacet");
  to += "endloop\nendfacet\n";
}

std::string plain_text(const std::string& bytes) {
  StlText text(bytes);
  std::string plain = "solid body\n";
  std::size_t triangles = 0;
  Extent extent;
  for (std::string word = text.word(); !word.empty(); word = text.word()) {
    if (word == "facet") {
      copy_facet(text, extent, plain);
      ++triangles;
    } else if (word == "solid" || word == "endsolid") {
      if (word == "solid" && triangles > 0) plain += "endsolid body\nsolid body\n";
      text.skip_line();  // its name
    } else {
      text.fail_here("'" + word.substr(0, 40) + "' stands where 'facet' is expected");
    }
  }
  require_few(triangles);
  extent.require_a_body();
  return plain + "endsolid body\n";
}

// Binary files may start so too; the highest byte of their count is 0, as no byte of a text is.
bool is_text(const std::string& bytes) {
  return StlText(bytes).word() == "solid" && (bytes.size() < kStart || bytes[kStart - 1] != '\0');
}

}  // namespace

std::string plain_stl(const std::string& bytes) {
  return has_announced_size(bytes) || !is_text(bytes) ? plain_binary(bytes) : plain_text(bytes);
}

}  // namespace soft_robot_lab
