// SPDX-License-Identifier: BSD-3-Clause
#include "settings/command_line.h"

#include <functional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace soft_robot_lab {
namespace {

// What a program of this name says, and how it ends, where its work throws.
std::string said(const std::function<void()>& work) {
  CommandLine line("Does nothing.", "nothing");
  std::string name = "nothing";
  char* arguments[] = {name.data(), nullptr};
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program(line, 1, arguments,
                        [&] {
                          work();
                          return kGood;
                        }),
            kFailed);
  return testing::internal::GetCapturedStderr();
}

TEST(CommandLine, SaysWhatALibraryThrewInOurWords) {
  using Json = nlohmann::json;
  EXPECT_EQ(said([] { throw std::runtime_error("a.yaml: wrong [1] is not 2"); }),
            "nothing: a.yaml: wrong [1] is not 2\n");
  const std::string not_json = said([] { Json parsed = Json::parse("{1"); });
  EXPECT_EQ(not_json.find("nothing: not the JSON that is expected: parse error at line 1, column 2"), 0u) << not_json;
  const std::string missing = said([] { Json().at("markers"); });
  EXPECT_EQ(missing.find("nothing: not the JSON that is expected: cannot use at()"), 0u) << missing;
  const std::string text = said([] { Json("\xff").dump(); });
  EXPECT_EQ(text.find("nothing: a text is not UTF-8: invalid UTF-8 byte at index 0: 0xFF"), 0u) << text;
  const std::string of_file = said([] {
    try {
      Json parsed = Json::parse("x");
    } catch (const Json::exception& error) {
      throw std::runtime_error(std::string("runs.json: ") + error.what());
    }
  });
  EXPECT_EQ(of_file.find("nothing: runs.json: not the JSON that is expected: parse error"), 0u) << of_file;
}

}  // namespace
}  // namespace soft_robot_lab
