// SPDX-License-Identifier: BSD-3-Clause
// "VTK File Formats", https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#include "read_vtk.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

enum CellType {
  vertex = 1,
  poly_vertex,
  line,
  poly_line,
  triangle,
  tet = 10,
  quadratic_edge = 21,
  quadratic_triangle,
  quadratic_tet = 24
};

enum class Number { real, whole, text };
struct NumberType {
  Number kind;
  size_t bytes;
};

const std::map<std::string, NumberType>& number_types() {
  static const std::map<std::string, NumberType> types = {{"FLOAT", {Number::real, 4}},
                                                          {"DOUBLE", {Number::real, 8}},
                                                          {"INT", {Number::whole, 4}},
                                                          {"UNSIGNED_INT", {Number::whole, 4}},
                                                          {"LONG", {Number::whole, 8}},
                                                          {"UNSIGNED_LONG", {Number::whole, 8}},
                                                          {"VTKIDTYPE", {Number::whole, 4}},
                                                          {"VTKTYPEINT64", {Number::whole, 8}},
                                                          {"VTKTYPEINT32", {Number::whole, 4}},
                                                          {"SHORT", {Number::whole, 2}},
                                                          {"UNSIGNED_SHORT", {Number::whole, 2}},
                                                          {"CHAR", {Number::whole, 1}},
                                                          {"UNSIGNED_CHAR", {Number::whole, 1}}};
  return types;
}

// Binary numbers are stored with the highest byte first.
uint64_t big_endian(const char* bytes, size_t count) {
  uint64_t value = 0;
  for (size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

double decode(const char* bytes, NumberType type) {
  const uint64_t bits = big_endian(bytes, type.bytes);
  if (type.kind == Number::whole) {
    const int unused = 64 - static_cast<int>(8 * type.bytes);
    return static_cast<double>(static_cast<int64_t>(bits << unused) >> unused);
  }
  if (type.bytes == 8) {
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  float value;
  const auto word = static_cast<uint32_t>(bits);
  std::memcpy(&value, &word, sizeof value);
  return value;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

class VtkReader {
 public:
  explicit VtkReader(const std::string& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    content << file.rdbuf();
    content_ = content.str();
    if (line().rfind("# vtk DataFile", 0) != 0) fail("not a VTK file: it must start with '# vtk DataFile'");
    line();  // title
    const std::string format = keyword();
    if (format != "ASCII" && format != "BINARY") fail("'" + format + "' is not one of ASCII, BINARY");
    binary_ = format == "BINARY";
  }

  std::string line() {
    const size_t end = std::min(content_.find('\n', at_), content_.size());
    std::string text = content_.substr(at_, end - at_);
    at_ = std::min(end + 1, content_.size());
    return text;
  }

  // Empty at the end of the file.
  std::string word() {
    constexpr const char* blanks = " \t\r\n";
    const size_t begin = std::min(content_.find_first_not_of(blanks, at_), content_.size());
    at_ = std::min(content_.find_first_of(blanks, begin), content_.size());
    return content_.substr(begin, at_ - begin);
  }

  // In capitals: VTK takes capitals and small letters for the same.
  std::string keyword() { return upper(word()); }

  std::string peek_keyword() {
    const size_t before = at_;
    const std::string found = keyword();
    at_ = before;
    return found;
  }

  size_t count() {
    const std::string text = word();
    size_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // Each number takes at least a byte, which bounds what a damaged file can ask for.
    if (error != std::errc() || stop != text.data() + text.size() || value > content_.size()) {
      fail("'" + text + "' is not a number of entries that this file can hold");
    }
    return value;
  }

  // The numbers that follow the rest of this line.
  std::vector<double> numbers(size_t count, const std::string& type_name) {
    const auto type = number_types().find(upper(type_name));
    if (type == number_types().end()) fail("numbers of type '" + type_name + "' are not read here");
    if (count > 3 * content_.size()) fail("the file ends too early");
    std::vector<double> values;
    values.reserve(count);
    if (!binary_) {
      for (size_t i = 0; i < count; ++i) values.push_back(text_number());
      return values;
    }
    line();
    const size_t bytes = type->second.bytes;
    if (count > (content_.size() - at_) / bytes) fail("the file ends too early");
    for (size_t i = 0; i < count; ++i, at_ += bytes) values.push_back(decode(&content_[at_], type->second));
    return values;
  }

  [[noreturn]] void fail(const std::string& message) const {
    const auto lines = std::count(content_.begin(), content_.begin() + static_cast<long>(at_), '\n') + 1;
    throw std::invalid_argument(path_ + (binary_ ? "" : ":" + std::to_string(lines)) + ": " + printable(message));
  }

 private:
  double text_number() {
    const std::string text = word();
    if (text.empty()) fail("the file ends too early");
    const std::optional<double> value = parse_number<double>(text);
    if (!value || !std::isfinite(*value)) fail("'" + text + "' is not a finite number");
    return *value;
  }

  std::string path_, content_;
  size_t at_ = 0;
  bool binary_ = false;
};

const std::map<int, std::string>& cell_names() {
  static const std::map<int, std::string> names = {{9, "quadrilateral"}, {11, "voxel"},
                                                   {12, "hexahedron"},   {13, "wedge"},
                                                   {14, "pyramid"},      {25, "hexahedron of 20 nodes"}};
  return names;
}

struct Grid {
  std::vector<double> points;
  std::vector<double> offsets, connectivity;  // cell i has connectivity[offsets[i]] to connectivity[offsets[i + 1]]
  std::vector<double> types;
};

// Before version 5 each cell was its number of points and their indices.
void read_old_cells(VtkReader& reader, size_t cells, size_t size, Grid& grid) {
  const std::vector<double> list = reader.numbers(size, "int");
  grid.offsets = {0};
  size_t at = 0;
  for (size_t cell = 0; cell < cells; ++cell) {
    if (at >= list.size() || list[at] < 0 || list[at] > static_cast<double>(list.size() - at - 1)) {
      reader.fail("cell " + std::to_string(cell) + " does not fit into CELLS");
    }
    const auto nodes = static_cast<size_t>(list[at]);
    const auto first = list.begin() + static_cast<long>(at) + 1;
    grid.connectivity.insert(grid.connectivity.end(), first, first + static_cast<long>(nodes));
    grid.offsets.push_back(static_cast<double>(grid.connectivity.size()));
    at += nodes + 1;
  }
}

void read_cells(VtkReader& reader, Grid& grid) {
  const size_t first = reader.count(), second = reader.count();
  if (reader.peek_keyword() != "OFFSETS") return read_old_cells(reader, first, second, grid);
  reader.word();
  grid.offsets = reader.numbers(first, reader.word());
  if (reader.keyword() != "CONNECTIVITY") reader.fail("expected CONNECTIVITY after OFFSETS");
  grid.connectivity = reader.numbers(second, reader.word());
}

void skip_fields(VtkReader& reader) {
  reader.word();
  for (size_t left = reader.count(); left > 0; --left) {
    reader.word();
    const size_t components = reader.count(), tuples = reader.count();
    reader.numbers(components * tuples, reader.word());
  }
}

void skip_metadata(VtkReader& reader) {
  reader.line();
  while (reader.line().find_first_not_of(" \t\r") != std::string::npos) {
  }
}

Grid read_grid(VtkReader& reader) {
  Grid grid;
  if (reader.keyword() != "DATASET") reader.fail("expected DATASET UNSTRUCTURED_GRID");
  if (const std::string kind = reader.keyword(); kind != "UNSTRUCTURED_GRID") {
    reader.fail("DATASET is '" + kind +
                "', must be UNSTRUCTURED_GRID: a mesh of tetrahedra, not a surface or an image");
  }
  for (std::string word = reader.keyword(); !word.empty(); word = reader.keyword()) {
    if (word == "POINTS") {
      const size_t count = reader.count();
      grid.points = reader.numbers(3 * count, reader.word());
    } else if (word == "CELLS") {
      read_cells(reader, grid);
    } else if (word == "CELL_TYPES") {
      grid.types = reader.numbers(reader.count(), "int");
    } else if (word == "FIELD") {
      skip_fields(reader);
    } else if (word == "METADATA") {
      skip_metadata(reader);
    } else if (word == "CELL_DATA" || word == "POINT_DATA") {
      break;  // values on the mesh, after all that describes it
    } else {
      reader.fail("'" + word + "' is not expected here");
    }
  }
  return grid;
}

// The point indices of one cell.
std::vector<int> cell_points(const VtkReader& reader, const Grid& grid, size_t cell) {
  const double begin = grid.offsets[cell], end = grid.offsets[cell + 1];
  const auto size = static_cast<double>(grid.connectivity.size()), points = static_cast<double>(grid.points.size() / 3);
  if (!(begin >= 0 && begin <= end && end <= size)) reader.fail("OFFSETS are wrong at cell " + std::to_string(cell));
  std::vector<int> nodes;
  for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
    const double point = grid.connectivity[i];
    if (!(point >= 0 && point < points && point == std::floor(point))) {
      reader.fail("cell " + std::to_string(cell) + " has a point that is out of range");
    }
    nodes.push_back(static_cast<int>(point));
  }
  return nodes;
}

std::vector<std::vector<int>> tetrahedra(const VtkReader& reader, const Grid& grid) {
  if (grid.offsets.size() != grid.types.size() + 1) reader.fail("CELLS and CELL_TYPES do not fit together");
  std::vector<std::vector<int>> tets;
  for (size_t cell = 0; cell < grid.types.size(); ++cell) {
    if (!(grid.types[cell] >= 0 && grid.types[cell] < 256)) reader.fail("a cell type is out of range");
    const int type = static_cast<int>(grid.types[cell]);
    const bool side = (type >= vertex && type <= triangle) || type == quadratic_edge || type == quadratic_triangle;
    if (side) continue;
    if (type != tet && type != quadratic_tet) {
      const auto name = cell_names().find(type);
      reader.fail("cell " + std::to_string(cell) + " is a " +
                  (name == cell_names().end() ? "cell of type " + std::to_string(type) : name->second) +
                  ", not a tetrahedron of 4 or 10 nodes; mesh the body anew with tetrahedra");
    }
    std::vector<int> nodes = cell_points(reader, grid, cell);
    if (nodes.size() != (type == tet ? 4u : 10u))
      reader.fail("cell " + std::to_string(cell) + " has a wrong point count");
    if (type == quadratic_tet) std::swap(nodes[8], nodes[9]);  // VTK has edge 13 before 23
    if (!tets.empty() && tets[0].size() != nodes.size()) reader.fail("tetrahedra of 4 and of 10 nodes are mixed");
    tets.push_back(std::move(nodes));
  }
  if (tets.empty()) reader.fail("the file holds no tetrahedra");
  return tets;
}

}  // namespace

TetMesh read_vtk(const std::string& path) {
  VtkReader reader(path);
  const Grid grid = read_grid(reader);
  const std::vector<std::vector<int>> tets = tetrahedra(reader, grid);
  std::vector<int> index(grid.points.size() / 3, -1);
  for (const auto& nodes : tets) {
    for (const int node : nodes) index[static_cast<size_t>(node)] = 0;
  }
  int count = 0;
  TetMesh mesh;
  mesh.nodes_m.resize(3, static_cast<Eigen::Index>(index.size()));
  for (size_t point = 0; point < index.size(); ++point) {
    if (index[point] < 0) continue;
    mesh.nodes_m.col(count) = Eigen::Vector3d::Map(&grid.points[3 * point]);
    if (!mesh.nodes_m.col(count).allFinite()) reader.fail("point " + std::to_string(point) + " is not finite");
    index[point] = count++;
  }
  mesh.nodes_m.conservativeResize(Eigen::NoChange, count);
  mesh.tets.resize(static_cast<Eigen::Index>(tets[0].size()), static_cast<Eigen::Index>(tets.size()));
  for (Eigen::Index i = 0; i < mesh.tets.cols(); ++i) {
    for (Eigen::Index j = 0; j < mesh.tets.rows(); ++j) {
      mesh.tets(j, i) = index[static_cast<size_t>(tets[static_cast<size_t>(i)][static_cast<size_t>(j)])];
    }
  }
  mesh.faces.resize(mesh.quadratic() ? 6 : 3, 0);
  return mesh;
}

}  // namespace soft_robot_lab
