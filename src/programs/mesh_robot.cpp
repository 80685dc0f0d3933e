// SPDX-License-Identifier: BSD-3-Clause
// mesh_robot REQUEST.yaml OUTPUT.msh
//
// Meshes a solid, or rewrites a mesh file, as MSH 2.2 text with named surfaces and regions. The request holds either
//   solid: {...}                         see design/solid.h
//   element_size_m: 0.01
//   quadratic: true
//   refinements: [{center_m: [x, y, z], radius_m: r, size_m: s}, {surface: NAME, size_m: s}, {edges_of: NAME, size_m:
//   s}]
//   regions: [NAME, ...]                 named solids whose elements are groups of their own
// or
//   mesh_file: robot.msh                 .msh of any version or .vtk; elements, node order and surface names are kept
//   scale: 0.001                         length of the file's unit in metres; 1 where it is left out
//   import: true                         as import_mesh.py reads it, see mesher/import_mesh.h
// or
//   solid: {...}
//   surface: {largest_edge_m: 0.002, circle_segments: 48}     writes the boundary alone, see design/surface_file.h;
//                                        or edges_across, of the box's diagonal, in place of the largest edge
// or
//   solid: {...}
//   step: true                           writes STEP; the output's name ends with .step
// The same request gives the same file, byte by byte. Exit status: 0 done, 1 internal fault, 2 bad request; the reason
// is one line on standard error. A line about the mesh goes to standard output.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <gmsh.h>

#include "programs/mesher/confine.h"
#include "programs/mesher/convert_mesh.h"
#include "programs/mesher/import_mesh.h"
#include "programs/mesher/input_files.h"
#include "programs/mesher/mesh_solid.h"
#include "programs/mesher/solid_surface.h"
#include "programs/mesher/write_msh.h"
#include "robot/design/mesh_quality.h"
#include "settings/command_line.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace {

using namespace soft_robot_lab;

// In what follows a file's content may do whatever it wants.
void confine_beside(const std::string& output_file) {
  confine_to(std::filesystem::absolute(output_file).parent_path());
}

// Errors begin with the user's own file.
template <typename Read>
auto naming(const std::string& file, const Read& read) {
  const auto named = [&](const std::string& what) {
    return std::invalid_argument(what.rfind(file, 0) == 0 ? what : file + ": " + what);
  };
  try {
    return read();
  } catch (const std::invalid_argument& error) {
    throw named(error.what());
  } catch (const std::string& error) {
    throw named("cannot be read: " + error);
  }
}

// Says, a word each, what was done to the mesh.
TetMesh import_request(const std::string& file, double unit_m) {
  ImportedMesh imported = import_mesh(file, unit_m);
  std::cout << "turned " << imported.turned << "\njoined " << imported.joined << "\n";
  for (const std::string& hollow : imported.hollows) std::cout << "hollow " << hollow << "\n";
  return std::move(imported.mesh);
}

TetMesh file_request(const YamlNode& request, const std::string& output_file, InputFiles& files) {
  const std::string file = request.text("mesh_file");
  const double unit_m = request.number_or("scale", 1.0, AllowedRange::positive());
  const bool import = request.boolean_or("import", false);
  request.require_all_read();
  naming(file, [&] { require_mesh_ending(file); });
  const std::string copy = files.copy(file, has_ending_of(file, MeshFormat::vtk) ? MeshFormat::vtk : MeshFormat::msh);
  confine_beside(output_file);
  return naming(copy, [&] { return import ? import_request(copy, unit_m) : convert_mesh(copy, unit_m); });
}

TetMesh mesh_request(const YamlNode& request, const std::string& output_file, InputFiles& files) {
  if (request.has("mesh_file")) return file_request(request, output_file, files);
  Solid solid = read_solid(request.child("solid"));
  MeshSizes sizes;
  sizes.element_size_m = request.number("element_size_m", AllowedRange::positive());
  sizes.quadratic = request.boolean_or("quadratic", true);
  for (const YamlNode& node : request.optional_sequence("refinements")) {
    sizes.refinements.push_back(read_mesh_refinement(node));
  }
  std::vector<std::string> regions;
  for (const YamlNode& name : request.optional_sequence("regions")) regions.push_back(name.as_text());
  request.require_all_read();
  files.copy_into(solid);
  confine_beside(output_file);
  return mesh_solid(solid, sizes, regions);
}

void surface_request(const YamlNode& request, const std::string& output_file, InputFiles& files) {
  Solid solid = read_solid(request.child("solid"));
  const YamlNode node = request.child("surface");
  SurfaceSizes sizes;
  if (node.has("edges_across"))
    sizes.edges_across = node.number("edges_across", AllowedRange::positive());
  else
    sizes.largest_edge_m = node.number("largest_edge_m", AllowedRange::positive());
  sizes.circle_segments = node.integer("circle_segments", 6, 360);
  sizes.smallest_edge_m = node.number_or("smallest_edge_m", 0, AllowedRange::not_negative());
  request.require_all_read();
  files.copy_into(solid);
  confine_beside(output_file);
  write_surface(solid, sizes, output_file);
}

void step_request(const YamlNode& request, const std::string& output_file, InputFiles& files) {
  Solid solid = read_solid(request.child("solid"));
  request.boolean_or("step", true);
  request.require_all_read();
  files.copy_into(solid);
  confine_beside(output_file);
  write_step(solid, output_file);
}

void answer(const YamlNode& request, const std::string& output_file, InputFiles& files) {
  if (request.has("surface")) return surface_request(request, output_file, files);
  if (request.has("step")) return step_request(request, output_file, files);
  write_msh(mesh_request(request, output_file, files), output_file);
  const TetMesh mesh = read_msh(output_file);  // exactly what the simulation will see
  check_mesh(mesh);
  const MeshQuality quality = measure_quality(mesh.nodes_m, mesh.tets);
  std::cout << "elements " << mesh.tet_count() << " nodes " << mesh.node_count() << " quality_min " << quality.min
            << " quality_mean " << quality.mean << std::endl;
}

void run(const std::string& request_file, const std::string& output_file) {
  const YamlNode request = YamlNode::load_file(request_file);
  InputFiles files(output_file);
  try {
    answer(request, output_file, files);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(files.in_users_names(error.what()));
  } catch (const std::string& error) {
    throw files.in_users_names(error);
  }
}

int report(int status, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cerr << message << std::endl;
  return status;
}

std::string in_our_words(const std::string& error) {
  const auto says = [&](const char* words) { return error.find(words) != std::string::npos; };
  // The kernel of shapes says no more than that it failed.
  if (says("OpenCASCADE") || says("Standard_"))
    return "the solid cannot be built: a part of it is below 1e-9 m, or parts meet in a line or a point (" + error +
           ")";
  if (says("PLC Error") || says("overlapping facets"))
    return "triangles of this size on its surface cross one another, as a wall or a gap of it is thinner than they are "
           "long; give a smaller element_size_m, or `refinements` there (Gmsh: " +
           error + ")";
  if (says("Unable to recover the edge"))
    return "lines of its surface cross one another; where a `fillet` rounds it, take a smaller radius_m, else give a "
           "smaller element_size_m (Gmsh: " +
           error + ")";
  return "Gmsh cannot mesh this: " + error;
}

// What is being handled, in a line; the program's status.
int report_what_was_thrown() {
  try {
    throw;
  } catch (const std::invalid_argument& error) {
    return report(2, error.what());
  } catch (const std::string& error) {
    return report(2, in_our_words(error));
  } catch (const std::exception& error) {
    return report(1, error.what());
  }
}

}  // namespace

// Asked for by the leak sanitiser, where the build has one: Gmsh and its kernel leave memory behind.
extern "C" const char* __lsan_default_suppressions() { return "leak:libgmsh\nleak:libTK\n"; }

int main(int argc, char** argv) {
  // Gmsh meshes faces in parallel, where what it throws can be caught by nobody.
  std::set_terminate([] {
    if (!std::current_exception()) std::abort();
    std::_Exit(report_what_was_thrown());
  });
  CommandLine app("Meshes a solid, or rewrites a mesh file, as MSH 2.2 text with named surfaces.", "mesh_robot");
  std::string request, output;
  app.add_option("REQUEST", request, "what to mesh, as mesh_robot.cpp describes it").type_name("YAML").required();
  app.add_option("OUTPUT", output, "the mesh").type_name("MSH").required();
  try {
    if (const std::optional<int> ended = app.read(argc, argv)) return *ended;
    run(request, output);
    return 0;
  } catch (...) {
    return report_what_was_thrown();
  }
}
