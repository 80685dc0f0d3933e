// SPDX-License-Identifier: BSD-3-Clause
#include "sphere_cloud.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_sphere.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

namespace soft_robot_lab {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

Cloud::Ptr to_cloud(const Eigen::Matrix3Xd& points_m) {
  Cloud::Ptr cloud(new Cloud);
  for (const auto& point : points_m.colwise()) {
    const Eigen::Vector3f position = point.cast<float>();
    cloud->push_back({position.x(), position.y(), position.z()});
  }
  return cloud;
}

}  // namespace

std::vector<std::vector<int>> euclidean_clusters(const Eigen::Matrix3Xd& points_m, double step_m, int min_points) {
  std::vector<std::vector<int>> clusters;
  if (points_m.cols() == 0) return clusters;
  const Cloud::Ptr cloud = to_cloud(points_m);
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(step_m);
  extraction.setMinClusterSize(min_points);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> found;
  extraction.extract(found);
  for (const pcl::PointIndices& cluster : found) clusters.push_back(cluster.indices);
  return clusters;
}

std::optional<CloudSphere> find_sphere(const Eigen::Matrix3Xd& points_m, double min_radius_m, double max_radius_m,
                                       double tolerance_m) {
  const pcl::SampleConsensusModelSphere<pcl::PointXYZ>::Ptr model(
      new pcl::SampleConsensusModelSphere<pcl::PointXYZ>(to_cloud(points_m)));
  model->setRadiusLimits(min_radius_m, max_radius_m);
  pcl::RandomSampleConsensus<pcl::PointXYZ> search(model, tolerance_m);
  search.setMaxIterations(500);
  if (points_m.cols() < 4 || !search.computeModel()) return std::nullopt;
  Eigen::VectorXf sphere;
  CloudSphere found;
  search.getModelCoefficients(sphere);
  search.getInliers(found.inliers);
  found.center_m = sphere.head<3>().cast<double>();
  found.radius_m = sphere[3];
  return found;
}

}  // namespace soft_robot_lab
