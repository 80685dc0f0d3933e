// SPDX-License-Identifier: BSD-3-Clause
// Gmsh's MSH 2.2 text format: https://gmsh.info/doc/texinfo/gmsh.html, "MSH file format version 2".
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <unordered_map>

#include "settings/words.h"
#include "tet_faces.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {
namespace {

// Element types of the format that a body may have.
enum ElementType { line2 = 1, triangle3 = 2, tet4 = 4, line3 = 8, triangle6 = 9, tet10 = 11, point = 15 };

// Reads words of one line at a time, and knows where it is.
class LineReader {
 public:
  explicit LineReader(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw std::invalid_argument(path + ": cannot be read");
  }

  bool next_line() {
    if (!std::getline(file_, text_)) return false;
    ++line_;
    rest_ = text_;
    return true;
  }
  void need_line() {
    if (!next_line()) fail("the file ends too early");
  }

  std::string_view word() {
    constexpr const char* blanks = " \t\r";
    const size_t begin = std::min(rest_.find_first_not_of(blanks), rest_.size());
    const size_t end = std::min(rest_.find_first_of(blanks, begin), rest_.size());
    const std::string_view found = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return found;
  }

  template <typename Number>
  Number number() {
    const std::string_view text = word();
    Number value{};
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || stop != text.data() + text.size() || !(value - value == Number{})) {
      fail("'" + std::string(text) + "' is not a finite number");
    }
    return value;
  }

  // The number of lines of a section, alone in its line.
  long count() {
    need_line();
    const long lines = number<long>();
    if (lines < 0) fail(std::to_string(lines) + " lines announced");
    return lines;
  }

  std::string quoted() {
    const size_t begin = rest_.find('"');
    const size_t end = rest_.rfind('"');
    if (begin == std::string_view::npos || end == begin) fail("a name must stand in double quotes");
    return std::string(rest_.substr(begin + 1, end - begin - 1));
  }

  void need_section_end(const std::string& section) {
    need_line();
    if (word() != "$End" + section) fail("expected $End" + section);
  }

  int line() const { return line_; }
  [[noreturn]] void fail(const std::string& message) const { fail_at(line_, message); }
  [[noreturn]] void fail_at(int line, const std::string& message) const {
    throw std::invalid_argument(path_ + ":" + std::to_string(line) + ": " + printable(message));
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::string text_;
  std::string_view rest_;
  int line_ = 0;
};

struct FileFace {
  int line;
  int physical;  // 0: of no named surface
  std::vector<int> nodes;
};

// The file as it stands, with node tags replaced by indices.
struct FileContent {
  std::vector<std::pair<int, std::string>> surface_names;  // physical tag, name
  std::map<int, std::string> region_names;                 // the same of volumes
  std::vector<Eigen::Vector3d> nodes_m;
  std::unordered_map<long, int> node_index;  // by tag
  std::vector<std::vector<int>> tets;
  std::vector<int> tet_physical;
  std::vector<FileFace> faces;
  bool has_format = false;
};

void read_format(LineReader& reader) {
  reader.need_line();
  const std::string version(reader.word());
  if (version.empty() || (version != "2" && version.rfind("2.", 0) != 0)) {
    reader.fail("MSH version '" + version + "' is not read here, only 2.2; mesh_robot rewrites other versions");
  }
  if (reader.word() != "0") reader.fail("binary MSH is not read here, only text; mesh_robot rewrites it");
}

void read_names(LineReader& reader, FileContent& content) {
  for (long left = reader.count(); left > 0; --left) {
    reader.need_line();
    const int dimension = reader.number<int>();
    const int tag = reader.number<int>();
    const std::string name = reader.quoted();
    if (dimension == 2) content.surface_names.emplace_back(tag, name);
    if (dimension == 3) content.region_names[tag] = name;
  }
}

void read_nodes(LineReader& reader, FileContent& content) {
  for (long left = reader.count(); left > 0; --left) {
    reader.need_line();
    const long tag = reader.number<long>();
    if (!content.node_index.emplace(tag, content.nodes_m.size()).second) {
      reader.fail("node " + std::to_string(tag) + " stands twice");
    }
    const double x = reader.number<double>(), y = reader.number<double>(), z = reader.number<double>();
    content.nodes_m.emplace_back(x, y, z);
  }
}

std::vector<int> read_node_indices(LineReader& reader, const FileContent& content, int count) {
  std::vector<int> nodes;
  for (int i = 0; i < count; ++i) {
    const long tag = reader.number<long>();
    const auto found = content.node_index.find(tag);
    if (found == content.node_index.end()) reader.fail("there is no node " + std::to_string(tag));
    nodes.push_back(found->second);
  }
  return nodes;
}

void read_element(LineReader& reader, FileContent& content) {
  reader.number<long>();
  const int type = reader.number<int>();
  const int tag_count = reader.number<int>();
  int physical = 0;
  for (int i = 0; i < tag_count; ++i) {
    const int tag = reader.number<int>();
    if (i == 0) physical = tag;
  }
  switch (type) {
    case point:
    case line2:
    case line3:
      return;
    case triangle3:
    case triangle6:
      content.faces.push_back({reader.line(), physical, read_node_indices(reader, content, type == triangle3 ? 3 : 6)});
      return;
    case tet4:
    case tet10: {
      const std::vector<int> nodes = read_node_indices(reader, content, type == tet4 ? 4 : 10);
      if (!content.tets.empty() && content.tets[0].size() != nodes.size()) {
        reader.fail("elements of 4 and of 10 nodes are mixed");
      }
      content.tets.push_back(nodes);
      content.tet_physical.push_back(physical);
      return;
    }
    default:
      reader.fail("element type " + std::to_string(type) + " is not a tetrahedron of 4 or 10 nodes or a side of one");
  }
}

void skip_section(LineReader& reader, const std::string& section) {
  do {
    reader.need_line();
  } while (reader.word() != "$End" + section);
}

FileContent read_content(LineReader& reader) {
  FileContent content;
  while (reader.next_line()) {
    const std::string word(reader.word());
    if (word.empty()) continue;
    if (word[0] != '$') reader.fail("expected a section, found '" + word + "'");
    const std::string section = word.substr(1);
    if (!content.has_format && section != "MeshFormat") reader.fail("expected $MeshFormat first: not an MSH file");
    if (section == "MeshFormat") {
      read_format(reader);
      content.has_format = true;
    } else if (section == "PhysicalNames") {
      read_names(reader, content);
    } else if (section == "Nodes") {
      read_nodes(reader, content);
    } else if (section == "Elements") {
      for (long left = reader.count(); left > 0; --left) {
        reader.need_line();
        read_element(reader, content);
      }
    } else {
      skip_section(reader, section);
      continue;
    }
    reader.need_section_end(section);
  }
  if (content.tets.empty()) reader.fail("the file holds no tetrahedra");
  return content;
}

// Named faces, turned outward. Faces of no physical group are left to complete_boundary().
void add_surfaces(const FileContent& content, const LineReader& reader, TetMesh& mesh) {
  std::map<int, std::string> names(content.surface_names.begin(), content.surface_names.end());
  std::map<int, int> surface_of;  // by physical tag
  const auto surface = [&](int tag) {
    const auto [at, is_new] = surface_of.emplace(tag, static_cast<int>(mesh.surface_names.size()));
    if (is_new) mesh.surface_names.push_back(names.count(tag) ? names[tag] : std::to_string(tag));
    return at->second;
  };
  for (const auto& [tag, name] : content.surface_names) {
    const auto carries = [tag = tag](const FileFace& face) { return face.physical == tag; };
    if (std::any_of(content.faces.begin(), content.faces.end(), carries)) surface(tag);
  }

  const TetSides sides(mesh);
  std::map<FaceKey, int> line_of;
  std::vector<Eigen::VectorXi> faces;
  for (const FileFace& face : content.faces) {
    if (face.physical == 0) continue;
    const FaceKey key = face_key(face.nodes[0], face.nodes[1], face.nodes[2]);
    const std::vector<TetSide> meeting = sides.meeting(key);
    if (meeting.empty()) reader.fail_at(face.line, "this triangle is no side of an element");
    if (meeting.size() > 1) reader.fail_at(face.line, "this triangle of a named surface lies inside the body");
    const Eigen::VectorXi nodes = meeting[0].nodes(mesh);
    if (std::set<int>(nodes.begin(), nodes.end()) != std::set<int>(face.nodes.begin(), face.nodes.end())) {
      reader.fail_at(face.line, "the mid-edge nodes of this triangle are not those of its element");
    }
    const auto [first, is_new] = line_of.emplace(key, face.line);
    if (!is_new)
      reader.fail_at(face.line, "this triangle stands in line " + std::to_string(first->second) + " already");
    faces.push_back(nodes);
    mesh.face_surface.push_back(surface(face.physical));
  }
  mesh.faces.resize(mesh.quadratic() ? 6 : 3, static_cast<Eigen::Index>(faces.size()));
  for (size_t i = 0; i < faces.size(); ++i) mesh.faces.col(static_cast<Eigen::Index>(i)) = faces[i];
}

// Elements of no physical group are a region without a name.
void add_regions(const FileContent& content, TetMesh& mesh) {
  mesh.regions.clear();
  std::map<int, int> region_of;  // by physical tag
  for (const int tag : content.tet_physical) {
    const auto [at, is_new] = region_of.emplace(tag, static_cast<int>(mesh.regions.size()));
    mesh.tet_region.push_back(at->second);
    if (!is_new) continue;
    const auto named = content.region_names.find(tag);
    mesh.regions.push_back({named != content.region_names.end() ? named->second : tag == 0 ? "" : std::to_string(tag)});
  }
  if (mesh.regions.size() == 1) mesh.tet_region.clear();
}

}  // namespace

TetMesh read_msh(const std::string& path) {
  LineReader reader(path);
  const FileContent content = read_content(reader);
  TetMesh mesh;
  mesh.nodes_m.resize(3, static_cast<Eigen::Index>(content.nodes_m.size()));
  for (size_t i = 0; i < content.nodes_m.size(); ++i)
    mesh.nodes_m.col(static_cast<Eigen::Index>(i)) = content.nodes_m[i];
  mesh.tets.resize(static_cast<Eigen::Index>(content.tets[0].size()), static_cast<Eigen::Index>(content.tets.size()));
  for (size_t i = 0; i < content.tets.size(); ++i) {
    mesh.tets.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXi>(content.tets[i].data(), mesh.tets.rows());
  }
  add_regions(content, mesh);
  add_surfaces(content, reader, mesh);
  complete_boundary(mesh);
  return mesh;
}

}  // namespace soft_robot_lab
