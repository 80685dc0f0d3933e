// SPDX-License-Identifier: BSD-3-Clause
// The numbers by which the solvers decide, with their reasons. None is a number of physics: those are settings. Numbers
// of one algorithm's inside, such as a block's width, stand where they are used.
#pragma once

#include <cstddef>

namespace soft_robot_lab::constants {

// --- Newton's method (newton/newton_solver.h)

inline constexpr std::size_t kFrozenFactorSteps = 5;  // by an old factor between two new ones, in one solve
inline constexpr double kWorthwhileDecrease = 0.9;    // of the residual, by such a step
// Residual of an equilibrium below which the last factor leads to it: each step by it leaves a tenth or less.
inline constexpr double kNearRest = 1e-2;
// Of a constraint in the merit function, over its stiffness 1 / |B' A^-1 B|. Where A has one negative eigenvalue, as in
// a body that buckled, A + penalty B B' is singular at just 1; with several constraints more is needed.
inline constexpr double kPenaltyOfBuckled = 10.0;
// Steps by the secant of friction, before it is tried whether all sticks: near the limit each leaves most of the way.
inline constexpr int kSecants = 4;
inline constexpr double kTieStiffness = 1e3;   // of a carried point, over E * size
inline constexpr double kPenaltyOverMu = 5.0;  // stiffness of the merit function against volume mismatch
inline constexpr int kLineSearchHalvings = 8;  // of a step; then a convex stiffness is tried

inline constexpr double kStillAtRest = 2e-3;  // residual beyond which a state has no sensitivities: twice the roughest
                                              // equilibrium that is asked for
// Of E / (density size²): a stiffness over the mass below which a motion counts as resisted by nothing, and no state as
// unstable for it. A slender column just above its load of buckling has 1e-5.
inline constexpr double kNeutral = 1e-7;
inline constexpr int kRefinements = 4;  // of a derivative, whose matrix is softened by ties; each brings 1e-2

// --- Multipliers and slip (complementarity/multiplier_problem.h)

inline constexpr double kSlack = 1e-9;    // of a bound that is met, relative
inline constexpr double kOnBound = 1e-4;  // a contact this close to its bound, relative, slips
inline constexpr int kBlockRounds = 10;   // in which all that is wrong is changed at once; then the worst alone

// --- Descent on the energy (newton/energy_descent.cpp)

inline constexpr int kDescentHalvings = 24;  // of a step
inline constexpr int kDescentPatience = 8;   // times the task's iterations
inline constexpr double kSoftBulk = 20.0;    // largest lambda meanwhile, over mu
inline constexpr double kSoftTie = 1e-2;     // compliance added to a constraint meanwhile, over the body's at it
inline constexpr int kLawIterations = 50;    // at most, to find a law's multiplier
inline constexpr double kNoSlope = 1e-7;     // of the energy along a step, over mu times the volume: nothing to win
inline constexpr double kOnlySafe = 2.0;     // convexity beyond which there is no other matrix to try

// --- Steps in time and stages of an equilibrium (simulation/)

inline constexpr int kStageIterations = 25;                 // Newton iterations before a step or stage is cut
inline constexpr int kDeepestHalving = 6;                   // a time step is cut into at most 2^6 parts
inline constexpr double kMostParts = 1 << kDeepestHalving;  // beforehand, where an obstacle is fast
inline constexpr int kStepBudget = 10;         // times max_iterations, for a step; then it takes what it has
inline constexpr double kSmallestStage = 64;   // a command change is cut into at most this many continuation stages
inline constexpr int kEquilibriumBudget = 10;  // times max_iterations, for an equilibrium
inline constexpr int kTransientBudget = 20;    // the same, for the continuation in artificial time
inline constexpr double kLargestGrowth = 2.0;  // of a time step over the one before; BDF2 is stable to 1 + sqrt(2)
inline constexpr double kLargestChange = 0.5;  // of the velocity, over itself: beyond, something has started or hit

// --- Rest and sleep (simulation/rest.cpp), times the body's size

// How far from rest a body may be that is called at rest; what is soft is farther than its residual lets expect.
inline constexpr double kAtRest = 1e-5;
inline constexpr double kStill = 1e-7;  // the largest motion of a node on which nothing is seen to move
// The largest speed of what sleeps, in sizes a second. It knows no step, as in a short one everything moves little.
inline constexpr double kSleepingSpeed_per_s = 1e-4;
// Near rest a time step may ask for no more than one step by an old factor; from far away it brings so little that the
// body would creep, or swing about its rest, for seconds.
inline constexpr double kNearlyStill = 1e-3;
inline constexpr double kFar = 1e-3;      // a node's way from where the factor was made
inline constexpr double kMuchLeft = 0.1;  // not of the size: of a time step's tolerance
inline constexpr int kSettling = 12;      // iterations that a body which friction holds may take to rest

// --- XPBD (xpbd/)

inline constexpr int kXpbdThreads = 2;  // on meshes large enough to be worth it
inline constexpr int kBatchesWorthAThread = 16;
// An element's matrix is made again where C = F^T F since then is off the identity by more, or its pressure by more
// times mu.
inline constexpr double kStaleStrain = 0.1, kStalePressure = 0.2;
inline constexpr int kDoublings = 4;                // of the substeps of a step that creates energy
inline constexpr double kMostCreatedEnergy = 0.05;  // good steps stay below 0.01, others exceed 0.3 at once
inline constexpr double kMostLeft = 1.0;            // residual of a step that converged: no more than its largest force
inline constexpr int kContactPasses = 4;            // over all that touches, in a sweep
inline constexpr double kRecovery = 0.01;           // of sqrt(E / density): so fast deep skin comes out of other skin

// --- XPBD towards rest (simulation/substepping.cpp): steps of sweeps without inertia, which Anderson's mixing joins

inline constexpr int kRestSteps = 500;  // in which it must come to rest
inline constexpr int kRestSweeps = 20;  // of a step
// Of a sweep: its square is the stiffness of an element over the masses of its nodes. It is halved where a step leads
// nowhere, and doubled again after some that do.
inline constexpr double kRestSubstep_s = 2.0, kLeastRestSubstep_s = 0.1;
inline constexpr int kGoodRestSteps = 15;
inline constexpr double kMostGrowth = 10.0;    // of the motion in a step
inline constexpr std::size_t kRestDepth = 10;  // of the mixing
inline constexpr double kMixedTooFar = 2.0;    // the way of the next step over that before
inline constexpr int kPullSteps = 30;          // actuators move by a part of their way
inline constexpr double kPullOn = 0.1;         // once the residual is below this

}  // namespace soft_robot_lab::constants
