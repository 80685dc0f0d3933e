// SPDX-License-Identifier: BSD-3-Clause
// A study that runs, seen from outside: its journal and its processes.
#pragma once

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

extern char** environ;

namespace soft_robot_lab {

using Words = std::vector<std::string>;

// As a reader beside the running study: the answer's first cell, "" before there is a journal.
inline std::string ask(const std::string& journal, const char* question) {
  sqlite3* database = nullptr;
  sqlite3_stmt* answer = nullptr;
  std::string found;
  if (sqlite3_open_v2(journal.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK &&
      sqlite3_prepare_v2(database, question, -1, &answer, nullptr) == SQLITE_OK && sqlite3_step(answer) == SQLITE_ROW)
    found = reinterpret_cast<const char*>(sqlite3_column_text(answer, 0));
  sqlite3_finalize(answer);
  sqlite3_close(database);
  return found;
}

inline int outcomes_in(const std::string& journal) {
  return std::atoi(("0" + ask(journal, "SELECT count(*) FROM outcomes")).c_str());
}

// Children, their children, and so on; some may have ended meanwhile.
inline std::vector<pid_t> descendants_of(pid_t process) {
  const std::string name = std::to_string(process);
  std::ifstream file("/proc/" + name + "/task/" + name + "/children");
  std::vector<pid_t> all;
  for (pid_t child; file >> child;) {
    all.push_back(child);
    for (const pid_t below : descendants_of(child)) all.push_back(below);
  }
  return all;
}

// Whether it runs still; one that nobody waited for yet does not.
inline bool runs(pid_t process) {
  std::string text;
  std::getline(std::ifstream("/proc/" + std::to_string(process) + "/stat"), text);
  const std::size_t name_end = text.rfind(')');
  return name_end != std::string::npos && text.substr(name_end, 4).find('Z') == std::string::npos;
}

inline pid_t start(const Words& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t process = -1;
  EXPECT_EQ(posix_spawn(&process, words[0], nullptr, nullptr, words.data(), environ), 0);
  return process;
}

}  // namespace soft_robot_lab
