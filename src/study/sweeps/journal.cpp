// SPDX-License-Identifier: BSD-3-Clause
#include "journal.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

// `tasks` is the study as it is now; `outcomes` grows, and keeps what other versions of the study found.
constexpr const char* kTables = R"(
CREATE TABLE IF NOT EXISTS tasks(position INTEGER PRIMARY KEY, hash TEXT NOT NULL, parameters TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS outcomes(hash TEXT PRIMARY KEY, state TEXT NOT NULL, reason TEXT NOT NULL,
                                    result TEXT NOT NULL, wall_s REAL NOT NULL);
)";

// Held as long as the program lives, however it ends.
int lock(const std::string& folder) {
  const std::string path = folder + "/journal.lock";
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) throw std::runtime_error(path + ": cannot be opened: " + std::strerror(errno));
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  const bool taken = errno == EWOULDBLOCK;
  const std::string why = std::strerror(errno);
  close(file);
  throw std::runtime_error(taken ? folder +
                                       ": another study writes to its journal; wait for its end, or take another folder"
                                 : path + ": cannot be locked: " + why);
}

// Whoever else may write there could lay links under the names of the study's files. Root may take what is another's.
void require_own_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::perms of_others = fs::perms::others_write;
  if (fs::create_directories(folder)) fs::permissions(folder, of_others, fs::perm_options::remove);
  struct stat status {};
  if (stat(folder.c_str(), &status) != 0)
    throw std::runtime_error(folder + ": cannot be read: " + std::strerror(errno));
  if (status.st_uid != geteuid() && geteuid() != 0)
    throw std::runtime_error(folder + ": belongs to another user; choose a folder of your own");
  if ((status.st_mode & S_IWOTH) != 0)
    throw std::runtime_error(folder + ": others may write there; choose a folder of your own, or chmod o-w it");
}

}  // namespace

// Bound values are copied, as they may be gone before the statement is.
class Journal::Statement {
 public:
  Statement(const Journal& journal, const char* sql) : journal_(journal) {
    if (sqlite3_prepare_v2(journal.database_, sql, -1, &statement_, nullptr) != SQLITE_OK) journal.fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(const std::string& text) {
    sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& bind(double number) {
    sqlite3_bind_double(statement_, ++bound_, number);
    return *this;
  }
  bool step() {  // whether there is a row
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) journal_.fail();
    return code == SQLITE_ROW;
  }
  void again() {
    sqlite3_reset(statement_);
    bound_ = 0;
  }
  std::string text(int column) const {
    const auto* words = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return {words ? words : "", static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }
  double number(int column) const { return sqlite3_column_double(statement_, column); }

 private:
  const Journal& journal_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

Journal::Journal(const std::string& folder) : file_(folder + "/journal.sqlite") {
  require_own_folder(folder);
  lock_ = lock(folder);
  try {
    if (sqlite3_open(file_.c_str(), &database_) != SQLITE_OK) fail();
    sqlite3_extended_result_codes(database_, 0);
    sqlite3_busy_timeout(database_, 10000);  // of readers that check the file
    run("PRAGMA journal_mode=WAL");
    run("PRAGMA synchronous=NORMAL");
    run(kTables);
  } catch (...) {
    sqlite3_close(database_);
    close(lock_);
    throw;
  }
}

Journal::~Journal() {
  sqlite3_close(database_);
  close(lock_);
}

void Journal::fail() const {
  const int code = sqlite3_errcode(database_) & 0xff;
  const std::string why = sqlite3_errmsg(database_);
  if (code == SQLITE_FULL || code == SQLITE_IOERR)
    throw WriteError(file_ + ": cannot be written: " + why +
                     "; what it holds is whole, and the same command goes on from it");
  throw std::runtime_error(file_ + ": " + (code == SQLITE_NOTADB ? "is no journal of a study: " : "") + why);
}

void Journal::run(const char* sql) {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Journal::set_tasks(const StudySettings& study, const std::vector<StudyTask>& tasks) {
  run("BEGIN IMMEDIATE");
  try {
    run("DELETE FROM tasks");
    Statement insert(*this, "INSERT INTO tasks(position, hash, parameters) VALUES(?, ?, ?)");
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      insert.bind(static_cast<double>(i)).bind(tasks[i].hash).bind(task_request(study, tasks[i]).at("set").dump());
      insert.step();
      insert.again();
    }
    run("COMMIT");
  } catch (...) {
    sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

void Journal::add(const TaskOutcome& outcome) {
  Statement insert(*this, "INSERT OR IGNORE INTO outcomes(hash, state, reason, result, wall_s) VALUES(?, ?, ?, ?, ?)");
  insert.bind(outcome.hash).bind(name_of(outcome.state)).bind(outcome.reason).bind(outcome.result).bind(outcome.wall_s);
  insert.step();
}

std::optional<TaskOutcome> Journal::find(const std::string& hash) const {
  Statement select(*this, "SELECT state, reason, result, wall_s FROM outcomes WHERE hash = ?");
  if (!select.bind(hash).step()) return std::nullopt;
  return TaskOutcome{hash, state_named(select.text(0)), select.text(1), select.text(2), select.number(3)};
}

void Journal::forget_failures(const std::vector<StudyTask>& tasks) {
  Statement remove(*this, "DELETE FROM outcomes WHERE hash = ? AND state = 'failed'");
  for (const StudyTask& task : tasks) {
    remove.bind(task.hash).step();
    remove.again();
  }
}

}  // namespace soft_robot_lab
