// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_tree.h"

#include <embree3/rtcore.h>

#include <limits>
#include <stdexcept>

namespace soft_robot_lab {

struct MeshTree::Embree {
  RTCDevice device = rtcNewDevice("threads=1");  // builds in the caller's thread
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  float* vertices = nullptr;  // Embree's own
  Eigen::Index vertex_count = 0;

  ~Embree() {
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

namespace {

bool on_triangle(RTCPointQueryFunctionArguments* arguments) {
  (*static_cast<const std::function<void(int)>*>(arguments->userPtr))(static_cast<int>(arguments->primID));
  return false;  // the radius stays
}

}  // namespace

MeshTree::MeshTree(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, Use use)
    : embree_(std::make_unique<Embree>()) {
  Embree& e = *embree_;
  if (e.device == nullptr) throw std::runtime_error("Embree cannot be used on this processor");
  if (triangles.cols() == 0) return;
  e.scene = rtcNewScene(e.device);
  // Robust: no ray slips through between two triangles.
  rtcSetSceneFlags(e.scene,
                   use == Use::moving ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
  e.geometry = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (use == Use::moving) rtcSetGeometryBuildQuality(e.geometry, RTC_BUILD_QUALITY_REFIT);
  e.vertex_count = vertices_m.cols();
  e.vertices =
      static_cast<float*>(rtcSetNewGeometryBuffer(e.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                  3 * sizeof(float), static_cast<std::size_t>(vertices_m.cols())));
  auto* corners =
      static_cast<unsigned*>(rtcSetNewGeometryBuffer(e.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                     3 * sizeof(unsigned), static_cast<std::size_t>(triangles.cols())));
  if (e.vertices == nullptr || corners == nullptr) throw std::runtime_error("Embree has no memory for a mesh");
  Eigen::Map<Eigen::Matrix<unsigned, 3, Eigen::Dynamic>>(corners, 3, triangles.cols()) = triangles.cast<unsigned>();
  rtcAttachGeometry(e.scene, e.geometry);
  move(vertices_m);
}

MeshTree::~MeshTree() = default;

void MeshTree::move(const Eigen::Matrix3Xd& vertices_m) {
  Embree& e = *embree_;
  if (e.geometry == nullptr) return;
  Eigen::Map<Eigen::Matrix3Xf>(e.vertices, 3, e.vertex_count) = vertices_m.cast<float>();
  rtcUpdateGeometryBuffer(e.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(e.geometry);
  rtcCommitScene(e.scene);
  if (rtcGetDeviceError(e.device) != RTC_ERROR_NONE) throw std::runtime_error("Embree could not build its tree");
}

MeshHit MeshTree::cast(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, float near) const {
  if (embree_->scene == nullptr) return {};
  RTCRayHit ray{};
  ray.ray.org_x = origin_m.x(), ray.ray.org_y = origin_m.y(), ray.ray.org_z = origin_m.z();
  ray.ray.dir_x = direction.x(), ray.ray.dir_y = direction.y(), ray.ray.dir_z = direction.z();
  ray.ray.tnear = near;
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {static_cast<int>(ray.hit.primID), ray.ray.tfar, ray.hit.u, ray.hit.v};
}

void MeshTree::visit_near(const Eigen::Vector3f& point_m, float radius_m, const std::function<void(int)>& visit) const {
  if (embree_->scene == nullptr) return;
  RTCPointQuery query{};
  query.x = point_m.x(), query.y = point_m.y(), query.z = point_m.z();
  query.radius = radius_m;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(embree_->scene, &query, &context, on_triangle, const_cast<std::function<void(int)>*>(&visit));
}

}  // namespace soft_robot_lab
