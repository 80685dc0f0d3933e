// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Model/COM/NMR_DLLInterfaces.h>
#include <gtest/gtest.h>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "robot/casting/surface.h"

namespace soft_robot_lab {

// The only object of a 3MF file, in the file's own unit, which must be millimetres. It must be closed.
inline Surface read_three_mf(std::string bytes) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler lib3mfs_reader_leaks;
#endif
  NMR::PLib3MFModel* model = nullptr;
  NMR::PLib3MFModelReader* reader = nullptr;
  EXPECT_EQ(NMR::lib3mf_createmodel(&model), LIB3MF_OK);
  EXPECT_EQ(NMR::lib3mf_model_queryreader(model, "3mf", &reader), LIB3MF_OK);
  EXPECT_EQ(NMR::lib3mf_reader_readfrombuffer(reader, reinterpret_cast<BYTE*>(bytes.data()), bytes.size()), LIB3MF_OK);
  DWORD unit = 0;
  EXPECT_EQ(NMR::lib3mf_model_getunit(model, &unit), LIB3MF_OK);
  EXPECT_EQ(unit, static_cast<DWORD>(NMR::MODELUNIT_MILLIMETER));
  NMR::PLib3MFModelResourceIterator* objects = nullptr;
  EXPECT_EQ(NMR::lib3mf_model_getmeshobjects(model, &objects), LIB3MF_OK);
  BOOL more = false, closed = false;
  EXPECT_TRUE(NMR::lib3mf_resourceiterator_movenext(objects, &more) == LIB3MF_OK && more) << "no object";
  NMR::PLib3MFModelResource* mesh = nullptr;
  EXPECT_EQ(NMR::lib3mf_resourceiterator_getcurrent(objects, &mesh), LIB3MF_OK);
  EXPECT_TRUE(NMR::lib3mf_resourceiterator_movenext(objects, &more) == LIB3MF_OK && !more) << "several objects";
  EXPECT_EQ(NMR::lib3mf_meshobject_ismanifoldandoriented(mesh, &closed), LIB3MF_OK);
  EXPECT_TRUE(closed);
  DWORD vertex_count = 0, triangle_count = 0;
  NMR::lib3mf_meshobject_getvertexcount(mesh, &vertex_count);
  NMR::lib3mf_meshobject_gettrianglecount(mesh, &triangle_count);
  std::vector<NMR::MODELMESHVERTEX> vertices(vertex_count);
  std::vector<NMR::MODELMESHTRIANGLE> triangles(triangle_count);
  EXPECT_EQ(NMR::lib3mf_meshobject_getvertices(mesh, vertices.data(), vertex_count, nullptr), LIB3MF_OK);
  EXPECT_EQ(NMR::lib3mf_meshobject_gettriangleindices(mesh, triangles.data(), triangle_count, nullptr), LIB3MF_OK);
  for (NMR::PLib3MFBase* object : {static_cast<NMR::PLib3MFBase*>(mesh), static_cast<NMR::PLib3MFBase*>(objects),
                                   static_cast<NMR::PLib3MFBase*>(reader), static_cast<NMR::PLib3MFBase*>(model)})
    NMR::lib3mf_release(object);
  Eigen::Matrix3Xd places(3, vertex_count);
  Eigen::Matrix3Xi corners(3, triangle_count);
  for (DWORD v = 0; v < vertex_count; ++v)
    for (int i = 0; i < 3; ++i) places(i, v) = static_cast<double>(vertices[v].m_fPosition[i]);
  for (DWORD t = 0; t < triangle_count; ++t)
    for (int i = 0; i < 3; ++i) corners(i, t) = static_cast<int>(triangles[t].m_nIndices[i]);
  return make_surface(places, corners);
}

}  // namespace soft_robot_lab
