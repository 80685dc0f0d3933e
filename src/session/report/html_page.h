// SPDX-License-Identifier: BSD-3-Clause
// One page that holds its pictures, so that it can be sent as one file.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "table.h"

namespace soft_robot_lab {

class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);  // of the window, and the heading

  void heading(const std::string& text, const std::string& anchor = "");  // of a section, to which links may lead
  void link(const std::string& text, const std::string& anchor);
  // `lead` in bold before it; a failure is shown as one.
  void paragraph(const std::string& text, const std::string& lead = "");
  void failure(const std::string& text);
  void table(const Table& table);
  // Side by side; .svg, .png or .jpg. Throws std::runtime_error where one cannot be read.
  void pictures(const std::vector<std::string>& files);
  // An MP4, and the picture that is shown until it is played. Throws as `pictures` does.
  void film(const std::string& file, const std::string& still);
  void text(const std::string& lines);  // as it stands

  std::string html() const;

 private:
  std::ostringstream body_;
};

}  // namespace soft_robot_lab
