// mesh_file_for with small shell scripts in place of mesh_robot: caching, time limit, failures.
#include "soft_robot_lab/design/mesher.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "soft_robot_lab/design/content_hash.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class MeshFileFor : public testing::Test {
 protected:
  MeshFileFor() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    options_.cache_folder = folder_ / "cache";
    request_.solid_yaml = "{sphere: {radius_m: 0.1, center_m: [0, 0, 0]}}";
  }
  ~MeshFileFor() override { fs::remove_all(folder_); }

  // A mesher that notes each run and then does what `body` says, with the request in $1 and the output in $2.
  void use_script(const std::string& body) {
    const fs::path script = folder_ / "mesher.sh";
    std::ofstream(script) << "#!/bin/sh\necho run >> '" << (folder_ / "runs").string() << "'\n" << body << "\n";
    fs::permissions(script, fs::perms::owner_all);
    options_.program = script;
  }
  long runs() const {
    std::ifstream file(folder_ / "runs");
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n');
  }
  std::string text_of(const fs::path& path) const {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  long cached_files() const {
    return std::distance(fs::directory_iterator(options_.cache_folder), fs::directory_iterator());
  }
  template <typename Exception>
  std::string refusal() {
    try {
      mesh_file_for(request_, options_);
    } catch (const Exception& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "mesher_test";
  MesherOptions options_;
  MeshRequest request_;
};

TEST_F(MeshFileFor, MeshesOnceAndThenUsesTheCache) {
  use_script("cp \"$1\" \"$2\"");
  const std::string first = mesh_file_for(request_, options_);
  EXPECT_EQ(mesh_file_for(request_, options_), first);
  EXPECT_EQ(runs(), 1);
  EXPECT_EQ(cached_files(), 1);  // no temporary files stay
  EXPECT_EQ(text_of(first),
            "solid: {sphere: {radius_m: 0.1, center_m: [0, 0, 0]}}\nelement_size_m: 0.01\nquadratic: true\n"
            "refinements: []\n");
}

TEST_F(MeshFileFor, PassesRefinementsOnAsTheyAreRead) {
  use_script("cp \"$1\" \"$2\"");
  const std::vector<std::string> table = {"{center_m: [0, 0, 0.5], radius_m: 0.25, size_m: 0.125}",
                                          "{surface: 'it''s', size_m: 0.125}", "{edges_of: 'cavity', size_m: 0.125}"};
  std::string expected;
  for (const std::string& refinement : table) {
    request_.refinements.push_back(read_mesh_refinement(SettingsNode::parse(refinement, "test")));
    expected += "- " + refinement + "\n";
  }
  const std::string text = text_of(mesh_file_for(request_, options_));
  EXPECT_NE(text.find("refinements:\n" + expected), std::string::npos) << text;
}

TEST_F(MeshFileFor, RefusesARefinementOfNoSurface) {
  EXPECT_THROW(read_mesh_refinement(SettingsNode::parse("{surface: '', size_m: 1}", "test")), SettingsError);
}

TEST_F(MeshFileFor, MeshesAgainWhenAnythingInTheRequestChanges) {
  use_script("cp \"$1\" \"$2\"");
  mesh_file_for(request_, options_);
  request_.element_size_m = 0.010000000000000002;
  mesh_file_for(request_, options_);
  request_.quadratic = false;
  mesh_file_for(request_, options_);
  request_.refinements.push_back({{0, 0, 0}, 0.1, 0.001});
  mesh_file_for(request_, options_);
  request_.solid_yaml = "{sphere: {radius_m: 0.2, center_m: [0, 0, 0]}}";
  mesh_file_for(request_, options_);
  EXPECT_EQ(runs(), 5);
}

TEST_F(MeshFileFor, MeshesAgainWhenAReferencedFileChanges) {
  use_script("cp \"$1\" \"$2\"");
  const fs::path part = folder_ / "part's.step";
  std::ofstream(part) << "one";
  request_.solid_yaml = "{step: \"" + part.string() + "\"}";
  const std::string first = mesh_file_for(request_, options_);
  std::ofstream(part) << "two";
  EXPECT_NE(mesh_file_for(request_, options_), first);
  request_.solid_yaml.clear();
  request_.mesh_file = part;
  const std::string second = mesh_file_for(request_, options_);
  EXPECT_EQ(text_of(second), "mesh_file: '" + (folder_ / "part''s.step").string() + "'\n");
  std::ofstream(part) << "three";
  EXPECT_NE(mesh_file_for(request_, options_), second);
  EXPECT_EQ(runs(), 4);
}

TEST_F(MeshFileFor, StopsTheMesherAndItsChildrenAfterTheTimeLimit) {
  use_script("sleep 60 &\necho $! > '" + (folder_ / "child").string() + "'\nsleep 60");
  options_.time_limit_s = 0.3;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_NE(refusal<std::runtime_error>().find("meshing took longer than 0.3 s"), std::string::npos);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  EXPECT_EQ(cached_files(), 0);
  const pid_t child = std::stoi(text_of(folder_ / "child"));
  const std::string state = "/proc/" + std::to_string(child) + "/stat";
  const auto alive = [&] { return kill(child, 0) == 0 && text_of(state).find(") Z") == std::string::npos; };
  for (int i = 0; i < 100 && alive(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(alive());
}

TEST_F(MeshFileFor, PassesOnTheMeshersWords) {
  use_script("echo 'empty solid' >&2; echo half > \"$2\"; exit 2");
  EXPECT_EQ(refusal<std::invalid_argument>(), "empty solid");
  EXPECT_EQ(cached_files(), 0);
  use_script("exit 7");
  EXPECT_EQ(refusal<std::runtime_error>(), "the mesher failed with status 7");
  use_script("kill -SEGV $$");
  EXPECT_EQ(refusal<std::runtime_error>(), "the mesher was ended by signal 11");
  use_script("exit 0");  // without an output
  EXPECT_NE(refusal<std::runtime_error>(), "accepted");
}

TEST_F(MeshFileFor, RefusesBadRequests) {
  use_script("cp \"$1\" \"$2\"");
  const MeshRequest good = request_;
  const auto refuses = [&](const std::function<void(MeshRequest&)>& damage) {
    request_ = good;
    damage(request_);
    return refusal<std::invalid_argument>() != "accepted";
  };
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.solid_yaml.clear(); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.mesh_file = "also.msh"; }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.solid_yaml = "{sphere: {}}"; }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.element_size_m = 0; }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.element_size_m = std::nan(""); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, 0, 0}, -1, 0.1}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, 0, 0}, 1, 0}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, std::nan(""), 0}, 1, 1}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) {
    r.solid_yaml.clear();
    r.mesh_file = "/no/such/file.msh";
  }));
  EXPECT_EQ(runs(), 0);
  request_ = good;
  options_.program = "/no/such/program";
  EXPECT_EQ(refusal<std::runtime_error>(), "mesher: '/no/such/program' is not a program");
}

TEST_F(MeshFileFor, FindsProgramAndCacheByItself) {
  use_script("cp \"$1\" \"$2\"");
  fs::rename(options_.program, folder_ / "mesh_robot");
  setenv("PATH", (folder_.string() + ":" + std::getenv("PATH")).c_str(), 1);
  setenv("XDG_CACHE_HOME", (folder_ / "xdg").c_str(), 1);
  const fs::path file = mesh_file_for(request_, MesherOptions{});
  EXPECT_EQ(file.parent_path(), folder_ / "xdg" / "soft_robot_lab");
  EXPECT_TRUE(fs::exists(file));
  unsetenv("XDG_CACHE_HOME");
  setenv("HOME", folder_.c_str(), 1);
  EXPECT_EQ(fs::path(mesh_file_for(request_, MesherOptions{})).parent_path(), folder_ / ".cache" / "soft_robot_lab");
}

TEST_F(MeshFileFor, SeveralCallersMayAskForTheSame) {
  use_script("sleep 0.1; cp \"$1\" \"$2\"");
  std::vector<std::thread> threads;
  std::vector<std::string> files(4);
  for (std::string& file : files) threads.emplace_back([&] { file = mesh_file_for(request_, options_); });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& file : files) EXPECT_EQ(file, files[0]);
  EXPECT_EQ(cached_files(), 1);
  EXPECT_NE(text_of(files[0]), "");
}

// Published test values of FNV-1a, 128 bits, would need unseparated pieces; here the properties that the cache relies
// on.
TEST(ContentHash, TellsPiecesApart) {
  const auto hash = [](const std::vector<std::string>& pieces) {
    ContentHash content;
    for (const std::string& piece : pieces) content.add(piece);
    return content.hex();
  };
  EXPECT_EQ(hash({"ab", "c"}).size(), 32u);
  EXPECT_EQ(hash({"ab", "c"}), hash({"ab", "c"}));
  EXPECT_NE(hash({"ab", "c"}), hash({"a", "bc"}));
  EXPECT_NE(hash({"ab"}), hash({"ab", ""}));
  EXPECT_EQ(hash({}), "6c62272e07bb014262b821756295c58d");  // the offset basis
}

}  // namespace
}  // namespace soft_robot_lab
