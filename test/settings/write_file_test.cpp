// SPDX-License-Identifier: BSD-3-Clause
#include "settings/write_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <csignal>

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class WriteFile : public testing::Test {
 protected:
  WriteFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~WriteFile() override { fs::remove_all(folder_); }

  static std::string text_of(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::string refusal(const std::string& path, const std::string& text) {
    try {
      write_file(path, text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "written";
  }
  long files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  fs::path folder_ = fs::path(testing::TempDir()) / "write_file_test";
};

// No file may grow beyond a thousand bytes, as on a disk that is full.
class FullDisk {
 public:
  FullDisk() {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{1000, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(WriteFile, WritesWholeFilesAndReplacesThem) {
  const std::string path = folder_ / "a.txt";
  write_file(path, "one");
  EXPECT_EQ(text_of(path), "one");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  write_file(path, "two");
  EXPECT_EQ(text_of(path), "two");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(files(), 1);
}

TEST_F(WriteFile, WritesToWhereALinkLeads) {
  write_file(folder_ / "a.txt", "one");
  fs::create_symlink(folder_ / "a.txt", folder_ / "link.txt");
  write_file(folder_ / "link.txt", "two");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(text_of(folder_ / "a.txt"), "two");
}

TEST_F(WriteFile, LeavesTheOldFileWhereTheDiskIsFull) {
  const std::string path = folder_ / "a.txt";
  write_file(path, "one");
  {
    const FullDisk full;
    EXPECT_EQ(refusal(path, std::string(5000, 'x')), path + ": cannot be written: File too large");
  }
  EXPECT_EQ(text_of(path), "one");
  EXPECT_EQ(files(), 1);
}

TEST_F(WriteFile, SaysWhyItCannotWrite) {
  EXPECT_EQ(refusal("/dev/full", "text"), "/dev/full: cannot be written: No space left on device");
  EXPECT_EQ(refusal(folder_ / "none" / "a.txt", "text"),
            (folder_ / "none" / "a.txt").string() + ": cannot be written: No such file or directory");
  EXPECT_EQ(refusal(folder_, "text"), folder_.string() + ": cannot be written: Is a directory");
  EXPECT_EQ(refusal("/dev/null", "text"), "written");
}

TEST_F(WriteFile, DoesNotAwaitTheReaderOfAPipe) {
  const std::string path = folder_ / "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(refusal(path, "one"), path + ": cannot be written: nobody reads this pipe");
  const int reader = open(path.c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_EQ(refusal(path, "one"), "written");
  char text[4] = {};
  EXPECT_EQ(read(reader, text, sizeof text), 3);
  EXPECT_STREQ(text, "one");
  close(reader);
}

// Whoever may write to the folder could lay a link under a name that is known beforehand.
TEST_F(WriteFile, FollowsNoLinkThatLiesWhereItsPartWouldBe) {
  const std::string path = folder_ / "a.txt";
  std::ofstream(folder_ / "victim.txt") << "kept";
  fs::create_symlink(folder_ / "victim.txt", path + "." + std::to_string(getpid()) + ".part");
  write_file(path, "one");
  EXPECT_EQ(text_of(path), "one");
  EXPECT_EQ(text_of(folder_ / "victim.txt"), "kept");
  EXPECT_FALSE(fs::is_symlink(path));
}

}  // namespace
}  // namespace soft_robot_lab
