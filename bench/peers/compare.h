#pragma once

#include "bench/peers/problem.h"

#include <optional>
#include <string>
#include <vector>

namespace filasofia::peers {

/// The equations that a step solves. Bullet can be given ours through its own virtual functions.
enum class Equations { Ours, OursInBullet, Bullets };

/// The measurements of one setting of one engine.
struct Row {
    Equations equations = Equations::Ours;
    std::string name = {};
    double median = 0.0;     ///< [s] per step
    double p99 = 0.0;        ///< [s] per step
    double iterations = 0.0; ///< [-] per step
    int unsolved = 0;        ///< steps whose solver stopped at its iteration limit (ours)
    double error = 0.0;      ///< [-] relative to our model solved to 1e-12 in double precision
    /// [-] relative to the same equations of Bullet, solved as far as it can: the error of its solver alone.
    std::optional<double> solverError = {};
};

/// A sentence about two rows, and the ratio of their times if it is meaningful.
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

/// The error of the bunny's rest shape relative to ours by Cholesky factorisation. It depends on no time step and no
/// damping.
struct RestCell {
    int tets = 0;
    double ours = 0.0;               ///< [-]
    double bullet = 0.0;             ///< [-]
    double bulletOurRotations = 0.0; ///< [-]
};

Cell compare(int tets, double dt, int steps);
RestCell compareRest(int tets);

/// Bullet is called slower or faster only by a setting whose error is not above ours.
std::vector<Verdict> judge(const std::vector<Row>& rows);

} // namespace filasofia::peers
