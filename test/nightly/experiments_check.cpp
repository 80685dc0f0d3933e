// SPDX-License-Identifier: BSD-3-Clause
// experiments_check FOLDER: runs every experiment as a user does, into FOLDER, checks what each result must hold, and
// writes a table of them to FOLDER/experiments.md.
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

std::string folder;  // where results go

double children_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

struct Ran {
  int exit_status = -1;  // -1: ended by a signal
  double cpu_s = 0.0;
  Json result;
};

Ran run_experiment(const std::string& name) {
  const std::string result = folder + "/" + name + ".json";
  std::filesystem::remove(result);
  const double before_s = children_cpu_s();
  const std::string command = std::string("'") + SOFT_ROBOT_LAB_EXPERIMENT + "' " + name + " --result '" + result +
                              "' --output '" + folder + "/" + name + "' >'" + folder + "/" + name + ".txt' 2>&1";
  const int status = std::system(command.c_str());
  Ran run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, children_cpu_s() - before_s, {}};
  if (std::filesystem::exists(result)) run.result = Json::parse(contents(result));
  return run;
}

std::vector<std::string> experiment_names() {
  const std::string list = folder + "/list.txt";
  std::vector<std::string> names;
  if (std::system((std::string("'") + SOFT_ROBOT_LAB_EXPERIMENT + "' --list >'" + list + "'").c_str()) != 0)
    return names;
  std::ifstream lines(list);
  for (std::string line; std::getline(lines, line);) names.push_back(line.substr(0, line.find(": ")));
  return names;
}

// What results must hold beyond what every experiment's must, by the experiment's name.
void check_stiffnesses(const Json& result) {  // of 4.3.2
  ASSERT_EQ(result["stiffnesses"].size(), 7u);
  for (const Json& one : result["stiffnesses"]) {
    EXPECT_EQ(one["sliding"]["settles"], true) << one;
    EXPECT_NEAR(one["sliding"]["final_length_m"].get<double>(), 0.1235, 2e-3) << one;
    if (one["stiffness_n_m"] >= 10000.0) {
      EXPECT_EQ(one["explicit_springs"]["settles"], false) << one;
    }
  }
}

void check_pid(const Json& result) {  // of 7.3.2
  ASSERT_EQ(result["pid"].size(), 10u);
  for (const Json& target : result["pid"]) {
    EXPECT_LT(target["smallest_after_ten_m"], target["largest_after_ten_m"]) << target["target"];
    if (target["start_distance_m"] > 0.05) {
      EXPECT_EQ(target["swings"], true) << target["target"];
    }
  }
}

void check_ball(const Json& result) {  // of 7.3.3
  EXPECT_NEAR(result["start_distance_m"].get<double>(), 0.0382, 0.0003);
  EXPECT_LT(result["final_distance_m"].get<double>(), 0.5 * result["start_distance_m"].get<double>());
}

void check_tentacle(const Json& result) {
  EXPECT_LT(result["mean_distance_m"].get<double>(), result["identified"]["mean_distance_m"].get<double>());
  EXPECT_LT(result["identified"]["mean_distance_m"].get<double>(), result["start"]["mean_distance_m"].get<double>());
  EXPECT_GT(result["mean_distance_m"].get<double>(), 0.003);  // its frame alone is farther off
}

void check_demoulding(const Json& result) {
  const Json& runs = result["runs"];
  ASSERT_EQ(runs.size(), 4u);
  const double with_air_n = runs[0]["peak_force_n"], blind_n = runs[1]["peak_force_n"];
  EXPECT_GT(blind_n, 5.0 * with_air_n);
  EXPECT_GT(runs[1]["at_m"][2].get<double>(), -0.008) << "near the top facet";
  for (const Json& run : runs)
    EXPECT_LT(run["largest_stretch"].get<double>() - 1, 4.9) << run["name"] << ": half of 980 %";
}

void check_grasp(const Json& result) {
  for (const Json& run : result["runs"]) {
    const double of_the_least = run["friction"].get<double>() / result["least_friction"].get<double>();
    if (of_the_least < 0.8 || of_the_least > 1.0) {  // soft skin lies around the ball, and holds somewhat better
      EXPECT_EQ(run["held"], run["should_hold"]) << run["friction"];
    }
  }
  const Json& longest = result["runs"][0];
  EXPECT_GE(longest["shaken_s"].get<double>(), 60.0);
  EXPECT_EQ(longest["held"], true);
  EXPECT_LT(longest["slip_m"].get<double>(), 1e-5);
}

void check_fit_rig(const Json& result) {
  for (const auto& [name, within] : std::map<std::string, double>{{"youngs_modulus_pa", 0.01},
                                                                  {"friction_coefficient", 0.2},
                                                                  {"compliance_m_n", 0.2},
                                                                  {"backlash_m.left", 0.2},
                                                                  {"backlash_m.right", 0.2},
                                                                  {"creep.stiffness_ratio", 0.2},
                                                                  {"creep.relaxation_time_s", 0.2}}) {
    const double hidden = result["hidden"][name];
    EXPECT_NEAR(result["values"][name]["found"].get<double>(), hidden, within * hidden) << name;
  }
  EXPECT_LT(result["unseen_gap_m"][1].get<double>(), 0.15e-3);
}

void check_twin(const Json& result) {
  EXPECT_LT(result["place_median_m"].get<double>(), 0.006);
  EXPECT_LT(result["weight_median_ratio"].get<double>(), 0.1);
  EXPECT_LT(result["false_alarms"].get<double>(), 0.1 * result["looks_untouched"].get<double>());
}

void check_paths(const Json& result) {
  ASSERT_EQ(result["paths"].size(), 10u);  // five paths at two speeds
  for (const Json& path : result["paths"]) {
    for (const std::string way : {"open_loop_rms_m", "feedback_rms_m", "learnt_rms_m"})
      EXPECT_GT(path[way].get<double>(), 0.0) << path["name"];
    EXPECT_GE(path["duration_s"].get<double>(), 0.999 * path["fastest_s"].get<double>()) << path["name"];
    EXPECT_LT(path["learnt_rms_m"].get<double>(), 0.8e-3 + path["nearest_rms_m"].get<double>()) << path["name"];
  }
}

void check_design(const Json& result) {
  EXPECT_EQ(result["designs"], 200);
  EXPECT_GT(result["ratio"].get<double>(), 1.2);
}

void check_configurations(const Json& result, std::size_t count) {
  ASSERT_EQ(result["configurations"].size(), count);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(result["configurations"][i]["name"], std::string(1, static_cast<char>('a' + i)));
}

void check_numbers(const std::string& name, const Json& result) {
  if (name == "4.3.2") check_stiffnesses(result);
  if (name == "6.3.1" || name == "6.3.2") {
    EXPECT_EQ(result["configurations"].size(), 16u);  // with two kinds of cable
  }
  if (name == "6.4.2") check_configurations(result, 8);
  if (name == "6.4.1") check_configurations(result, 7);
  if (name == "6.4.3") check_configurations(result, 9);
  if (name == "7.3.2") check_pid(result);
  if (name == "7.3.3") check_ball(result);
  if (name == "tentacle") check_tentacle(result);
  if (name == "demoulding") check_demoulding(result);
  if (name == "grasp") check_grasp(result);
  if (name == "fit_rig") check_fit_rig(result);
  if (name == "twin") check_twin(result);
  if (name == "paths") check_paths(result);
  if (name == "design_spinebot") check_design(result);
}

struct Row {
  std::string name, outcome;
  double cpu_s;
  std::string we_find;
};

std::vector<Row> rows;

class EveryExperiment : public testing::Test {
 public:
  explicit EveryExperiment(std::string name) : name_(std::move(name)) {}

  void TestBody() override {
    const Ran run = run_experiment(name_);
    check(run);
    rows.push_back({name_, HasFailure() ? "failed" : "passed", run.cpu_s,
                    run.result.is_object() ? run.result.value("we_find", "") : ""});
  }

 private:
  void check(const Ran& run) const {
    ASSERT_EQ(run.exit_status, 0) << contents(folder + "/" + name_ + ".txt");
    ASSERT_TRUE(run.result.is_object());
    EXPECT_EQ(run.result["converged"], true) << run.result["message"];
    EXPECT_FALSE(run.result["table"].empty());
    EXPECT_FALSE(run.result["source_reports"].get<std::string>().empty());
    check_numbers(name_, run.result);
  }

  std::string name_;
};

void write_table(const std::string& file) {
  std::ofstream out(file);
  out << "| experiment | checks | CPU [s] | what it found |\n|---|---|---|---|\n";
  for (const Row& row : rows)
    out << "| `" << row.name << "` | " << row.outcome << " | " << std::fixed << std::setprecision(1) << row.cpu_s
        << " | " << row.we_find << " |\n";
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  testing::InitGoogleTest(&argc, argv);
  if (argc != 2) {
    std::fputs("usage: experiments_check FOLDER\n", stderr);
    return 2;
  }
  folder = std::filesystem::absolute(argv[1]).string();
  std::filesystem::create_directories(folder);
  const std::vector<std::string> names = experiment_names();
  if (names.empty()) {
    std::fputs("experiments_check: `experiment --list` names none\n", stderr);
    return 2;
  }
  for (const std::string& name : names)
    testing::RegisterTest("Experiment", name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                          [name]() -> testing::Test* { return new EveryExperiment(name); });
  const int status = RUN_ALL_TESTS();
  write_table(folder + "/experiments.md");
  return status;
}
