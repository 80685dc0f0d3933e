// SPDX-License-Identifier: BSD-3-Clause
// mesh_file_for with small shell scripts in place of mesh_robot: caching, time limit, failures.
#include "soft_robot_lab/robot/design/mesher.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "robot/design/content_cache.h"
#include "robot/design/content_hash.h"
#include "robot/design/used_time.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// A variable of the environment as long as this lives.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name), before_(std::getenv(name) ? std::getenv(name) : "") {
    setenv(name, value, 1);
  }
  ~Environment() { setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

Solid solid_of(const std::string& yaml) { return read_solid(YamlNode::parse(yaml, "solid")); }

class MeshFileFor : public testing::Test {
 protected:
  MeshFileFor() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    options_.cache_folder = folder_ / "cache";
    request_.solid = solid_of("{sphere: {radius_m: 0.125, center_m: [0, 0, 0]}}");
  }
  ~MeshFileFor() override { fs::remove_all(folder_); }

  static bool is_alive(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    const std::string stat{std::istreambuf_iterator<char>(file), {}};
    return kill(process, 0) == 0 && stat.find(") Z") == std::string::npos;
  }
  static void wait_for(const std::function<bool()>& condition) {
    for (int i = 0; i < 500 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

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
            "solid: {sphere: {radius_m: 0.125, center_m: [0, 0, 0]}}\nelement_size_m: 0.01\nquadratic: true\n"
            "refinements: []\n");
}

TEST_F(MeshFileFor, PassesRefinementsOnAsTheyAreRead) {
  use_script("cp \"$1\" \"$2\"");
  const std::vector<std::string> table = {"{center_m: [0, 0, 0.5], radius_m: 0.25, size_m: 0.125}",
                                          R"({surface: "it's", size_m: 0.125})",
                                          R"({edges_of: "cavity", size_m: 0.125})"};
  std::string expected;
  for (const std::string& refinement : table) {
    request_.refinements.push_back(read_mesh_refinement(YamlNode::parse(refinement, "test")));
    expected += "- " + refinement + "\n";
  }
  const std::string text = text_of(mesh_file_for(request_, options_));
  EXPECT_NE(text.find("refinements:\n" + expected), std::string::npos) << text;
}

TEST_F(MeshFileFor, RefusesARefinementOfNoSurface) {
  EXPECT_THROW(read_mesh_refinement(YamlNode::parse("{surface: '', size_m: 1}", "test")), SettingsError);
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
  request_.solid = solid_of("{sphere: {radius_m: 0.2, center_m: [0, 0, 0]}}");
  mesh_file_for(request_, options_);
  EXPECT_EQ(runs(), 5);
}

TEST_F(MeshFileFor, MeshesAgainWhenAReferencedFileChanges) {
  use_script("cp \"$1\" \"$2\"");
  const fs::path part = folder_ / "part's.step";
  std::ofstream(part) << "one";
  request_.solid = solid_of("{step: \"" + part.string() + "\"}");
  const std::string first = mesh_file_for(request_, options_);
  std::ofstream(part) << "two";
  EXPECT_NE(mesh_file_for(request_, options_), first);
  request_.solid.reset();
  request_.mesh_file = part;
  const std::string second = mesh_file_for(request_, options_);
  EXPECT_EQ(text_of(second), "mesh_file: \"" + part.string() + "\"\n");
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
  wait_for([&] { return !is_alive(child); });
  EXPECT_FALSE(is_alive(child));
}

// Others that keep one core busy as long as this lives, and all that is started meanwhile on the same core.
class CrowdedCore {
 public:
  CrowdedCore() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int core = 0; core < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++core)
      if (CPU_ISSET(core, &before_)) CPU_SET(core, &one);
    sched_setaffinity(0, sizeof one, &one);
    for (pid_t& other : others_)
      if (other = fork(); other == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (volatile bool busy = true; busy;) continue;
      }
  }
  ~CrowdedCore() {
    for (const pid_t other : others_) {
      kill(other, SIGKILL);
      waitpid(other, nullptr, 0);
    }
    sched_setaffinity(0, sizeof before_, &before_);
  }

 private:
  cpu_set_t before_;
  std::array<pid_t, 3> others_;
};

// Else a design would be worth another thing on a machine that has much to do.
TEST_F(MeshFileFor, DoesNotCountHowLongTheMesherWaitsForACore) {
  use_script("python3 -c 'import time\nwhile time.process_time() < 0.5: pass'\ncp \"$1\" \"$2\"");
  options_.time_limit_s = 1.5;
  const CrowdedCore crowded;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_NO_THROW(mesh_file_for(request_, options_));
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1600)) << "nothing kept it waiting";
}

// Whoever looks waits for a core too: what was asleep at a late look may have waited all the time before.
TEST_F(MeshFileFor, DoesNotTakeTheTimeBeforeALateLookForSleep) {
  const CrowdedCore crowded;
  const pid_t process = fork();
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (std::clock() < CLOCKS_PER_SEC / 5) continue;
    pause();
  }
  const auto begin = std::chrono::steady_clock::now();
  UsedTime used(process);
  wait_for([&] {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    const Activity activity = read_activity(file);
    return activity.processor_s > 0.15 && !activity.can_run;
  });
  used.look();
  const double passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_LT(used.seconds(), 0.6 * passed_s);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const double before_s = used.seconds();
  used.look();
  EXPECT_GT(used.seconds(), before_s + 0.049) << "it slept";
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
}

// A child may end, and another thread wait for it, between opening its file and reading it.
TEST(ReadActivity, FindsNothingWhereTheProcessEnded) {
  const pid_t process = fork();
  if (process == 0) {
    pause();
    _exit(0);
  }
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
  EXPECT_FALSE(read_activity(file).can_run);
}

// However a program ends that meshes: its mesher ends with it, and the next one clears up.
TEST_F(MeshFileFor, LeavesNoMesherBehind) {
  const fs::path note = folder_ / "mesher";
  use_script("trap '' TERM INT\necho $$ > '" + note.string() + ".new'; mv '" + note.string() + ".new' '" +
             note.string() + "'\nwhile :; do :; done");
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    fs::remove(note);
    const pid_t program = fork();
    if (program == 0) {
      std::signal(signal, SIG_DFL);
      mesh_file_for(request_, options_);
      _exit(0);
    }
    wait_for([&] { return fs::exists(note); });
    const pid_t mesher = std::stoi(text_of(note));
    EXPECT_TRUE(is_alive(mesher));
    kill(program, signal);
    waitpid(program, nullptr, 0);
    wait_for([&] { return !is_alive(mesher); });
    EXPECT_FALSE(is_alive(mesher)) << "signal " << signal;
    kill(mesher, SIGKILL);
  }
  EXPECT_EQ(cached_files(), 3);  // what they were making
  for (const auto& entry : fs::directory_iterator(options_.cache_folder))
    fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(1));
  use_script("cp \"$1\" \"$2\"");
  mesh_file_for(request_, options_);
  EXPECT_EQ(cached_files(), 1);
}

TEST_F(MeshFileFor, LeavesAloneWhatOthersAreMaking) {
  const WorkFolder work(options_.cache_folder);
  std::ofstream(work.file("a")) << "a";
  for (const auto& entry : fs::directory_iterator(options_.cache_folder))
    fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(1));
  use_script("cp \"$1\" \"$2\"");
  mesh_file_for(request_, options_);
  EXPECT_TRUE(fs::exists(work.file("a")));
}

TEST_F(MeshFileFor, KeepsTheCacheToItsOwnerWhateverTheUmask) {
  const auto mode_of = [](const fs::path& path) { return fs::status(path).permissions(); };
  use_script("cp \"$1\" \"$2\"");
  const std::string folder = options_.cache_folder;
  const mode_t before = umask(0);
  for (const mode_t mask : {0, 022, 077}) {
    umask(mask);
    options_.cache_folder = folder + "/" + std::to_string(mask) + "/below";
    EXPECT_EQ(mode_of(mesh_file_for(request_, options_)), fs::perms::owner_read | fs::perms::owner_write) << mask;
    EXPECT_EQ(mode_of(options_.cache_folder), fs::perms::owner_all) << mask;
    EXPECT_EQ(mode_of(fs::path(options_.cache_folder).parent_path()), fs::perms::owner_all) << mask;
    const WorkFolder work(options_.cache_folder);
    EXPECT_EQ(mode_of(fs::path(work.file("a")).parent_path()), fs::perms::owner_all) << mask;
  }
  umask(before);
}

TEST_F(MeshFileFor, EndsWithTheMesherWhereItIsInterrupted) {
  const fs::path note = folder_ / "mesher";
  use_script("echo $$ > " + note.string() + "; sleep 100");
  options_.interrupt = [&] { return fs::exists(note) && !text_of(note).empty(); };
  try {
    mesh_file_for(request_, options_);
    ADD_FAILURE() << "went on";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "meshing was interrupted");
  }
  EXPECT_FALSE(is_alive(std::stoi(text_of(note))));
  EXPECT_EQ(cached_files(), 0);
}

TEST_F(MeshFileFor, LimitsTheMeshersProcessorTime) {
  use_script("ulimit -t > \"$2\"");
  options_.time_limit_s = 7;
  EXPECT_EQ(text_of(mesh_file_for(request_, options_)),
            std::to_string(7 * std::max(1U, std::thread::hardware_concurrency()) + 1) + "\n");
}

TEST_F(MeshFileFor, MeshesAgainWhereTheCacheIsDamagedOrEdited) {
  use_script("cp \"$1\" \"$2\"");
  const std::string file = mesh_file_for(request_, options_), text = text_of(file);
  std::ofstream(file) << text.substr(0, text.size() / 2);
  EXPECT_EQ(text_of(mesh_file_for(request_, options_)), text);
  std::ofstream(file, std::ios::app) << " ";
  EXPECT_EQ(text_of(mesh_file_for(request_, options_)), text);
  fs::remove(file);
  fs::create_symlink("/dev/zero", file);
  EXPECT_EQ(text_of(mesh_file_for(request_, options_)), text);
  fs::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_EQ(text_of(mesh_file_for(request_, options_)), text);
  EXPECT_EQ(runs(), 5);
  EXPECT_EQ(cached_files(), 1);
}

TEST_F(MeshFileFor, DoesNotTakeTheMeshOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  use_script("cp \"$1\" \"$2\"");
  const std::string file = mesh_file_for(request_, options_);
  ASSERT_EQ(chown(file.c_str(), 65534, 65534), 0);
  mesh_file_for(request_, options_);
  EXPECT_EQ(runs(), 2);
}

TEST_F(MeshFileFor, KeepsMeshesInAFolderOfItsOwnWithoutAHome) {
  use_script("cp \"$1\" \"$2\"");
  options_.cache_folder.clear();
  const Environment home("HOME", ""), xdg("XDG_CACHE_HOME", ""), temporary("TMPDIR", folder_.c_str());
  const fs::path own = fs::path(mesh_file_for(request_, options_)).parent_path();
  EXPECT_EQ(own, folder_ / ("soft_robot_lab_" + std::to_string(geteuid())));
  EXPECT_EQ(fs::status(own).permissions(), fs::perms::owner_all);
  fs::permissions(own, fs::perms::all);
  EXPECT_NE(refusal<std::runtime_error>().find("others may write there"), std::string::npos);
  fs::rename(own, folder_ / "elsewhere");
  fs::permissions(folder_ / "elsewhere", fs::perms::owner_all);
  fs::create_directory_symlink(folder_ / "elsewhere", own);
  EXPECT_NE(refusal<std::runtime_error>().find("others may write there"), std::string::npos);
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
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.solid.reset(); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.mesh_file = "also.msh"; }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.element_size_m = 0; }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.element_size_m = std::nan(""); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, 0, 0}, -1, 0.1}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, 0, 0}, 1, 0}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) { r.refinements.push_back({{0, std::nan(""), 0}, 1, 1}); }));
  EXPECT_TRUE(refuses([](MeshRequest& r) {
    r.solid.reset();
    r.mesh_file = "/no/such/file.msh";
  }));
  EXPECT_TRUE(refuses([](MeshRequest& r) {
    r.solid.reset();
    r.mesh_file = "/dev/zero";
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

TEST(ContentHash, TellsLargePiecesApartByEveryByte) {
  const auto hash = [](const std::string& piece) {
    ContentHash content;
    content.add_large(piece);
    return content.hex();
  };
  const std::string piece(21, 'a');  // two words and a rest
  std::set<std::string> hashes = {hash(piece), hash(piece.substr(1)), hash(piece + std::string(1, '\0'))};
  for (std::size_t i = 0; i < piece.size(); ++i) {
    std::string other = piece;
    other[i] = '\xe1';  // the highest bit of one byte
    hashes.insert(hash(other));
  }
  EXPECT_EQ(hashes.size(), piece.size() + 3);
  EXPECT_EQ(hash(piece), hash(std::string(21, 'a')));
}

}  // namespace
}  // namespace soft_robot_lab
