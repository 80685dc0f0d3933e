// SPDX-License-Identifier: BSD-3-Clause
// study_mpi_worker PROGRAM: the ranks that `study --mpi` starts. Each rank runs tasks, in the slot of its number; rank
// 0 also passes lines between the study, on its standard input and output, and the other ranks.
#include <atomic>
#include <chrono>
#include <exception>
#include <iostream>
#include <string>
#include <thread>

#include <mpi.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "study/sweeps/line_queue.h"
#include "study/sweeps/worker.h"

namespace {

using namespace soft_robot_lab;

constexpr int kLine = 1, kEnd = 2;             // tags
constexpr std::chrono::milliseconds kRest{2};  // between looks: waiting inside MPI would take a whole core
void send(int rank, const std::string& line, int tag = kLine) {
  MPI_Send(line.data(), static_cast<int>(line.size()), MPI_CHAR, rank, tag, MPI_COMM_WORLD);
}

// Only the main thread calls MPI.
class Rank {
 public:
  explicit Rank(std::string program) : program_(std::move(program)) {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
  }

  // Until the study is gone.
  void run() {
    std::thread([this] { work(); }).detach();
    if (rank_ == 0) std::thread([this] { read(); }).detach();
    while (!ended_) {
      const bool message = take_message(), answer = take_answer(), request = take_request();
      if (rank_ == 0 && input_ended_) end_all();
      if (!message && !answer && !request) std::this_thread::sleep_for(kRest);
    }
  }

 private:
  void work() {
    try {
      run_worker(program_, rank_,
                 {[this] { return tasks_.wait(); }, [this](const auto& line) { answers_.push(line); }});
    } catch (const std::exception& error) {
      std::cerr << "study_mpi_worker: rank " << rank_ << ": " << error.what() << "\n";
      _exit(1);
    }
  }

  void read() {
    for (std::string line; std::getline(std::cin, line);) requests_.push(line);
    input_ended_ = true;
  }

  bool take_message() {
    int here = 0, length = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &here, &status);
    if (here == 0) return false;
    MPI_Get_count(&status, MPI_CHAR, &length);
    std::string line(static_cast<std::size_t>(length), '\0');
    MPI_Recv(line.data(), length, MPI_CHAR, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (status.MPI_TAG == kEnd)
      ended_ = true;
    else
      rank_ == 0 ? print_line(line) : tasks_.push(line);
    return true;
  }

  bool take_answer() {
    const std::optional<std::string> line = answers_.poll();
    if (line) rank_ == 0 ? print_line(*line) : send(0, *line);
    return line.has_value();
  }

  bool take_request() {
    const std::optional<std::string> line = requests_.poll();
    if (!line) return false;
    const int slot = nlohmann::ordered_json::parse(*line).at("slot");
    slot == 0 ? tasks_.push(*line) : send(slot, *line);
    return true;
  }

  void end_all() {
    for (int rank = 1; rank < count_; ++rank) send(rank, "", kEnd);
    ended_ = true;
  }

  std::string program_;
  int rank_ = 0, count_ = 1;
  bool ended_ = false;
  std::atomic<bool> input_ended_{false};
  LineQueue tasks_, answers_;  // of this rank's worker
  LineQueue requests_;         // of the study, at rank 0
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "study_mpi_worker: is started by study --mpi COMMAND\n";
    return 2;
  }
  int threads = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &threads);
  auto* rank = new Rank(argv[1]);  // its threads run until the process ends
  rank->run();
  MPI_Finalize();
  _exit(0);  // with the worker's thread and what it runs
}
