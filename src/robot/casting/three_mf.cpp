// SPDX-License-Identifier: BSD-3-Clause
#include "three_mf.h"

#include <memory>
#include <stdexcept>
#include <vector>

#include <Model/COM/NMR_DLLInterfaces.h>

namespace soft_robot_lab {
namespace {

struct Release {
  void operator()(NMR::PLib3MFBase* object) const { NMR::lib3mf_release(object); }
};
using Owned = std::unique_ptr<NMR::PLib3MFBase, Release>;

void require(LIB3MFRESULT result, const std::string& step) {
  if (result != LIB3MF_OK)
    throw std::runtime_error("3MF: cannot " + step + " (lib3mf's error " + std::to_string(result) + ")");
}

std::vector<NMR::MODELMESHVERTEX> vertices_mm(const Surface& surface) {
  std::vector<NMR::MODELMESHVERTEX> vertices(static_cast<std::size_t>(surface.vertices_m.cols()));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (int i = 0; i < 3; ++i)
      vertices[v].m_fPosition[i] = static_cast<float>(1000 * surface.vertices_m(i, static_cast<Eigen::Index>(v)));
  return vertices;
}

std::vector<NMR::MODELMESHTRIANGLE> triangles_of(const Surface& surface) {
  std::vector<NMR::MODELMESHTRIANGLE> triangles(static_cast<std::size_t>(surface.triangle_count()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i)
      triangles[t].m_nIndices[i] = static_cast<DWORD>(surface.triangles(i, static_cast<Eigen::Index>(t)));
  return triangles;
}

void add_object(NMR::PLib3MFModel* model, const Surface& surface, const std::string& name) {
  NMR::PLib3MFModelMeshObject* mesh = nullptr;
  require(NMR::lib3mf_model_addmeshobject(model, &mesh), "add an object");
  const Owned owned_mesh(mesh);
  require(NMR::lib3mf_object_setnameutf8(mesh, name.c_str()), "name its object");
  std::vector<NMR::MODELMESHVERTEX> vertices = vertices_mm(surface);
  std::vector<NMR::MODELMESHTRIANGLE> triangles = triangles_of(surface);
  require(NMR::lib3mf_meshobject_setgeometry(mesh, vertices.data(), static_cast<DWORD>(vertices.size()),
                                             triangles.data(), static_cast<DWORD>(triangles.size())),
          "take the triangles of " + name);
  NMR::PLib3MFModelBuildItem* item = nullptr;
  require(NMR::lib3mf_model_addbuilditem(model, mesh, nullptr, &item), "put " + name + " on the bed");
  const Owned owned_item(item);
}

}  // namespace

std::string three_mf(const Surface& surface, const std::string& name) {
  NMR::PLib3MFModel* model = nullptr;
  require(NMR::lib3mf_createmodel(&model), "begin a model");
  const Owned owned_model(model);
  require(NMR::lib3mf_model_setunit(model, NMR::MODELUNIT_MILLIMETER), "set millimetres");
  add_object(model, surface, name);
  NMR::PLib3MFModelWriter* writer = nullptr;
  require(NMR::lib3mf_model_querywriter(model, "3mf", &writer), "write");
  const Owned owned_writer(writer);
  ULONG64 size = 0;
  require(NMR::lib3mf_writer_getstreamsize(writer, &size), "measure its file");
  std::string bytes(size, '\0');
  require(NMR::lib3mf_writer_writetobuffer(writer, reinterpret_cast<BYTE*>(bytes.data()), size), "write its file");
  return bytes;
}

}  // namespace soft_robot_lab
