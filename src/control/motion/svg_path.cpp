// SPDX-License-Identifier: BSD-3-Clause
#include "svg_path.h"

#include <cctype>
#include <cmath>
#include <stdexcept>

#include "settings/limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr int kCurvePieces = 40;

class SvgReader {
 public:
  explicit SvgReader(const std::string& d) : text_(d) {}

  std::vector<Eigen::Vector2d> read() {
    int pieces = 0;
    for (skip_gap(); at_ < text_.size(); skip_gap()) {
      if (std::isalpha(static_cast<unsigned char>(text_[at_]))) {
        command_ = text_[at_++];
      } else if (command_ == 0 || command_ == 'Z' || command_ == 'z') {
        fail("a number without a command");
      }
      if (++pieces > limits::kSplinePoints) fail("more than " + std::to_string(limits::kSplinePoints) + " pieces");
      take();
    }
    return points_;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument("character " + std::to_string(at_ + 1) + ": " + why);
  }

  void skip_gap() {
    while (at_ < text_.size() && (std::isspace(static_cast<unsigned char>(text_[at_])) || text_[at_] == ',')) ++at_;
  }

  double number() {
    skip_gap();
    const std::size_t from = at_;
    if (is_one_of("+-")) ++at_;
    const std::size_t digits_from = at_;
    skip_digits();
    if (is_one_of(".")) ++at_;
    skip_digits();
    if (at_ > digits_from && is_one_of("eE")) {
      ++at_;
      if (is_one_of("+-")) ++at_;
      skip_digits();
    }
    const auto value = parse_number<double>(text_.substr(from, at_ - from));
    if (!value || !(std::abs(*value) <= limits::kNumber))
      fail(std::string("command ") + command_ + " needs a number here");
    return *value;
  }

  bool is_one_of(const std::string& characters) const {
    return at_ < text_.size() && characters.find(text_[at_]) != std::string::npos;
  }

  void skip_digits() {
    while (is_one_of("0123456789")) ++at_;
  }

  Eigen::Vector2d place() {
    const double x = number();
    return origin() + Eigen::Vector2d(x, number());
  }

  // Of the present command's numbers.
  Eigen::Vector2d origin() const { return relative() ? pen_ : Eigen::Vector2d::Zero(); }
  bool relative() const { return std::islower(static_cast<unsigned char>(command_)) != 0; }

  void take() {
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command_)));
    if (points_.empty() != (kind == 'M'))
      fail(points_.empty() ? "it must begin with M" : "a second M; a marker cannot be lifted");
    switch (kind) {
      case 'M':
        begin();
        break;
      case 'L':
        line_to(place());
        break;
      case 'H':
        line_to({origin().x() + number(), pen_.y()});
        break;
      case 'V':
        line_to({pen_.x(), origin().y() + number()});
        break;
      case 'C':
        smooth_cubic(place());
        break;
      case 'S':
        smooth_cubic(before_ == 'C' || before_ == 'S' ? Eigen::Vector2d(2.0 * pen_ - control_) : pen_);
        break;
      case 'Q':
        quadratic(place());
        break;
      case 'T':
        quadratic(before_ == 'Q' || before_ == 'T' ? Eigen::Vector2d(2.0 * pen_ - control_) : pen_);
        break;
      case 'Z':
        line_to(points_.front());
        break;
      case 'A':
        fail("arcs are not read; make curves of them");
      default:
        fail(std::string("'") + command_ + "' is no command");
    }
    before_ = kind;
  }

  // Further pairs of numbers are lines.
  void begin() {
    pen_ = place();
    points_ = {pen_};
    command_ = relative() ? 'l' : 'L';
  }

  void line_to(const Eigen::Vector2d& to) {
    pen_ = to;
    points_.push_back(pen_);
  }

  void smooth_cubic(const Eigen::Vector2d& first) {
    const Eigen::Vector2d second = place(), to = place();
    control_ = second;
    cubic(first, second, to);
  }

  void quadratic(const Eigen::Vector2d& control) {
    const Eigen::Vector2d to = place();
    control_ = control;
    cubic(pen_ + 2.0 / 3.0 * (control - pen_), to + 2.0 / 3.0 * (control - to), to);
  }

  void cubic(const Eigen::Vector2d& first, const Eigen::Vector2d& second, const Eigen::Vector2d& to) {
    const Eigen::Vector2d from = pen_;
    for (int piece = 1; piece <= kCurvePieces; ++piece) {
      const double t = static_cast<double>(piece) / kCurvePieces, s = 1.0 - t;
      line_to(s * s * s * from + 3.0 * s * s * t * first + 3.0 * s * t * t * second + t * t * t * to);
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
  char command_ = 0, before_ = 0;
  Eigen::Vector2d pen_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d control_ = Eigen::Vector2d::Zero();  // the last of the curve before
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace

std::vector<Eigen::Vector2d> svg_points(const std::string& d) { return SvgReader(d).read(); }

}  // namespace soft_robot_lab
