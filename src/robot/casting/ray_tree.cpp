// SPDX-License-Identifier: BSD-3-Clause
#include "ray_tree.h"

#include <embree3/rtcore.h>

#include <limits>
#include <stdexcept>

namespace soft_robot_lab {

struct RayTree::Embree {
  RTCDevice device = rtcNewDevice("threads=1");  // builds in the caller's thread
  RTCScene scene = nullptr;

  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

namespace {

void fill(RTCDevice device, RTCScene scene, const Surface& surface) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto vertex_count = static_cast<std::size_t>(surface.vertices_m.cols());
  const auto triangle_count = static_cast<std::size_t>(surface.triangles.cols());
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertex_count));
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), triangle_count));
  if (vertices == nullptr || corners == nullptr) throw std::runtime_error("Embree has no memory for a surface");
  Eigen::Map<Eigen::Matrix3Xf>(vertices, 3, surface.vertices_m.cols()) = surface.vertices_m.cast<float>();
  Eigen::Map<Eigen::Matrix<unsigned, 3, Eigen::Dynamic>>(corners, 3, surface.triangles.cols()) =
      surface.triangles.cast<unsigned>();
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
}

bool on_triangle(RTCPointQueryFunctionArguments* arguments) {
  (*static_cast<const std::function<void(int)>*>(arguments->userPtr))(static_cast<int>(arguments->primID));
  return false;  // the radius stays
}

}  // namespace

RayTree::RayTree(const Surface& surface)
    : surface_(surface), skip_m_(2e-6 * surface.size_m()), embree_(std::make_unique<Embree>()) {
  if (embree_->device == nullptr) throw std::runtime_error("Embree cannot be used on this processor");
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  fill(embree_->device, embree_->scene, surface);
}

RayTree::~RayTree() = default;

std::optional<RayHit> RayTree::first_hit(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                         double near_m) const {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin_m.x());
  ray.ray.org_y = static_cast<float>(origin_m.y());
  ray.ray.org_z = static_cast<float>(origin_m.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = static_cast<float>(near_m);
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const int triangle = static_cast<int>(ray.hit.primID);
  const Eigen::Vector3d normal = surface_.normals.col(triangle);
  const double slope = normal.dot(direction);
  const double exact = normal.dot(surface_.corner(triangle, 0) - origin_m) / slope;
  const bool usable = std::abs(slope) > 1e-3;
  return RayHit{triangle, usable ? exact : static_cast<double>(ray.ray.tfar)};
}

void RayTree::near(const Eigen::Vector3d& point_m, double radius_m, const std::function<void(int)>& visit) const {
  RTCPointQuery query{};
  query.x = static_cast<float>(point_m.x());
  query.y = static_cast<float>(point_m.y());
  query.z = static_cast<float>(point_m.z());
  query.radius = static_cast<float>(radius_m);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(embree_->scene, &query, &context, on_triangle, const_cast<std::function<void(int)>*>(&visit));
}

Eigen::Vector3d nearest_point(const Surface& surface, int triangle, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d a = surface.corner(triangle, 0), b = surface.corner(triangle, 1),
                        c = surface.corner(triangle, 2), ab = b - a, ac = c - a;
  const double d1 = ab.dot(point_m - a), d2 = ac.dot(point_m - a), d3 = ab.dot(point_m - b), d4 = ac.dot(point_m - b),
               d5 = ab.dot(point_m - c), d6 = ac.dot(point_m - c);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace soft_robot_lab
