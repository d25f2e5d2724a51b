#pragma once

#include "bench/peers/problem.h"

#include <optional>
#include <string>
#include <vector>

namespace filasofia::peers {

/// Whose equations a step solves. Bullet can be given ours through its own virtual functions.
enum class Equations { Ours, OursInBullet, Bullets };

/// One setting of one engine, measured.
struct Row {
    Equations equations = Equations::Ours;
    std::string name = {};
    double median = 0.0;     ///< [s] per step
    double p99 = 0.0;        ///< [s] per step
    double iterations = 0.0; ///< [-] per step
    int unsolved = 0;        ///< steps whose solver stopped at its cap (ours)
    double error = 0.0;      ///< [-] against our model solved to 1e-12 in double
    /// [-] against the same equations of Bullet's solved as far as it can: what its solver alone leaves.
    std::optional<double> solverError = {};
};

/// A sentence about two rows, and the ratio of their times where one is due.
struct Verdict {
    std::string question = {};
    std::optional<double> ratio = {};
    std::string words = {};
};

/// Every setting of both engines on one mesh and time step.
struct Cell {
    int tets = 0;
    double dt = 0.0; ///< [s]
    std::vector<Row> rows = {};
    std::vector<Verdict> verdicts = {};
};

/// Where a bunny comes to rest, against ours by Cholesky factorisation. Depends on no time step and no damping.
struct RestCell {
    int tets = 0;
    double ours = 0.0;               ///< [-]
    double bullet = 0.0;             ///< [-]
    double bulletOurRotations = 0.0; ///< [-]
};

Cell compare(int tets, double dt, int steps);
RestCell compareRest(int tets);

/// Bullet is called slower, or faster, only by a setting whose error is not above ours.
std::vector<Verdict> judge(const std::vector<Row>& rows);

} // namespace filasofia::peers
