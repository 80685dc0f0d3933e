// SPDX-License-Identifier: BSD-3-Clause
#include "manufactured_problem.h"

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "mechanics/mesh/shape_functions.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "mechanics/mesh/subdivide.h"

namespace soft_robot_lab {
namespace {

constexpr double kEdge_m = 0.1;
constexpr double kHeight = 0.004;  // of the displacement, which strains by some 8 %

// b(t) = (4 t (1 - t))^2 and its derivatives: zero at both ends, and so is its slope.
struct Bump {
  double value, slope, curvature;

  explicit Bump(double t)
      : value(16.0 * t * t * (1.0 - t) * (1.0 - t)),
        slope(32.0 * t * (1.0 - t) * (1.0 - 2.0 * t)),
        curvature(32.0 * (1.0 - 6.0 * t + 6.0 * t * t)) {}
};

// The chosen displacement: the curl of (0, 0, psi) with psi = b(x) b(y) 4 z (1 - z), so that volume changes little.
struct Exact {
  Eigen::Vector3d displacement_m;
  Eigen::Matrix3d gradient;  // of the deformation

  explicit Exact(const Eigen::Vector3d& at_m) {
    const Bump x(at_m.x() / kEdge_m), y(at_m.y() / kEdge_m);
    const double t = at_m.z() / kEdge_m, z = 4.0 * t * (1.0 - t), dz = 4.0 * (1.0 - 2.0 * t);
    displacement_m = kHeight * kEdge_m * Eigen::Vector3d(x.value * y.slope, -x.slope * y.value, 0.0) * z;
    gradient << x.slope * y.slope * z, x.value * y.curvature * z, x.value * y.slope * dz,  //
        -x.curvature * y.value * z, -x.slope * y.slope * z, -x.slope * y.value * dz, 0.0, 0.0, 0.0;
    gradient = Eigen::Matrix3d::Identity() + kHeight * gradient;
  }
};

// First Piola-Kirchhoff stress of the neo-Hookean solid (include/soft_robot_lab/mechanics/material.h).
Eigen::Matrix3d stress_pa(const Material& material, const Eigen::Matrix3d& gradient) {
  const double mu = material.lame_mu_pa(), lambda = material.lame_lambda_pa();
  const double growth = gradient.determinant() - 1.0;
  const Eigen::Matrix3d cofactor = (growth + 1.0) * gradient.inverse().transpose();
  return mu * gradient + (-mu + (mu + lambda) * growth) * cofactor;
}

struct QuadraturePoint {
  Eigen::Vector3d local;
  double weight;  // of the reference tetrahedron's volume of 1/6
};

// Four Gauss points a direction of a cube that is folded into the tetrahedron: exact for polynomials of degree 5.
std::vector<QuadraturePoint> quadrature() {
  constexpr std::array<double, 4> kAt{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                      0.93056815579702629};
  constexpr std::array<double, 4> kWeight{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                          0.17392742256872693};
  std::vector<QuadraturePoint> points;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) {
        const double a = kAt[i], b = kAt[j], c = kAt[k];
        const double folded = (1.0 - a) * (1.0 - a) * (1.0 - b);
        points.push_back(
            {{a, (1.0 - a) * b, (1.0 - a) * (1.0 - b) * c}, kWeight[i] * kWeight[j] * kWeight[k] * folded});
      }
  return points;
}

// The six tetrahedra around the diagonal of a cube, one per order of the axes (Kuhn).
TetMesh cube() {
  TetMesh mesh;
  mesh.nodes_m.resize(3, 8);
  for (int i = 0; i < 8; ++i) mesh.nodes_m.col(i) = kEdge_m * Eigen::Vector3d(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.tets.resize(4, 6);
  mesh.tets << 0, 0, 0, 0, 0, 0,  //
      1, 3, 2, 6, 4, 5,           //
      3, 2, 6, 4, 5, 1,           //
      7, 7, 7, 7, 7, 7;
  return mesh;
}

// Calls `visit(element, shape functions with gradients of the rest shape [1/m], place, volume)` at every point.
template <class Visit>
void integrate(const TetMesh& mesh, const Visit& visit) {
  static const std::vector<QuadraturePoint> points = quadrature();
  const int count = static_cast<int>(mesh.tets.rows());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    Eigen::Matrix3d edges;  // straight
    for (int i = 0; i < 3; ++i)
      edges.col(i) = mesh.nodes_m.col(mesh.tets(i + 1, e)) - mesh.nodes_m.col(mesh.tets(0, e));
    const Eigen::Matrix3d to_rest = edges.inverse().transpose();
    for (const QuadraturePoint& point : points) {
      ShapeFunctions shape = shape_functions(count, point.local);
      shape.gradients = to_rest * shape.gradients;
      visit(e, shape, Eigen::Vector3d(mesh.nodes_m.col(mesh.tets(0, e)) + edges * point.local),
            point.weight * edges.determinant());
    }
  }
}

// What holds the chosen deformation: the weak form of its stresses.
Eigen::Matrix3Xd holding_loads_n(const TetMesh& mesh, const Material& material) {
  Eigen::Matrix3Xd loads = Eigen::Matrix3Xd::Zero(3, mesh.node_count());
  integrate(mesh, [&](int e, const ShapeFunctions& shape, const Eigen::Vector3d& at_m, double volume_m3) {
    const Eigen::Matrix3d stress = stress_pa(material, Exact(at_m).gradient);
    for (Eigen::Index a = 0; a < shape.values.size(); ++a)
      loads.col(mesh.tets(a, e)) += volume_m3 * stress * shape.gradients.col(a);
  });
  return loads;
}

// Dead loads on all nodes as an actuator; the command is their share.
class NodeLoads : public Actuator {
 public:
  std::vector<const Constraint*> constraints() const override { return {&constraint_}; }
  ActuatorReading observe(const Eigen::Matrix3Xd&, const std::vector<double>&, const DriveState&) const override {
    return {};
  }

 private:
  // Its value is the negative work of the loads.
  struct Loads : Constraint {
    Eigen::Matrix3Xd loads_n;

    std::vector<Clique> cliques() const override { return {}; }
    double value(const Eigen::Matrix3Xd& positions_m, const DriveState&) const override {
      return -loads_n.cwiseProduct(positions_m).sum();
    }
    void add_gradient(const Eigen::Matrix3Xd&, const DriveState&, double scale,
                      Eigen::Matrix3Xd& gradient) const override {
      gradient -= scale * loads_n;
    }
    void add_hessian(const Eigen::Matrix3Xd&, const DriveState&, double, CliqueSink&) const override {}
    ConstraintLaw law(double, double, const DriveState& drive) const override {
      ConstraintLaw law;
      law.min_multiplier = law.max_multiplier = drive.actuated_command;
      law.multiplier_per_command = 1.0;
      return law;
    }
  };

  void on_initialise(const YamlNode&, const Body& body, const MeshLocator&) override {
    limits_ = {0.0, 0.0, 1.0, "1"};
    constraint_.loads_n = holding_loads_n(body.mesh(), body.material());
  }

  Loads constraint_;
};

double error_of(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m) {
  double wrong = 0.0, all = 0.0;
  integrate(mesh, [&](int e, const ShapeFunctions& shape, const Eigen::Vector3d& at_m, double volume_m3) {
    Eigen::Vector3d found_m = -at_m;
    for (Eigen::Index a = 0; a < shape.values.size(); ++a)
      found_m += shape.values[a] * positions_m.col(mesh.tets(a, e));
    const Eigen::Vector3d exact_m = Exact(at_m).displacement_m;
    wrong += volume_m3 * (found_m - exact_m).squaredNorm();
    all += volume_m3 * exact_m.squaredNorm();
  });
  return std::sqrt(wrong / all);
}

}  // namespace

ManufacturedRun solve_manufactured(double poissons_ratio, bool quadratic, int subdivisions) {
  TetMesh mesh = cube();
  for (int i = 0; i < subdivisions; ++i) mesh = subdivide(mesh).mesh;
  const Material material{264200.0, poissons_ratio, 1070.0};
  Body body(quadratic ? make_quadratic(mesh) : mesh, material);
  const double close_m = 1e-6 * kEdge_m, far_m = 2.0 * kEdge_m;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side_m : {0.0, kEdge_m}) {
      Eigen::Vector3d min_m = Eigen::Vector3d::Constant(-far_m), max_m = Eigen::Vector3d::Constant(far_m);
      min_m[axis] = side_m - close_m;
      max_m[axis] = side_m + close_m;
      body.fix_nodes(min_m, max_m, {true, true, true});
    }
  }
  SolverOptions options;
  options.tolerance = 1e-9;
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<NodeLoads>());
  actuators.back()->initialise(YamlNode::parse("{name: loads}", "loads"), body, MeshLocator(body.mesh()));
  Simulation simulation(std::move(body), std::move(actuators), {}, options);
  simulation.set_command("loads", 1.0);
  ManufacturedRun run;
  run.size_m = kEdge_m / std::pow(2.0, subdivisions);
  run.converged = simulation.solve_equilibrium().converged;
  run.error = error_of(simulation.body().mesh(), simulation.state().positions_m);
  return run;
}

}  // namespace soft_robot_lab
