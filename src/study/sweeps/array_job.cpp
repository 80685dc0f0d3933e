// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "settings/words.h"
#include "settings/write_file.h"
#include "slurm.h"
#include "task_ledger.h"
#include "worker.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

int slot_of_this_job() {
  const char* text = std::getenv("SLURM_ARRAY_TASK_ID");
  const auto slot = text ? parse_number<int>(text) : std::nullopt;
  if (!slot) throw std::runtime_error("SLURM_ARRAY_TASK_ID is not set: study --slurm starts this");
  return *slot;
}

std::set<std::string> answered_in(const std::string& file) {
  std::set<std::string> hashes;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const Json answer = Json::parse(line, nullptr, false);  // the last may be torn
    if (answer.is_object() && answer.contains("state")) hashes.insert(answer.at("hash"));
  }
  return hashes;
}

// Those of this slot that have no answer yet.
std::deque<std::string> own_tasks(const std::string& folder, int slot, const std::string& answers) {
  const std::set<std::string> answered = answered_in(answers);
  std::ifstream stream(folder + "/tasks");
  if (!stream) throw std::runtime_error(folder + "/tasks cannot be read: it must lie on a disk that all nodes share");
  std::deque<std::string> own;
  for (std::string line; std::getline(stream, line);) {
    const Json task = Json::parse(line);
    if (task.at("slot") == slot && answered.count(task.at("hash")) == 0) own.push_back(line);
  }
  return own;
}

// One write a line, begun on a new line.
class AnswersFile {
 public:
  explicit AnswersFile(std::string path) : path_(std::move(path)) {
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file_ < 0) throw std::runtime_error(path_ + " cannot be opened: " + std::strerror(errno));
  }
  ~AnswersFile() { close(file_); }
  AnswersFile(const AnswersFile&) = delete;
  AnswersFile& operator=(const AnswersFile&) = delete;

  void add(const std::string& line) const {
    const std::string text = "\n" + line + "\n";
    if (write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size()) || fsync(file_) != 0)
      throw WriteError(path_ + " cannot be written: " + std::strerror(errno));
  }

 private:
  std::string path_;
  int file_ = -1;
};

}  // namespace

void run_array_job(const std::string& program, const std::string& folder) {
  const int slot = slot_of_this_job();
  const std::string path = folder + "/" + std::to_string(slot) + ".answers";
  std::deque<std::string> tasks = own_tasks(folder, slot, path);
  const AnswersFile answers(path);
  const auto next = [&]() -> std::optional<std::string> {
    if (tasks.empty()) return std::nullopt;
    std::string line = std::move(tasks.front());
    tasks.pop_front();
    return line;
  };
  run_worker(program, slot, {next, [&](const std::string& line) { answers.add(line); }});
}

}  // namespace soft_robot_lab
