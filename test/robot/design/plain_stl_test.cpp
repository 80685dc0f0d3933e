// SPDX-License-Identifier: BSD-3-Clause
#include "robot/design/plain_stl.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fuzz_obj.h"
#include "fuzz_stl.h"
#include "fuzz_rules.h"

#include "robot/design/mesh_formats.h"

namespace soft_robot_lab {
namespace {

std::string binary(std::uint32_t announced, std::size_t held, float value = 0.5F) {
  std::string bytes(84 + 50 * held, '\0');
  std::memcpy(&bytes[80], &announced, 4);  // of a machine whose lowest byte comes first, as the format's
  for (std::size_t i = 0; i < held; ++i) std::memcpy(&bytes[84 + 50 * i + 12], &value, 4);
  return bytes;
}

std::string facet(const std::string& x) {
  return "facet normal 0 0 nan\nouter loop\nvertex " + x + " 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n";
}

std::string refusal(const std::string& bytes, MeshFormat format = MeshFormat::stl) {
  try {
    safe_content(bytes, format);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PlainStl, KeepsTheTrianglesOfABinaryFileAlone) {
  EXPECT_EQ(plain_stl(binary(2, 2)), binary(2, 2));
  EXPECT_EQ(plain_stl(binary(2, 2) + "more"), binary(2, 2));
  std::string named = binary(2, 2);
  named.replace(0, 9, "solid of\n");
  EXPECT_EQ(plain_stl(named), binary(2, 2));
  EXPECT_EQ(plain_stl(named + "more"), binary(2, 2));
}

TEST(PlainStl, CountsTrianglesBeforeItBelievesTheFile) {
  EXPECT_EQ(refusal(binary(0xffffffff, 12)), "is no STL file: it announces 4294967295 triangles, and has bytes for 12");
  EXPECT_EQ(refusal(binary(3, 2)), "is no STL file: it announces 3 triangles, and has bytes for 2");
  EXPECT_EQ(refusal(binary(0, 2)), "holds no triangles");
  EXPECT_EQ(refusal(binary(1000001, 1000001)),
            "holds 1000001 triangles, at most 1000000 are read; make its mesh coarser");
  EXPECT_EQ(refusal(binary(2, 2, std::numeric_limits<float>::infinity())),
            "is no STL file: facet 0 has a corner that is no finite number");
  EXPECT_EQ(refusal("short"), "is no STL file: it has 5 bytes, a binary one at least 84");
}

// Gmsh computed without end there, or ended by a signal.
TEST(PlainStl, RefusesPlacesAndSizesThatNoScaleMakesARobot) {
  EXPECT_EQ(refusal(binary(2, 2, 1e7F)), "facet 0: 10000000 is out of range [-1000000, 1000000]");
  EXPECT_EQ(refusal(binary(2, 2, 1e-20F)).find("its body is 9.999999683e-21 large, out of range [1e-09, "), 0u);
  EXPECT_EQ(refusal("solid\n" + facet("-1e150") + "endsolid\n"), "line 4: -1e+150 is out of range [-1000000, 1000000]");
  const std::string point =
      "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 0 0\nvertex 1 0 1e-60\nendloop\nendfacet\n";
  EXPECT_EQ(refusal("solid\n" + point + "endsolid\n"), "its body is 1e-60 large, out of range [1e-09, 2000000]");
}

TEST(PlainStl, KeepsTheNumbersOfText) {
  const std::string plain = plain_stl("SOLID a name\r\n  " + facet("-1.25E-3") + "endsolid a name\n");
  EXPECT_EQ(plain,
            "solid body\nfacet normal 0 0 0\nouter loop\nvertex -1.25e-3 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\n"
            "endfacet\nendsolid body\n");
  EXPECT_EQ(plain_stl(plain), plain);
  std::string of_old_machines = "solid a\n" + facet("-1.25e-3");
  std::replace(of_old_machines.begin(), of_old_machines.end(), '\n', '\r');
  EXPECT_EQ(plain_stl(of_old_machines), plain);
  const std::string two = plain_stl("solid a\n" + facet("0") + "endsolid a\nsolid b\n" + facet("0"));
  EXPECT_NE(two.find("endsolid body\nsolid body\nfacet"), std::string::npos);
}

TEST(PlainStl, NamesTheLineThatIsNoStl) {
  EXPECT_EQ(refusal("solid a\n" + facet("word")), "is no STL file: line 4: 'word' is not a finite number");
  EXPECT_EQ(refusal("solid a\n" + facet(std::string("0\0001", 3))),
            "is no STL file: line 4: '0?1' is not a finite number");
  EXPECT_EQ(refusal("solid a\n" + facet("nan")), "is no STL file: line 4: 'nan' is not a finite number");
  EXPECT_EQ(refusal("solid a\nSystemCall \"id\";"),
            "is no STL file: line 2: 'systemcall' stands where 'facet' is expected");
  EXPECT_EQ(refusal("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop"),
            "is no STL file: line 5: 'endloop' stands where 'vertex' is expected");
  EXPECT_EQ(refusal("solid a\nendsolid a\n"), "holds no triangles");
}

TEST(MeshFormats, RefuseAScriptUnderEveryEnding) {
  for (const char* script : {"SystemCall \"id\";", "Merge \"other.msh\";\n$MeshFormat", "\n$MeshFormat\n", "", "//"})
    for (const MeshFormat format :
         {MeshFormat::msh, MeshFormat::vtk, MeshFormat::stl, MeshFormat::step, MeshFormat::obj})
      EXPECT_NE(refusal(script, format), "accepted") << script << ending_of(format);
  EXPECT_EQ(refusal("$MeshFormat\n2.2 0 8", MeshFormat::msh), "accepted");
  EXPECT_EQ(refusal("\r\nISO-10303-21;", MeshFormat::step), "accepted");
  EXPECT_EQ(refusal("# vtk DataFile Version 3.0", MeshFormat::vtk), "accepted");
}

TEST(MeshFormats, PassOverAByteOrderMark) {
  const std::string mark = "\xef\xbb\xbf", stl = "solid a\n" + facet("1");
  EXPECT_EQ(safe_content(mark + stl, MeshFormat::stl), safe_content(stl, MeshFormat::stl));
  EXPECT_EQ(safe_content(mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj),
            safe_content("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj));
  EXPECT_EQ(safe_content(mark + "$MeshFormat\n2.2 0 8", MeshFormat::msh), "$MeshFormat\n2.2 0 8");
  EXPECT_EQ(safe_content(mark + "# vtk DataFile Version 3.0", MeshFormat::vtk), "# vtk DataFile Version 3.0");
  EXPECT_EQ(refusal(mark + "SystemCall \"id\";", MeshFormat::msh), "is no MSH file: it must start with $MeshFormat");
}

TEST(MeshFormats, KnowEndingsInAnyCase) {
  EXPECT_TRUE(has_ending_of("a.STP", MeshFormat::step));
  EXPECT_TRUE(has_ending_of("a.step", MeshFormat::step));
  EXPECT_TRUE(has_ending_of("a.b.Stl", MeshFormat::stl));
  for (const char* name : {"a.stl.gz", "stl", "a.obj", "a.geo", "a.msh.opt", "a.stl "})
    EXPECT_FALSE(has_ending_of(name, MeshFormat::stl)) << name;
}

TEST(PlainObj, IsTheTrianglesOfItsFaces) {
  EXPECT_EQ(safe_content("v 0 0 0 # first\nv 1 0 0\nv 1 1.5 0\nv 0 1 0.1\nf 1/2/3 -3 3//1 4\n", MeshFormat::obj),
            "solid body\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1.5 0\nendloop\n"
            "endfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 1.5 0\nvertex 0 1 0.1\nendloop\n"
            "endfacet\nendsolid body\n");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 -2 1\n", MeshFormat::obj),
            "is no OBJ file: line 2: '-2' is none of the 1 vertices so far");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 -9223372036854775808 1\n", MeshFormat::obj),
            "is no OBJ file: line 2: '-9223372036854775808' is none of the 1 vertices so far");
}

// A number of many digits is repeated by each face.
TEST(PlainObj, GrowsNoMoreThanItsFaces) {
  std::string text = "v 0 0 0." + std::string(100000, '0') + "\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 1000; ++i) text += "f 1 2 3\n";
  EXPECT_LT(safe_content(text, MeshFormat::obj).size(), 200000u);
}

TEST(PlainStl, SurvivesTheFuzzersCorpusAndItsLike) {
  EXPECT_EQ(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/obj", fuzz_obj, 300), 4);
  EXPECT_EQ(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/stl", fuzz_stl, 300), 3);
}

}  // namespace
}  // namespace soft_robot_lab
