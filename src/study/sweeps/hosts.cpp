// SPDX-License-Identifier: BSD-3-Clause
#include "hosts.h"

#include <sstream>
#include <stdexcept>

#include "settings/find_program.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "shell_words.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostWorkers = limits::kThreads;

int workers_of(const std::vector<std::string>& line, const std::string& place) {
  if (line.size() > 2) throw std::invalid_argument(place + ": must be a host and its number of workers");
  if (line[0].front() == '-') throw std::invalid_argument(place + ": '" + line[0] + "' is no name of a host");
  const auto count = line.size() == 1 ? 1 : parse_number<int>(line[1]).value_or(0);
  if (count < 1 || count > kMostWorkers)
    throw std::invalid_argument(place + ": '" + line[1] + "' workers is out of range [1, " +
                                std::to_string(kMostWorkers) + "]");
  return count;
}

}  // namespace

std::vector<WorkerCommand> local_workers(const std::string& program, int count) {
  const WorkerCommand worker{"this machine", {study_program(), "--worker", program}};
  return std::vector<WorkerCommand>(static_cast<std::size_t>(count), worker);
}

std::vector<WorkerCommand> remote_workers(const std::string& program, const std::string& hosts_file,
                                          const std::string& shell) {
  std::istringstream lines(read_regular_file(hosts_file, kLargestSettings_bytes));
  std::vector<WorkerCommand> workers;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    std::vector<std::string> command = words_of(shell);
    command.push_back(words[0]);
    command.push_back("exec " + shell_quoted(study_program()) + " --worker " + program);
    const int count = workers_of(words, hosts_file + ":" + std::to_string(number));
    workers.insert(workers.end(), static_cast<std::size_t>(count), {words[0], command});
  }
  if (workers.empty()) throw std::invalid_argument(hosts_file + ": names no host");
  return workers;
}

std::vector<WorkerCommand> mpi_workers(const std::string& program, const std::string& launcher) {
  const std::string worker = find_program("study_mpi_worker");
  if (worker.empty())
    throw std::invalid_argument(
        "--mpi: this build has no program study_mpi_worker; install libopenmpi-dev, build again");
  std::vector<std::string> command = words_of(launcher);
  if (command.empty()) throw std::invalid_argument("--mpi: must be a command that starts ranks, as mpirun -n 8");
  command.insert(command.end(), {worker, program});
  return {{"MPI", command}};
}

}  // namespace soft_robot_lab
