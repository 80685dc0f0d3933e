// SPDX-License-Identifier: BSD-3-Clause
#include "bad_files.h"

#include <cstdint>
#include <cstring>
#include <functional>
#include <random>
#include <utility>

#include "robot/rollouts/npz.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

using Words = std::vector<std::string>;
using Damage = std::function<std::string(const std::string& good, std::mt19937& random)>;

const std::string& one_of(const Words& words, std::mt19937& random) { return words[random() % words.size()]; }

// A bar of linear elements, quick to mesh and to solve. A mesh file has its own size of elements.
std::string bar(const std::string& shape, const std::string& more = "") {
  const std::string size = shape.rfind("mesh:", 0) == 0 ? "" : ", element_size_m: 0.03";
  return "body: {" + shape + ", element: linear" + size +
         ", material: {poissons_ratio: 0.3}, fixed: [{box: {min_m: [-9, -9, -9], max_m: [9, 9, 1.0e-6]}}]}\n"
         "gravity_m_s2: [0, 0, -9.81]\n" +
         more;
}

const std::string kBox = "solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, 0.03]}}";

// Scripts that Gmsh, a shell or Python would run.
const Words kScripts = {"SystemCall \"touch it_was_run\";\n",
                        "SystemCall(\"touch it_was_run\");\n",
                        "Merge \"good.msh\";\nSystemCall \"touch it_was_run\";\n",
                        "NonBlockingSystemCall \"touch it_was_run\";\n",
                        "Print Sprintf(\"ran\") > \"it_was_run\";\n",
                        "Save \"it_was_run\";\n",
                        "#!/bin/sh\ntouch it_was_run\n",
                        "import os\nos.system('touch it_was_run')\n"};
const Words kBefore = {"",
                       "\n",
                       " ",
                       "\xef\xbb\xbf",
                       "// a comment\n",
                       "/* */",
                       "solid a\n",
                       "$MeshFormat\n",
                       "# vtk DataFile Version 3.0\n",
                       "ISO-10303-21;\n"};
const Words kEndings = {".msh",  ".MSH", ".msh2", ".vtk", ".stl", ".STL", ".obj",
                        ".step", ".stp", ".geo",  ".txt", "",     ".py"};

// Every way by which a file of a shape comes in: a robot's mesh or part, an obstacle, and import_mesh.py.
const Words kDoors = {"mesh", "stl", "step", "obstacle", "import"};

BadScene by_door(const std::string& door, const std::string& file, const std::string& content,
                 const std::string& what) {
  BadScene bad{what + " as " + door + ": " + file, "", {{file, content}}, ""};
  if (door == "import") {
    bad.text = "mesh_file: " + file + "\nscale: 1.0\nimport: true\n";
    bad.request = true;
  } else if (door == "obstacle") {
    bad.text = bar(kBox, "contact: {obstacles: [{name: a, mesh: " + file + ", position_m: [0, 0, 1]}]}\n");
  } else {
    bad.text = bar(door == "mesh" ? "mesh: " + file : "solid: {" + door + ": " + file + "}");
  }
  return bad;
}

void add_scripts(std::mt19937& random, std::vector<BadScene>& all) {
  for (const std::string& ending : kEndings)
    for (const std::string& door : kDoors) {
      const std::string script = one_of(kBefore, random) + one_of(kScripts, random);
      all.push_back(by_door(door, "part" + ending, script, "a script, " + quote(script)));
    }
}

const std::string kVtk =
    "# vtk DataFile Version 3.0\na bar\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n0.04 0 0\n0 0.05 "
    "0\n0 0 "
    "0.06\n0.03 0.03 0.03\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
const std::string kMsh =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 0.04 0 0\n3 0 0.05 0\n4 0 0 0.06\n5 0.03 0.03 0.03\n"
    "$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 2 3 4 5\n$EndElements\n";

const std::string kVtk51 =
    "# vtk DataFile Version 5.1\na bar\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n0.04 0 0\n0 0.05 "
    "0\n0 0 0.06\n0.03 0.03 0.03\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\n"
    "CELL_TYPES 2\n10\n10\n";
const std::string kMsh41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 0.04 0.05 0.06 0 0\n$EndEntities\n$Nodes\n1 5 1 "
    "5\n3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n0.04 0 0\n0 0.05 0\n0 0 0.06\n0.03 0.03 0.03\n$EndNodes\n$Elements\n1 2 1 2\n3 "
    "1 "
    "4 2\n1 1 2 3 4\n2 2 3 4 5\n$EndElements\n";

const std::vector<std::vector<std::size_t>> kSides = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

std::string binary_stl() {
  const float corners[4][3] = {{0.0f, 0.0f, 0.0f}, {0.04f, 0.0f, 0.0f}, {0.0f, 0.05f, 0.0f}, {0.0f, 0.0f, 0.06f}};
  std::string text(80, ' ');
  const auto add = [&](const void* bytes, std::size_t count) { text.append(static_cast<const char*>(bytes), count); };
  const auto count = static_cast<std::uint32_t>(kSides.size());
  add(&count, 4);
  for (const auto& side : kSides) {
    text.append(12, '\0');  // its normal
    for (const std::size_t corner : side) add(corners[corner], 12);
    text.append(2, '\0');
  }
  return text;
}

std::string tetrahedron_stl() {
  const Words corners = {"0 0 0", "0.04 0 0", "0 0.05 0", "0 0 0.06"};
  std::string text = "solid a\n";
  for (const auto& side : kSides) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::size_t corner : side) text += "vertex " + corners[corner] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid a\n";
}

std::string cut_off(const std::string& good, std::mt19937& random) { return good.substr(0, random() % good.size()); }

std::string with_other_bytes(const std::string& good, std::mt19937& random) {
  std::string bad = good;
  for (int i = 0; i < 3; ++i) bad[random() % bad.size()] = static_cast<char>(random() % 256);
  return bad;
}

// A word between blanks becomes a bad number.
std::string with_a_bad_word(const std::string& good, std::mt19937& random) {
  const Words bad = {"nan", "inf", "-1", "0", "1e300", "1e-300", "4294967295", "-2147483649", "99999999999999999999",
                     "x"};
  const std::size_t end = good.find_first_of(" \n", random() % good.size());
  if (end == std::string::npos) return good + one_of(bad, random);
  const std::size_t next = good.find_first_of(" \n", end + 1);
  return good.substr(0, end + 1) + one_of(bad, random) + (next == std::string::npos ? "" : good.substr(next));
}

std::string with_a_doubled_line(const std::string& good, std::mt19937& random) {
  const std::size_t start = good.find('\n', random() % good.size());
  if (start == std::string::npos) return good + good;
  const std::size_t end = good.find('\n', start + 1);
  return good.substr(0, end) + good.substr(start);
}

const std::vector<std::pair<std::string, Damage>> kDamages = {{"cut off", cut_off},
                                                              {"three other bytes", with_other_bytes},
                                                              {"a bad word", with_a_bad_word},
                                                              {"a line twice", with_a_doubled_line}};

void add_meshes(std::mt19937& random, std::vector<BadScene>& all) {
  const std::vector<std::pair<std::string, std::string>> good = {
      {"part.vtk", kVtk},         {"part.msh", kMsh},        {"part.stl", tetrahedron_stl()},
      {"version_51.vtk", kVtk51}, {"format_41.msh", kMsh41}, {"binary.stl", binary_stl()}};
  for (const auto& [file, text] : good) {
    const bool surface = file.find(".stl") != std::string::npos;
    for (const std::string door : {surface ? "stl" : "mesh", surface ? "obstacle" : "import"}) {
      all.push_back(by_door(door, file, text, "nothing wrong"));
      all.back().sound = true;
      for (const auto& [damage, apply] : kDamages)
        for (int i = 0; i < 8; ++i)
          all.push_back(by_door(door, file, apply(text, random), damage + ", " + std::to_string(i)));
    }
  }
}

std::string with_a_bad_length(const std::string& good, std::mt19937& random) {
  const std::uint32_t lengths[] = {0, 1, 1000, 0x7fffffff, 0xffffffff, 400000000};
  std::string bad = good;
  const std::uint32_t length = lengths[random() % 6];
  std::memcpy(&bad[random() % (bad.size() - 4)], &length, 4);
  return bad;
}

void add_archives(std::mt19937& random, std::vector<BadScene>& all) {
  const std::string scene =
      bar(kBox, "cables: [{name: left, path_m: [[0.005, 0, 0], [0.005, 0, 0.05]], plug_radius_m: 0.002}]\n");
  const std::string good = npz({numbers_array("left", {2, 2}, {1.0, 0.95, 1.0, 0.97})});
  std::vector<std::pair<std::string, Damage>> damages = {kDamages[0], kDamages[1]};
  damages.emplace_back("a bad length", with_a_bad_length);
  for (const auto& [damage, apply] : damages)
    for (int i = 0; i < 12; ++i)
      all.push_back({"npz: " + damage + ", " + std::to_string(i), scene, {{"a.npz", apply(good, random)}}, "a.npz"});
  for (const std::vector<std::size_t>& shape :
       std::vector<std::vector<std::size_t>>{{0, 1}, {1, 0}, {random() % 1000000 + 1000001, 1}, {1}, {1, 1, 1}, {}})
    all.push_back({"npz: another shape", scene, {{"a.npz", npz({numbers_array("left", shape, {})})}}, "a.npz"});
}

std::string with_another_byte(const std::string& good, std::mt19937& random) {
  const std::string bytes("\0\t\r;,\"'+-=#\xef\xff ", 14);
  std::string bad = good;
  for (int i = 0; i < 2; ++i) bad[random() % bad.size()] = bytes[random() % bytes.size()];
  return bad;
}

void add_tables(std::mt19937& random, std::vector<BadScene>& all) {
  const std::string scene =
      bar(kBox, "cables: [{name: left, path_m: [[0.005, 0, 0], [0.005, 0, 0.05]], plug_radius_m: 0.002}]\n");
  const std::string good = "rollout,time_s,left\n0,0,1.0\n0,0.05,0.95\n1,0,0.97\n";
  std::vector<std::pair<std::string, Damage>> damages = kDamages;
  damages.emplace_back("other separators", with_another_byte);
  for (const auto& [damage, apply] : damages)
    for (int i = 0; i < 6; ++i)
      all.push_back({"csv: " + damage + ", " + std::to_string(i), scene, {{"a.csv", apply(good, random)}}, "a.csv"});
}

// What a shell, a page, YAML, a path or a terminal would take for more than a name.
const Words kNames = {"$(touch it_was_run)",
                      "`touch it_was_run`",
                      "; touch it_was_run;",
                      "| touch it_was_run",
                      "<img src=x onerror=alert(1)>",
                      "<b>tip</b>",
                      "&amp;",
                      "../../tip",
                      "/etc/passwd",
                      "tip\nrun: {}",
                      "a\"b",
                      "a'b",
                      "a\\b",
                      "tip\x1b[31m",
                      "%s%n%s",
                      "",
                      " ",
                      ".",
                      "nan",
                      "ü",
                      "\xe2\x80\xae",
                      "\xf0\x9f\xa4\x96",
                      "\xff\xfe",
                      std::string(101, 'x'),
                      std::string(100000, 'x'),
                      "skin",
                      "body",
                      "-"};

void add_names(std::mt19937& random, std::vector<BadScene>& all) {
  const std::vector<std::pair<std::string, std::string>> places = {
      {"markers: [{name: ", ", position_m: [0, 0, 0.06]}]\n"},
      {"cables: [{name: ", ", path_m: [[0.005, 0, 0], [0.005, 0, 0.05]], plug_radius_m: 0.002}]\n"},
      {"contact: {obstacles: [{name: ", ", sphere: {center_m: [0, 0, 1], radius_m: 0.1}}]}\n"},
      {"bodies: [{name: ",
       ", " + kBox + ", element_size_m: 0.03, fixed: [{box: {min_m: [-9, -9, -9], max_m: [9, 9, 0]}}]}]\n"}};
  for (const auto& [before, after] : places)
    for (int i = 0; i < 8; ++i) {
      const std::string& name = one_of(kNames, random);
      all.push_back({"a name: " + before + name, bar(kBox, before + quote(name) + after), {}, ""});
    }
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

std::string between(int least, int most, std::mt19937& random) {
  return std::to_string(least + static_cast<int>(random() % static_cast<unsigned>(most - least)));
}

void add_places(std::mt19937& random, std::vector<BadScene>& all) {
  for (int i = 0; i < 12; ++i) {
    const std::string far = std::string(random() % 2 ? "-" : "") + "1.0e" + between(2, 308, random);
    const Words more = {
        "gravity_m_s2: [0, 0, " + far + "]\n",
        "loads: [{point_m: [0, 0, 0.06], force_n: [0, 0, " + far + "]}]\n",
        "markers: [{name: tip, position_m: [0, " + far + ", 0]}]\n",
        "cables: [{name: a, path_m: [[0, 0, 0], [0, 0, " + far + "]]}]\n",
        "contact: {obstacles: [{name: a, sphere: {center_m: [" + far + ", 0, 0], radius_m: 0.1}}]}\n",
        "contact: {obstacles: [{name: a, sphere: {center_m: [0, 0, 1], radius_m: 0.1}, motion: [{time_s: 0}, "
        "{time_s: 0.1, translation_m: [0, " +
            far + ", 0]}]}]}\n"};
    all.push_back({"a far place", bar(kBox, one_of(more, random)), {}, ""});
  }
}

// Each asks for more memory or time than a robot does.
void add_sizes(std::mt19937& random, std::vector<BadScene>& all) {
  const std::string count = between(100000, 2000000000, random);
  const std::string sphere = "{sphere: {radius_m: 0.01, center_m: [0, 0, 0]}}, ";
  const std::string ball = "{name: a, sphere: {center_m: [0, 0, 1], radius_m: 0.01}, mass_kg: 0.001}, ";
  const std::size_t many = 1001 + random() % 1000;
  std::string header(84, '\0');
  header[83] = static_cast<char>(0x80 + random() % 0x7f);
  const std::vector<std::pair<std::string, std::string>> scenes = {
      {"copies", bar("solid: {array: {solid: {box: {size_m: [1, 1, 1], center_m: [0, 0, 0]}}, count: " + count +
                     ", by_m: [1, 0, 0]}}")},
      {"solids", bar("solid: {union: [" + repeated(sphere, many) + "]}")},
      {"a spline", bar("solid: {sweep: {radius_m: 0.001, spline_m: [" + repeated("[0, 0, 0.1], ", many) + "]}}")},
      {"free obstacles", bar(kBox, "contact: {obstacles: [" + repeated(ball, many) + "]}\n")},
      {"small elements", "include: bar.yaml\nbody: {element_size_m: 1.0e-" + between(4, 300, random) + "}\n"},
      {"aliases", "a: &a [" + repeated("x, ", 100) + "]\nb: &b [" + repeated("*a, ", 100) + "]\nc: &c [" +
                      repeated("*b, ", 100) + "]\nd: [" + repeated("*c, ", 100) + "]\n"},
      {"nested lists", repeated("[", 100000 + random() % 100000)},
      {"a long run", bar(kBox, "run: {mode: dynamic, duration_s: 1.0e" + between(7, 300, random) + "}\n")}};
  for (const auto& [name, text] : scenes) all.push_back({"memory: " + name, text, {{"bar.yaml", bar(kBox)}}, ""});
  all.push_back({"memory: triangles", bar("solid: {stl: a.stl}"), {{"a.stl", header + std::string(600, '\1')}}, ""});
  all.push_back(
      {"memory: nodes",
       bar("mesh: a.vtk"),
       {{"a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + count + " double\n"}},
       ""});
}

}  // namespace

std::vector<BadScene> bad_files(unsigned int seed) {
  std::mt19937 random(seed);
  std::vector<BadScene> all;
  for (const auto& add : {add_scripts, add_meshes, add_archives, add_tables, add_names, add_places, add_sizes})
    add(random, all);
  return all;
}

}  // namespace soft_robot_lab
