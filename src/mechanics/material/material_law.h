// SPDX-License-Identifier: BSD-3-Clause
// The elastic energy of silicone at a point, all but the volumetric term, as the kernels need it: four elements at
// once. With F the deformation gradient, C = F^T F, J = det F, I1 = tr C = |F|^2 and I2 = |cof F|^2:
//   neo_hookean    mu/2 phi,                   phi = I1 - 3 - 2 (J - 1) + (J - 1)^2   (Macklin & Mueller 2021)
//   mooney_rivlin  c10 phi + c01 xi,           xi = I2 - 3 - 4 (J - 1)                (Mooney 1940, Rivlin 1948)
//   yeoh           c1 phi + c2 phi^2 + c3 phi^3                                       (Yeoh 1993, eq. 3)
// Where J = 1, phi = I1 - 3 and xi = I2 - 3: the published incompressible energies, and any fit of their constants. The
// terms in J make the rest shape free of stress and leave it exactly the shear modulus mu = 2 (c10 + c01) or 2 c1 and
// no lambda, which the volumetric term alone brings. Departure from textbooks, which put J^(-2/3) I1 there: this is a
// polynomial, finite and smooth for inverted elements. phi and xi are nowhere negative for J > 0, zero at rest.
#pragma once

#include <algorithm>
#include <variant>
#include <vector>

#include "mechanics/linear_algebra/batches.h"
#include "soft_robot_lab/mechanics/material.h"

namespace soft_robot_lab {

struct NeoHookean {
  Batch mu;
};

// mooney_rivlin (c2 = c3 = 0) and yeoh (c01 = 0, c10 = c1); all in Pa.
struct Rivlin {
  Batch c10, c01, c2, c3;
};

// One law a batch; where the models of a body differ, all are written as Rivlin's.
template <class Law>
using LawList = std::vector<Law, BatchAllocator<Law>>;
using MaterialLaws = std::variant<LawList<NeoHookean>, LawList<Rivlin>>;

// Which of the two a model needs. A model that is neither gets a law of its own, and a list of it above.
inline bool is_neo_hookean(MaterialModel model) {
  switch (model) {
    case MaterialModel::neo_hookean:
      return true;
    case MaterialModel::mooney_rivlin:
    case MaterialModel::yeoh:
      return false;
  }
  return false;
}

inline void set_lane(const Material& material, int lane, NeoHookean& law) { law.mu[lane] = material.lame_mu_pa(); }
inline void set_lane(const Material& material, int lane, Rivlin& law) {
  law.c10[lane] = material.c10_pa();
  law.c01[lane] = material.c01_pa;
  law.c2[lane] = material.c2_pa;
  law.c3[lane] = material.c3_pa;
}

// The lambda of the volumetric term. Its multiplier needs some bulk to stand for: at a Poisson's ratio of zero this
// little, which no one can measure.
inline double bulk_lambda_pa(const Material& material) {
  return std::max(material.lame_lambda_pa(), 1e-6 * material.lame_mu_pa());
}

// d energy / dF = along_f F + along_cofactor cof F (+ what Rivlin's I2 adds).
struct BatchStress {
  Batch energy, along_f, along_cofactor;
};

inline Batch shear_energy(const BatchMatrix& f, Batch j) {
  return squared_norm(f) - 3.0 - 2.0 * (j - 1.0) + (j - 1.0) * (j - 1.0);
}

inline BatchStress stress_of(const NeoHookean& law, const BatchMatrix& f, const BatchMatrix&, Batch j) {
  return {law.mu * (0.5 * (squared_norm(f) - 3.0) - (j - 1.0) + 0.5 * (j - 1.0) * (j - 1.0)), law.mu,
          law.mu * (j - 2.0)};
}

// d phi/dF = 2 F + 2 (J - 2) cof F,  d xi/dF = 2 (I1 F - F C) - 4 cof F.
inline BatchStress stress_of(const Rivlin& law, const BatchMatrix& f, const BatchMatrix& c, Batch j) {
  const Batch phi = shear_energy(f, j);
  const Batch slope = 2.0 * (law.c10 + phi * (2.0 * law.c2 + 3.0 * law.c3 * phi));
  return {phi * (law.c10 + phi * (law.c2 + phi * law.c3)) + law.c01 * (squared_norm(c) - 3.0 - 4.0 * (j - 1.0)),
          slope + 2.0 * law.c01 * squared_norm(f), slope * (j - 2.0) - 4.0 * law.c01};
}

inline void add_rest_of_stress(const NeoHookean&, const BatchMatrix&, Batch, BatchMatrix&) {}

// - 2 c01 F C, times the weight.
inline void add_rest_of_stress(const Rivlin& law, const BatchMatrix& f, Batch weight, BatchMatrix& stress) {
  const BatchMatrix b = times_transposed(f);
  const Batch factor = -2.0 * law.c01 * weight;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      stress.m[i][k] += factor * (b.m[i][0] * f.m[0][k] + b.m[i][1] * f.m[1][k] + b.m[i][2] * f.m[2][k]);
}

}  // namespace soft_robot_lab
