#pragma once

#include "filasofia/runtime/timing.h"
#include "filasofia/testing/solver_costs.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The measurements of `bench solver`, one mesh and one time step at a time. The scene: the Stanford bunny hangs from
/// its head, or stands on its feet, under its own weight, 200 steps from rest.
namespace filasofia::app {

/// A mesh of the table.
struct SolverMesh {
    std::string name = {};                              ///< "10000", as in the file's name
    std::shared_ptr<const geometry::TetMesh> mesh = {}; ///< the number of its elements is the true one
    bool judged = true;                                 ///< whether the speed limits apply to it
    [[nodiscard]] int elements() const { return static_cast<int>(mesh->tetrahedra.size()); }
};

/// The amount of measurement.
struct SolverEffort {
    int steps = 200;          ///< [-] per run
    int errorSteps = 200;     ///< [-] per run that is compared with the reference solver
    int stiffSteps = 50;      ///< [-] per run with a stiff material
    int repetitions = 5;      ///< [-] per timing
    double seconds = 0.2;     ///< [s] minimum time of the steps of one repetition
    int floorRepeats = 100;   ///< [-] per part of the lower bound, each time
    int referenceWindows = 5; ///< [-] moments of the run at which the reference solver is timed
    int referenceSteps = 3;   ///< [-] at each of these moments
};

/// A set of threads that compute, and the load beside them.
struct Crew {
    int threads = 1;
    bool othersBusy = false; ///< if true, a spinning thread keeps each of the other cores busy
    friend bool operator==(const Crew&, const Crew&) = default;
};

/// The times of one crew.
struct CrewTimes {
    Crew crew = {};
    std::vector<double> steps = {};   ///< [s] all counted steps
    std::vector<double> medians = {}; ///< [s] per repetition
    std::vector<double> others = {};  ///< [-] cores used by other programs, per repetition
    /// lower bounds per repetition; only for crews without load beside them
    std::vector<testing::SolverCosts> floors = {};
    double iterations = 0.0; ///< [-] mean over the counted steps
    int maxIterations = 0;
    std::uint32_t flags = 0; ///< the union over all steps

    [[nodiscard]] runtime::Spread step() const { return runtime::spreadOf(steps); }
    [[nodiscard]] runtime::Spread floor() const;     ///< [s] lower bound, over the repetitions
    [[nodiscard]] runtime::Spread overFloor() const; ///< [-] time of a step / lower bound, over the repetitions
    [[nodiscard]] double flopsPerSecond() const;     ///< [1/s] rate of the lower bound
    [[nodiscard]] double floorPerElement() const;    ///< [s] lower bound per element
};

/// Distances of the nodes from their positions in the reference solution, relative to the displacements: roots of the
/// sums of squares.
struct SolverErrors {
    int steps = 0;
    std::array<double, 2> standard = {}; ///< at the default tolerance; hanging, standing
    std::array<double, 2> tight = {};    ///< at the tight tolerance
    std::uint32_t flags = 0;             ///< the union over all these runs
};

/// A mesh and a time step.
struct SolverCell {
    SolverMesh mesh = {};
    double dt = 0.0; ///< [s]
    std::vector<CrewTimes> crews = {};
    std::vector<double> referenceSteps = {};   ///< [s] steps of the assembled solver at 1e-6 without warm start
    std::vector<double> referenceMedians = {}; ///< [s] per repetition
    std::uint32_t referenceFlags = 0;
    std::vector<double> roundTrips = {}; ///< [s] between two cores, per repetition
    SolverErrors errors = {};

    [[nodiscard]] const CrewTimes* find(Crew crew) const; ///< nullptr if it was not measured
    /// [-] time of the reference solver / one thread's step, over the repetitions
    [[nodiscard]] runtime::Spread overReference() const;
    /// [-] one thread's time / this crew's time, both with or both without load beside them, over the repetitions
    [[nodiscard]] runtime::Spread speedUp(Crew crew) const;
    /// The same over the repetitions in which other programs used at most kQuiet cores; empty if there were none.
    [[nodiscard]] std::optional<runtime::Spread> quietSpeedUp(Crew crew) const;
    /// [s] over the repetitions
    [[nodiscard]] runtime::Spread roundTrip() const { return runtime::spreadOf(roundTrips); }
};

/// A run with a material that is hard to solve for.
struct StiffRun {
    std::string mesh = {};
    double dt = 0.0;           ///< [s]
    double youngModulus = 0.0; ///< [Pa]
    double poissonRatio = 0.0; ///< [-]
    int maxIterations = 0;
    std::uint32_t flags = 0;
};

inline constexpr std::array kSolverSteps{1e-3, 5e-3}; ///< [s]
inline constexpr int kUncounted = 20;                 ///< first steps of a run that are not timed
inline constexpr double kTightTolerance = 1e-5;
inline constexpr double kQuiet = 0.1; ///< [-] cores that other programs may use if two threads are to be judged

/// Times every crew and the reference solver in turn, repetition by repetition.
SolverCell timeSolver(const SolverMesh& mesh, double dt, const SolverEffort& effort);

/// The errors at each of kSolverSteps; uses all cores.
std::vector<SolverErrors> solverErrors(const SolverMesh& mesh, int steps);

/// E = 1 MPa, nu = 0.49, and both together, at each of kSolverSteps; uses all cores.
std::vector<StiffRun> stiffRuns(const SolverMesh& mesh, int steps);

} // namespace filasofia::app
