// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/design/mesher.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

#include "content_cache.h"
#include "content_hash.h"
#include "mesher_run.h"
#include "timed_process.h"
#include "settings/find_program.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// Part of every cache key: raise it when mesh_robot makes something else of the same request.
constexpr const char* kMesherVersion = "soft_robot_lab mesh 7";
constexpr const char* kEnding = ".msh";

void check_size(const std::string& key, double value) {
  if (std::isfinite(value) && value > 0) return;
  throw std::invalid_argument(key + ": " + std::to_string(value) + " is out of range (0, inf)");
}

void check_request(const MeshRequest& request) {
  if (request.solid.has_value() != request.mesh_file.empty()) {
    throw std::invalid_argument("a mesh request needs either a solid or a mesh file");
  }
  check_size("element_size_m", request.element_size_m);
  check_size("mesh_unit_m", request.mesh_unit_m);
  for (const MeshRefinement& refinement : request.refinements) {
    check_size("refinements: size_m", refinement.size_m);
    if (!refinement.surface.empty()) continue;
    check_size("refinements: radius_m", refinement.radius_m);
    if (!refinement.center_m.allFinite()) throw std::invalid_argument("refinements: center_m is not finite");
  }
}

// What mesh_robot reads.
std::string request_text(const MeshRequest& request) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  if (!request.mesh_file.empty()) {
    text << "mesh_file: " << quote(fs::absolute(request.mesh_file)) << "\n";
    if (request.mesh_unit_m != 1.0) text << "scale: " << request.mesh_unit_m << "\n";
    return text.str();
  }
  text << "solid: " << to_yaml(*request.solid) << "\nelement_size_m: " << request.element_size_m
       << "\nquadratic: " << (request.quadratic ? "true" : "false")
       << "\nrefinements:" << (request.refinements.empty() ? " []" : "") << "\n";
  for (const MeshRefinement& r : request.refinements) {
    if (!r.surface.empty()) {
      text << "- {" << (r.edges_only ? "edges_of" : "surface") << ": " << quote(r.surface) << ", size_m: " << r.size_m
           << "}\n";
      continue;
    }
    text << "- {center_m: [" << r.center_m.x() << ", " << r.center_m.y() << ", " << r.center_m.z()
         << "], radius_m: " << r.radius_m << ", size_m: " << r.size_m << "}\n";
  }
  for (std::size_t i = 0; i < request.regions.size(); ++i)
    text << (i == 0 ? "regions: [" : ", ") << quote(request.regions[i])
         << (i + 1 == request.regions.size() ? "]\n" : "");
  return text.str();
}

void collect_files(const Solid& solid, std::vector<std::string>& files) {
  if (!solid.file.empty()) files.push_back(solid.file);
  for (const Solid& part : solid.parts) collect_files(part, files);
}

std::string cache_key(const std::string& text, const std::vector<std::string>& files) {
  ContentHash hash;
  hash.add(kMesherVersion);
  hash.add(text);
  for (const std::string& name : files) {
    const std::string content = read_regular_file(name, kLargestMesh_bytes);
    if (content.empty()) throw std::invalid_argument(name + ": is empty");
    hash.add(content);
  }
  return hash.hex();
}

std::string find_mesher(const MesherOptions& options) {
  if (!options.program.empty()) {
    if (is_program(options.program)) return fs::absolute(options.program);
    throw std::runtime_error("mesher: '" + options.program + "' is not a program");
  }
  const std::string found = find_program("mesh_robot");
  if (found.empty()) throw std::runtime_error("mesh_robot was found neither in " + program_folder() + " nor on PATH");
  return found;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text;
}

bool ends_with_stl(const std::string& file) {
  const std::string ending = fs::path(file).extension();
  return ending == ".stl" || ending == ".STL";
}

void require_success(const ProcessEnd& end, const std::string& words, const std::vector<std::string>& files,
                     const MesherOptions& options) {
  std::ostringstream what;
  switch (end.kind) {
    case ProcessEnd::Kind::timed_out:
      if (!files.empty()) what << files[0] << ": ";
      what << "meshing took longer than " << options.time_limit_s
           << " s and was stopped; a larger element_size_m is faster";
      if (std::any_of(files.begin(), files.end(), ends_with_stl)) what << ", and so is STEP instead of STL";
      throw std::runtime_error(what.str());
    case ProcessEnd::Kind::interrupted:
      throw std::runtime_error("meshing was interrupted");
    case ProcessEnd::Kind::signalled:
      what << "the mesher was ended by signal " << end.value << (words.empty() ? "" : ": ") << words;
      throw std::runtime_error(what.str());
    case ProcessEnd::Kind::exited:
      if (end.value == 0) return;
      if (end.value == 2) throw std::invalid_argument(words);
      // On a full disk its words are lost too.
      if (end.value == 1 && (words.empty() || words.find("cannot be written") != std::string::npos))
        throw WriteError(words);
      what << "the mesher failed with status " << end.value << (words.empty() ? "" : ": ") << words;
      throw std::runtime_error(what.str());
  }
}

void mesh_into(const std::string& output, const std::string& text, const std::vector<std::string>& files,
               const WorkFolder& work, const MesherOptions& options) {
  const std::string request_file = work.file("request.yaml"), errors = work.file("errors");
  write_file(request_file, text);
  const ProcessEnd end =
      run_with_limit({find_mesher(options), request_file, output}, errors, options.time_limit_s, options.interrupt);
  require_success(end, read_text(errors), files, options);
  if (!fs::is_regular_file(output)) throw std::runtime_error("the mesher ended without a mesh");
}

// Its words name a file that its user never named.
[[noreturn]] void refuse_cache(const std::string& folder, const std::string& words) {
  const std::size_t colon = words.rfind(": ");
  throw WriteError(folder + ": the mesh cannot be kept there: " +
                   (colon == std::string::npos ? std::strerror(ENOSPC) : words.substr(colon + 2)) +
                   "; make space, or set XDG_CACHE_HOME to another folder");
}

}  // namespace

std::string cache_folder(const MesherOptions& options) {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (!options.cache_folder.empty()) return options.cache_folder;
  if (fs::path(variable("XDG_CACHE_HOME")).is_absolute())
    return fs::path(variable("XDG_CACHE_HOME")) / "soft_robot_lab";
  // A service's user, or one that was changed to without its home, may write nothing at HOME.
  const std::string at_home = fs::path(variable("HOME")) / ".cache" / "soft_robot_lab";
  if (!variable("HOME").empty() && can_be_private(at_home)) return at_home;
  // Else there is only a folder that all users share: ours in it must be ours.
  const std::string own = fs::temp_directory_path() / ("soft_robot_lab_" + std::to_string(geteuid()));
  require_private_folder(own);
  return own;
}

std::vector<std::string> referenced_files(const Solid& solid) {
  std::vector<std::string> files;
  collect_files(solid, files);
  return files;
}

std::string run_mesher(const std::string& text, const std::vector<std::string>& files, const std::string& ending,
                       const MesherOptions& options) {
  check_size("time_limit_s", options.time_limit_s);
  const std::string key = cache_key(text, files);
  const ContentCache cache(cache_folder(options));
  if (const std::string found = cache.find(key, ending); !found.empty()) return found;

  const WorkFolder work(cache.folder());
  const std::string output = work.file("output" + ending);
  try {
    mesh_into(output, text, files, work, options);
  } catch (const WriteError& error) {
    refuse_cache(cache.folder(), error.what());
  }
  return cache.keep(output, key, ending);
}

std::string mesh_file_for(const MeshRequest& request, const MesherOptions& options) {
  check_request(request);
  const std::vector<std::string> files =
      request.solid ? referenced_files(*request.solid) : std::vector<std::string>{request.mesh_file};
  return run_mesher(request_text(request), files, kEnding, options);
}

}  // namespace soft_robot_lab
