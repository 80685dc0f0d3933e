// SPDX-License-Identifier: BSD-3-Clause
#include "bullet_body.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableCorotatedForce.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

namespace soft_robot_lab {
namespace {

btVector3 to_bullet(const Eigen::Vector3d& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }
Eigen::Vector3d from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

// Free nodes before held ones: implicit steps of Bullet 3.24 skip held nodes when they hand out predicted forces, and
// so give a later node the force of an earlier one. place[i]: where the scene's node i stands in Bullet's list.
std::vector<int> places_of(const Body& body) {
  std::vector<int> place(static_cast<std::size_t>(body.mesh().node_count()));
  int next = 0;
  for (const bool held : {false, true}) {
    for (int i = 0; i < body.mesh().node_count(); ++i) {
      if (body.fixed().col(i).all() == held) place[static_cast<std::size_t>(i)] = next++;
    }
  }
  return place;
}

Eigen::Matrix3Xd positions_of(const btSoftBody& soft, const std::vector<int>& place) {
  Eigen::Matrix3Xd positions(3, soft.m_nodes.size());
  for (std::size_t i = 0; i < place.size(); ++i)
    positions.col(static_cast<Eigen::Index>(i)) = from_bullet(soft.m_nodes[place[i]].m_x);
  return positions;
}

// What pulls at the nodes from outside: weight, dead loads, and cables of a given tension, at the start of each step.
class SceneForces : public btDeformableLagrangianForce {
 public:
  SceneForces(const Simulation& scene, std::vector<int> place)
      : scene_(scene), place_(std::move(place)), forces_n_(scene.body().external_forces_n()) {}

  void update(const Eigen::Matrix3Xd& positions_m) {
    forces_n_ = scene_.body().external_forces_n();
    for (std::size_t i = 0; i < scene_.actuators().size(); ++i) {
      const auto& actuator = scene_.actuators()[i];
      const DriveState& drive = scene_.state().drives[i];
      for (const Constraint* constraint : actuator->constraints()) {
        const ConstraintLaw law = constraint->law(constraint->value(positions_m, drive), 0.0, drive);
        if (!law.prescribed()) throw std::invalid_argument("'" + actuator->name() + "' must be given a tension");
        constraint->add_gradient(positions_m, drive, -law.max_multiplier, forces_n_);
      }
    }
  }

  void addScaledForces(btScalar scale, TVStack& force) override { add(scale, force); }
  void addScaledExplicitForce(btScalar scale, TVStack& force) override { add(scale, force); }
  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void addScaledElasticForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}
  // Not gravity's, whose objects Bullet takes for its own class, nor a mouse's, which explicit steps apply twice.
  btDeformableLagrangianForceType getForceType() override { return BT_MASSSPRING_FORCE; }

  double totalElasticEnergy(btScalar) override {
    double energy_j = 0.0;
    const auto& nodes = m_softBodies[0]->m_nodes;
    for (std::size_t i = 0; i < place_.size(); ++i)
      energy_j -= forces_n_.col(static_cast<Eigen::Index>(i)).dot(from_bullet(nodes[place_[i]].m_q));
    return energy_j;
  }

 private:
  void add(btScalar scale, TVStack& force) const {
    for (std::size_t i = 0; i < place_.size(); ++i)
      force[place_[i]] += scale * to_bullet(forces_n_.col(static_cast<Eigen::Index>(i)));
  }

  const Simulation& scene_;
  std::vector<int> place_;
  Eigen::Matrix3Xd forces_n_;
};

// Opens the limits of Bullet's solver, which has no setters for them.
class Solver : public btDeformableBodySolver {
 public:
  explicit Solver(const BulletSettings& settings) {
    m_maxNewtonIterations = settings.newton_iterations;
    m_newtonTolerance = btScalar(settings.newton_tolerance);
    m_cg.m_maxIterations = m_cr.m_maxIterations = settings.krylov_iterations;
    m_cg.m_tolerance = m_cr.m_tolerance = btScalar(settings.krylov_tolerance);
  }
};

// Bullet's neo-Hookean energy is that of Smith, Goes & Kim 2018, eq. 14, without their change of parameters (section
// 3.4), which gives it the small-strain stiffness of mu and lambda.
std::unique_ptr<btDeformableLagrangianForce> make_elasticity(const Material& material, const BulletSettings& settings) {
  const btScalar mu = btScalar(material.lame_mu_pa()), lambda = btScalar(material.lame_lambda_pa());
  const btScalar damping = btScalar(settings.damping_s);
  if (settings.model == "neo_hookean") {
    return std::make_unique<btDeformableNeoHookeanForce>(mu * 4 / 3, lambda + mu * 5 / 6, damping);
  }
  if (settings.model == "linear") {
    return std::make_unique<btDeformableLinearElasticityForce>(mu, lambda, btScalar(0), damping);
  }
  if (settings.model != "corotated") throw std::invalid_argument("model: '" + settings.model + "' is unknown");
  if (settings.implicit) throw std::invalid_argument("model: corotated has no derivative for implicit steps");
  return std::make_unique<btDeformableCorotatedForce>(mu, lambda);
}

std::unique_ptr<btSoftBody> make_body(const Body& body, const std::vector<int>& place, btSoftBodyWorldInfo& info,
                                      const BulletSettings& settings) {
  const TetMesh& mesh = body.mesh();
  if (mesh.quadratic()) throw std::invalid_argument("Bullet knows linear elements only: body.element must be linear");
  std::vector<btVector3> nodes(place.size());
  std::vector<btScalar> masses(place.size());
  for (int i = 0; i < mesh.node_count(); ++i) {
    const bool held = body.fixed().col(i).all();
    if (!held && body.fixed().col(i).any()) throw std::invalid_argument("Bullet holds whole nodes only");
    const auto here = static_cast<std::size_t>(place[static_cast<std::size_t>(i)]);
    nodes[here] = to_bullet(mesh.nodes_m.col(i));
    masses[here] = held ? btScalar(0) : btScalar(settings.mass_scale * body.node_masses_kg()[i]);
  }
  auto soft = std::make_unique<btSoftBody>(&info, mesh.node_count(), nodes.data(), masses.data());
  soft->getCollisionShape()->setMargin(btScalar(1e-6));
  const auto corner = [&](int c, int e) { return place[static_cast<std::size_t>(mesh.tets(c, e))]; };
  for (int e = 0; e < mesh.tet_count(); ++e) soft->appendTetra(corner(0, e), corner(1, e), corner(2, e), corner(3, e));
  soft->m_tetraScratches.resize(soft->m_tetras.size());
  soft->m_tetraScratchesTn.resize(soft->m_tetras.size());
  soft->initializeDmInverse();
  soft->m_cfg.drag = btScalar(settings.drag);
  soft->m_cfg.collisions = 0;
  soft->setSelfCollision(false);
  soft->setActivationState(DISABLE_DEACTIVATION);
  return soft;
}

const Material& only_material(const Body& body) {
  if (!body.one_material() || body.mesh().bodies.size() > 1)
    throw std::invalid_argument("the peer knows one body of one material, not several");
  return body.material();
}

}  // namespace

struct BulletBody::Parts {
  Parts(const Simulation& scene, const BulletSettings& chosen)
      : settings(chosen),
        dispatcher(&configuration),
        solver(chosen),
        world(&dispatcher, &broadphase, &constraint_solver, &configuration, &solver),
        place(places_of(scene.body())),
        forces(scene, place),
        elasticity(make_elasticity(only_material(scene.body()), chosen)) {
    constraint_solver.setDeformableSolver(&solver);
    world.setGravity({0, 0, 0});
    world.setImplicit(chosen.implicit);
    world.setLineSearch(chosen.line_search);
    world.setUseProjection(true);  // Bullet's other preconditioner does not know implicit steps
    soft = make_body(scene.body(), place, world.getWorldInfo(), chosen);
    world.addSoftBody(soft.get());
    world.addForce(soft.get(), elasticity.get());
    world.addForce(soft.get(), &forces);
    world.addForce(soft.get(), &no_gravity);
  }
  ~Parts() {
    world.removeSoftBodyForce(soft.get());
    world.removeSoftBody(soft.get());
  }

  BulletSettings settings;
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  Solver solver;
  btDeformableMultiBodyConstraintSolver constraint_solver;
  btDeformableMultiBodyDynamicsWorld world;
  std::vector<int> place;
  SceneForces forces;
  btDeformableGravityForce no_gravity{{0, 0, 0}};  // without one, implicit steps start from an undefined vector
  std::unique_ptr<btDeformableLagrangianForce> elasticity;
  std::unique_ptr<btSoftBody> soft;
};

BulletBody::BulletBody(const Simulation& scene, const BulletSettings& settings)
    : parts_(std::make_unique<Parts>(scene, settings)) {}
BulletBody::~BulletBody() = default;

void BulletBody::step() {
  parts_->forces.update(positions_m());
  const btScalar h = btScalar(parts_->settings.time_step_s);
  parts_->world.stepSimulation(h, 1, h);
}

Eigen::Matrix3Xd BulletBody::positions_m() const { return positions_of(*parts_->soft, parts_->place); }

double BulletBody::largest_speed_m_s() const {
  double largest = 0.0;
  const auto& nodes = parts_->soft->m_nodes;
  for (int i = 0; i < nodes.size(); ++i) largest = std::max(largest, double(nodes[i].m_v.length()));
  return largest;
}

}  // namespace soft_robot_lab
