// SPDX-License-Identifier: BSD-3-Clause
#include "settings/command_line.h"
#include "settings/kept_files.h"
#include "settings/named_file.h"
#include "settings/write_file.h"
#include "settings/written_options.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

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

TEST(CommandLine, SaysNothingThatSteersATerminal) {
  EXPECT_EQ(said([] { throw std::runtime_error("a.yaml: '\x1b[2J\r\x7f' is no ü\n\tin line 1"); }),
            "nothing: a.yaml: '?[2J?"
            "?' is no ü\n\tin line 1\n");
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

// What a program says of one argument for `--hold S --place X Y Z --price P --count N --range NAME MIN MAX`.
std::string said_of(const std::vector<std::string>& words) {
  CommandLine line("Does nothing.", "nothing");
  double hold_s = 0.0, price = 0.0;
  int count = 0;
  std::vector<std::tuple<std::string, double, double>> ranges;
  std::vector<double> place_m;
  line.add_option("--hold", hold_s).type_name("S").show_default();
  line.add_option("--price", price).type_name("P");
  line.add_option("--count", count).type_name("N");
  line.add_option("--range", ranges).type_name("NAME MIN MAX");
  const std::function<void(const std::vector<double>&)> take = [&](const std::vector<double>& at) { place_m = at; };
  line.add_option_function("--place", take, "where").type_name("X Y Z").expected(3);
  std::vector<std::string> all = {"nothing"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  testing::internal::CaptureStderr();
  line.read(static_cast<int>(arguments.size()), arguments.data());
  const std::string errors = testing::internal::GetCapturedStderr();
  return errors.substr(0, errors.find('\n'));
}

TEST(CommandLine, TakesNumbersWithinTheLimitsOfTheirUnits) {
  EXPECT_EQ(said_of({"--hold", "1e6", "--price", "-1e12", "--count", "1000000", "--place", "1", "2", "-1000"}), "");
  EXPECT_EQ(said_of({"--range", "left", "0", "1", "--range", "right", "-1e12", "1"}), "");
  EXPECT_EQ(said_of({"--hold", "1.1e6"}), "nothing: --hold: 1.1e6 is not in [-1000000, 1000000] s");
  EXPECT_EQ(said_of({"--hold", "nan"}), "nothing: --hold: nan is not in [-1000000, 1000000] s");
  EXPECT_EQ(said_of({"--place", "0", "1e300", "0"}), "nothing: --place: 1e300 is not in [-1000, 1000] m");
  EXPECT_EQ(said_of({"--price", "-inf"}), "nothing: --price: -inf is not in [-1e+12, 1e+12]");
  EXPECT_EQ(said_of({"--count", "1000001"}), "nothing: --count: 1000001 is not in [-1000000, 1000000]");
  EXPECT_EQ(said_of({"--range", "left", "0", "1e13"}), "nothing: --range: 1e13 is not in [-1e+12, 1e+12]");
}

// As where the shell does not know a variable: nothing is no zero. Nor does a number get round its limit.
TEST(CommandLine, TakesNoWordForANumberThatIsNone) {
  for (const std::string word : {"", "1 m", "0x1p2000", " 1e300", "1e", "''", "1,5"}) {
    EXPECT_EQ(said_of({"--hold", word}), "nothing: --hold: '" + word + "' is no number");
    EXPECT_EQ(said_of({"--place", "0", word, "0"}), "nothing: --place: '" + word + "' is no number");
    EXPECT_EQ(said_of({"--count", word}), "nothing: --count: '" + word + "' is no whole number");
  }
  for (const std::string word : {"0x1p2000", " 1e300"})
    EXPECT_EQ(said_of({"--range", "left", "0", word}), "nothing: --range: '" + word + "' is no number");
  EXPECT_EQ(said_of({"--range", "left", "0", "right"}), "nothing: --range: 'left,0,right' is not what it takes");
  EXPECT_EQ(said_of({"--range", "left", "0", "1", "--range", "left", "0", "2"}),
            "nothing: --range: 'left' is named twice");
  for (const std::string word : {"1e3", "0.5"})
    EXPECT_EQ(said_of({"--count", word}), "nothing: --count: '" + word + "' is no whole number");
  EXPECT_EQ(said_of({"--count", "99999999999999999999"}),
            "nothing: --count: 99999999999999999999 is not in [-1000000, 1000000]");
}

TEST(CommandLine, NamesAMistypedOptionBeforeWhatIsMissing) {
  CommandLine line("Does nothing.", "nothing");
  std::string scene, result;
  line.add_option("SCENE", scene).required();
  line.add_group("files", "", 0, 1).add_option("--result", result);
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "nothing");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStderr();
    EXPECT_EQ(line.read(static_cast<int>(arguments.size()), arguments.data()), kFailed);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(said({"--hepl"}).find("nothing: unknown option --hepl\n"), 0u);
  EXPECT_EQ(said({"--resul=a.json"}).find("nothing: unknown option --resul\n"), 0u);
  EXPECT_EQ(said({"--result", "a.json"}).find("nothing: SCENE is required\n"), 0u);
}

TEST(CommandLine, WritesOverNoFileThatIsNamedBeside) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("command_line_test." + std::to_string(getpid()));
  fs::create_directories(folder / "below");
  const std::string scene = folder / "scene.yaml", link = folder / "link.yaml", other = folder / "below/../new.json";
  std::ofstream(scene) << "body:\n";
  fs::create_symlink(scene, link);
  const auto said_of_files = [](std::vector<std::string> words) {
    CommandLine line("Does nothing.", "nothing");
    std::string read, result, output;
    line.add_option("SCENE", read).required();
    line.add_option("--result", result);
    line.add_group("files", "", 0, 2).add_option("--output", output);
    words.insert(words.begin(), "nothing");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStderr();
    const int status = line.read(static_cast<int>(arguments.size()), arguments.data()).value_or(kGood);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(status, said.empty() ? kGood : kFailed);
    return said;
  };
  for (const std::string& result :
       {scene, link, (folder / "./scene.yaml").string(), (folder / "none/../scene.yaml").string()})
    EXPECT_NE(said_of_files({scene, "--result", result})
                  .find("nothing: --result: " + result + " would be written over SCENE; give it a file of its own"),
              std::string::npos)
        << said_of_files({scene, "--result", result});
  EXPECT_NE(said_of_files({scene, "--result", folder / "new.json", "--output", other}).find("would be written over"),
            std::string::npos)
      << "of two that are not there yet";
  EXPECT_EQ(said_of_files({scene, "--result", folder / "new.json", "--output", folder / "new.npz"}), "");
  EXPECT_EQ(said_of_files({scene, "--result", "/dev/null", "--output", "/dev/null"}), "");
  EXPECT_EQ(said_of_files({scene, "--result", ""}).find("nothing: --result: is empty, must name what is written"), 0u);
  fs::remove_all(folder);
}

// A scene's own files, however the option spells them; and within a folder of results.
TEST(CommandLine, WritesOverNoFileThatASettingsFileNames) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("command_line_test.kept." + std::to_string(getpid()));
  fs::create_directories(folder / "results");
  const std::string base = folder / "base.yaml", mesh = folder / "results/mesh.stl", link = folder / "link.yaml";
  std::ofstream(base) << "body: {}\n";
  std::ofstream(mesh) << "solid a\nendsolid a\n";
  fs::create_symlink(base, link);
  const YamlNode scene = YamlNode::parse("include: base.yaml\nstl: results/mesh.stl\n", folder / "scene.yaml");
  const auto read = [](const std::string& option, const std::string& file) {
    CommandLine line("Does nothing.", "nothing");
    std::string scene_file, written;
    line.add_option("SCENE", scene_file);
    line.add_option(option, written);
    std::vector<std::string> words{"nothing", "scene.yaml", option, file};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    EXPECT_FALSE(line.read(static_cast<int>(arguments.size()), arguments.data()));
  };
  const auto refusal = [](const auto& what) -> std::string {
    try {
      what();
      return "";
    } catch (const std::exception& error) {
      return error.what();
    }
  };
  for (const std::string& option : written_options())
    for (const std::string& file : {base, link, (folder / "none/../base.yaml").string()}) {
      read(option, file);
      const std::string said = refusal([&] { named_file(scene.child("include")); });
      EXPECT_NE(
          said.find("scene.yaml:1: include: 'base.yaml' would be written over by " + option + "; give that a file"),
          std::string::npos)
          << said;
      EXPECT_NE(refusal([&] { YamlNode::load_file(base); }).find("would be written over by " + option),
                std::string::npos);
      EXPECT_EQ(named_file(scene.child("stl")), mesh);
    }
  read("--output", folder / "results");
  named_file(scene.child("stl"));
  EXPECT_NE(refusal([&] { write_file(mesh, ""); }).find("mesh.stl: would be written over, though it was read"),
            std::string::npos);
  EXPECT_NE(refusal([&] { write_file(folder / "none/../results/mesh.stl", ""); }), "");
  EXPECT_GT(fs::file_size(mesh), 0u);
  write_file(folder / "results/other.stl", "");
  set_outputs({});  // as another program: what was read before is not kept
  write_file(mesh, "");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace soft_robot_lab
