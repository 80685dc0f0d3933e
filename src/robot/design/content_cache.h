// SPDX-License-Identifier: BSD-3-Clause
// Files kept by the content that they were made of, for programs that run at the same time.
#pragma once

#include <string>
#include <utility>

namespace soft_robot_lab {

class ContentCache {
 public:
  explicit ContentCache(std::string folder) : folder_(std::move(folder)) {}

  // The path of what was kept under this key with this ending (".msh"), or "". The checksum in its name must be that of
  // its content, and it must be the caller's own; otherwise it is removed, as far as that is allowed.
  std::string find(const std::string& key, const std::string& ending) const;

  // Moves a finished file of the cache's folder to its place, whole or not at all, readable by its owner alone; returns
  // its path.
  std::string keep(const std::string& part, const std::string& key, const std::string& ending) const;

  // Keeps a text. Does nothing where it cannot be written whole: it only saves the time to make it again.
  void keep_text(const std::string& text, const std::string& key, const std::string& ending) const;

  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

// A folder below another for files that are being made, gone with its object. Those of programs that were killed are
// removed by the next that makes one beside them.
class WorkFolder {
 public:
  // Makes that too, for its owner alone whatever the umask; throws std::runtime_error.
  explicit WorkFolder(const std::string& beside);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
  int lock_ = -1;  // held as long as the program lives
};

// Whether the folder is there, or could be made for its owner alone, and files can be made in it.
bool can_be_private(const std::string& folder);

// A folder that nobody else may write to, made where there is none. Throws std::runtime_error where it is another's.
void require_private_folder(const std::string& folder);

}  // namespace soft_robot_lab
