// SPDX-License-Identifier: BSD-3-Clause
#include "element_batches.h"

#include <algorithm>
#include <numeric>

#include <Eigen/LU>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {

namespace {

bool neo_hookean(const Body& body) {
  for (int tet = 0; tet < body.mesh().tet_count(); ++tet)
    if (!is_neo_hookean(body.material_of(tet).model)) return false;
  return true;
}

template <class Law>
LawList<Law> laws_of(const Body& body, const std::vector<int>& element) {
  LawList<Law> laws(element.size() / kLanes);
  for (std::size_t slot = 0; slot < element.size(); ++slot) {
    const int tet = element[slot] >= 0 ? element[slot] : ~element[slot];
    set_lane(body.material_of(tet), static_cast<int>(slot % kLanes), laws[slot / kLanes]);
  }
  return laws;
}

}  // namespace

ElementBatches::ElementBatches(const Body& body, std::vector<int> lanes, const std::vector<int>& rank)
    : node_count(static_cast<int>(body.mesh().tets.rows())),
      point_count(body.mesh().quadratic() ? 4 : 1),
      element(std::move(lanes)) {
  const TetMesh& mesh = body.mesh();
  if (neo_hookean(body))
    laws = laws_of<NeoHookean>(body, element);
  else
    laws = laws_of<Rivlin>(body, element);
  std::vector<ShapeFunctions> shapes;
  if (mesh.quadratic()) {
    for (const auto& point : tet_quadrature_points()) shapes.push_back(shape_functions(10, point));
  } else {
    shapes.push_back(shape_functions(4, Eigen::Vector3d::Constant(0.25)));
  }
  const double reference_weight = 1.0 / (6.0 * point_count);

  const auto batches = static_cast<std::size_t>(count());
  nodes.resize(batches * node_count * kLanes);
  gradients.assign(batches * point_count * node_count * 3, splat(0.0));
  weights.assign(batches * point_count, splat(0.0));
  laplacian.assign(batches * pair_count(), splat(0.0));
  lambda_pa.assign(batches, splat(0.0));
  mu_pa = mu_ratio = lambda_pa;

  for (std::size_t slot = 0; slot < element.size(); ++slot) {
    const std::size_t batch = slot / kLanes, lane = slot % kLanes;
    const bool used = element[slot] >= 0;
    const int tet = used ? element[slot] : ~element[slot];
    const double mu = body.material_of(tet).lame_mu_pa();
    lambda_pa[batch][lane] = bulk_lambda_pa(body.material_of(tet));
    mu_pa[batch][lane] = mu;
    mu_ratio[batch][lane] = mu / body.material().lame_mu_pa();
    std::vector<int> local(node_count);
    std::iota(local.begin(), local.end(), 0);
    std::sort(local.begin(), local.end(),
              [&](int a, int b) { return rank[mesh.tets(a, tet)] < rank[mesh.tets(b, tet)]; });
    for (int a = 0; a < node_count; ++a) nodes[(batch * node_count + a) * kLanes + lane] = mesh.tets(local[a], tet);
    for (int q = 0; q < point_count; ++q) {
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      for (int a = 0; a < node_count; ++a)
        jacobian += mesh.nodes_m.col(mesh.tets(a, tet)) * shapes[q].gradients.col(a).transpose();
      const Eigen::Matrix<double, 3, Eigen::Dynamic> rest = jacobian.inverse().transpose() * shapes[q].gradients;
      const double weight = used ? jacobian.determinant() * reference_weight : 0.0;
      weights[batch * point_count + q][lane] = weight;
      int pair = 0;
      for (int a = 0; a < node_count; ++a) {
        for (int i = 0; i < 3; ++i)
          gradients[((batch * point_count + q) * node_count + a) * 3 + i][lane] = rest(i, local[a]);
        for (int b = 0; b <= a; ++b, ++pair)
          laplacian[batch * pair_count() + pair][lane] += mu * weight * rest.col(local[a]).dot(rest.col(local[b]));
      }
    }
  }
}

}  // namespace soft_robot_lab
