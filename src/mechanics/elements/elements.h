// SPDX-License-Identifier: BSD-3-Clause
// The silicone of a body as mixed tetrahedra: quadratic displacements with one volume multiplier per element (P2/P0),
// or linear ones. Energy of an element, with J = det F and the material's own energy density Psi (material_law.h) at
// the quadrature points, whose rest volumes are w; only the volumetric part is averaged:
//   sum_q w Psi(F)  +  lambda/2 V0 (Jbar - 1)^2,   Jbar = sum_q w J / V0
// The multiplier p stands for lambda (Jbar - 1) and is condensed element by element. Linear elements may instead share
// their volume with their vertices, which then have the multipliers (volume_patches.h). After these come the tensions
// of the body's fibres, which are elastic like them (fibre_multipliers.h).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/linear_algebra/block_matrix.h"
#include "element_batches.h"
#include "fibre_multipliers.h"
#include "mechanics/material/material_law.h"
#include "soft_robot_lab/mechanics/body.h"
#include "volume_patches.h"

namespace soft_robot_lab {

// What one pass over the elements finds at some positions.
struct ElementSums {
  double elastic_energy = 0.0;  // all but the volumetric term [J]
  int inverted = 0;             // elements with det F <= 0 at a quadrature point
  int worst_element = -1;       // the one with the smallest det F
  double smallest_determinant = 1.0;
  Eigen::VectorXd volumetric_strain;  // per multiplier: Jbar - 1, or of a fibre t
};

// What never changes of the elements of a body, and where they are in its matrices.
struct ElementTables {
  ElementTables(const Body& body, const BlockPattern& matrix);

  const Eigen::VectorXd& rest_volumes_m3() const { return patches ? patches->volumes_m3() : volumes; }

  int count;
  bool one_material;
  ElementBatches batches;           // in the mesh's order; nodes of each sorted by elimination order
  std::vector<int> slots;           // per batch: pair (a >= b) x lanes, slots of the matrix
  Eigen::VectorXd element_volumes;  // V0 = sum w [m^3]
  std::optional<VolumePatches> patches;
  std::optional<FibreMultipliers> fibres;
  Eigen::VectorXd volumes;  // of elements, then the lengths of fibres [m]
};

class Elements {
 public:
  explicit Elements(std::shared_ptr<const ElementTables> tables);
  Elements(const Body& body, const BlockMatrix& matrix)
      : Elements(std::make_shared<const ElementTables>(body, matrix.pattern())) {}

  // Adds to `forces` the gradient of the elastic energy plus p grad(V0 Jbar), 3 x nodes [N].
  ElementSums add_gradient(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers,
                           Eigen::Matrix3Xd& forces) const;

  // Adds the condensed Hessian, with p in its geometric part. `convex` adds the least isotropic stiffness that makes
  // every quadrature point's Hessian positive. Remembers grad(V0 Jbar) of these positions for the next two functions.
  void add_hessian(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers, bool convex,
                   BlockMatrix& matrix);

  // With those of another add_hessian, or with none yet.
  struct VolumeGradients {
    Batches of_elements;
    FibreMultipliers::Gradients of_fibres;
  };
  void exchange_volume_gradients(VolumeGradients& other) {
    if (other.of_elements.empty()) other.of_elements.resize(volume_gradients_.size());
    volume_gradients_.swap(other.of_elements);
    std::swap(fibre_gradients_, other.of_fibres);
  }

  // Adds lambda c grad(V0 Jbar): what condensation of the multipliers adds to the gradient where c = Jbar - 1 - p /
  // lambda.
  void add_mismatch_forces(const Eigen::VectorXd& mismatch, Eigen::Matrix3Xd& forces) const;

  // After a linear solve, from where the volumetric_strain was Jbar - 1:
  // p <- lambda (Jbar - 1 + grad Jbar . dx).
  Eigen::VectorXd updated_multipliers(const Eigen::VectorXd& volumetric_strain, const Eigen::Matrix3Xd& step) const;

  // c = Jbar - 1 - p / lambda, per multiplier: zero where multiplier and volume agree.
  Eigen::VectorXd mismatch(const Eigen::VectorXd& volumetric_strain, const Eigen::VectorXd& multipliers) const {
    return volumetric_strain - multipliers.cwiseQuotient(lambda_pa_);
  }

  // sum of factor c^2 V0 over the multipliers.
  double sum_of_squares(const Eigen::VectorXd& factors, const Eigen::VectorXd& c) const;

  // What each multiplier stands for: an element's rest volume or a vertex's, or a fibre's length.
  const Eigen::VectorXd& rest_volumes_m3() const { return tables_->rest_volumes_m3(); }
  int multiplier_count() const { return static_cast<int>(rest_volumes_m3().size()); }
  int count() const { return count_; }
  Eigen::Index fibre_count() const { return tables_->fibres ? tables_->fibres->count() : 0; }  // the last multipliers
  const ElementBatches& batches() const { return batches_; }
  const std::vector<int>& slots() const { return slots_; }
  const Eigen::VectorXd& lambda_pa() const { return lambda_pa_; }  // per multiplier
  void set_lambda_pa(const Eigen::VectorXd& lambda_pa);
  // Of other forces than the elements' own: p grad(V0 Jbar) alone, 3 x nodes [N].
  Eigen::Matrix3Xd pressure_forces_n(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& p_pa) const;
  const Eigen::VectorXd& mu_pa() const { return mu_pa_; }  // per multiplier

 private:
  double lambda_of(int element) const { return lambda_pa_[patches_ ? 0 : element]; }

  std::shared_ptr<const ElementTables> tables_;
  const int count_;  // these are the tables'
  const ElementBatches& batches_;
  const std::vector<int>& slots_;
  const Eigen::VectorXd& element_volumes_;
  const std::optional<VolumePatches>& patches_;
  Eigen::VectorXd lambda_pa_, mu_pa_;            // alike for all vertices where these have the multipliers
  Batches lambdas_;                              // per batch: what the kernels condense with
  Batches volume_gradients_;                     // per batch: node x 3: d(V0 Jbar)/dx of the last add_hessian [m^2]
  FibreMultipliers::Gradients fibre_gradients_;  // of the same
};

}  // namespace soft_robot_lab
