#pragma once

#include "filasofia/engine/solver_costs.h"
#include "filasofia/runtime/timing.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// What `bench solver` measures, one mesh and one time step at a time. The scene: the Stanford bunny hangs from its
/// head, or stands on its feet, under its own weight, 200 steps from rest.
namespace filasofia::app {

/// A mesh of the table.
struct SolverMesh {
    std::string name = {};                              ///< "10000", as in the file's name
    std::shared_ptr<const geometry::TetMesh> mesh = {}; ///< the true numbers
    bool judged = true;                                 ///< do the limits of speed speak of it
    [[nodiscard]] int elements() const { return static_cast<int>(mesh->tetrahedra.size()); }
};

/// How much is measured.
struct SolverEffort {
    int steps = 200;        ///< [-], of every run
    int errorSteps = 200;   ///< [-], of the runs that are held against the reference
    int stiffSteps = 50;    ///< [-], of the runs with stiff materials
    int repetitions = 5;    ///< [-], of every timing
    double seconds = 0.2;   ///< [s], at least, of the steps of one repetition
    int floorRepeats = 100; ///< [-], of each part of the floor, each time
    int oracleWindows = 5;  ///< [-], moments of the run at which the oracle is timed
    int oracleSteps = 3;    ///< [-], at each of them
};

/// Who works.
struct Crew {
    int threads = 1;
    bool othersBusy = false; ///< a thread of another kind keeps each of the other cores busy
    friend bool operator==(const Crew&, const Crew&) = default;
};

/// What a crew took.
struct CrewTimes {
    Crew crew = {};
    std::vector<double> steps = {};               ///< [s] all counted steps
    std::vector<double> medians = {};             ///< [s] per repetition
    std::vector<double> others = {};              ///< [-] cores that other programs took, per repetition
    std::vector<engine::SolverCosts> floors = {}; ///< per repetition; of undisturbed crews
    double iterations = 0.0;                      ///< [-] mean of the counted steps
    int mostIterations = 0;
    std::uint32_t flags = 0; ///< of all steps

    [[nodiscard]] runtime::Spread step() const { return runtime::spreadOf(steps); }
    [[nodiscard]] runtime::Spread floor() const;     ///< [s] over the repetitions
    [[nodiscard]] runtime::Spread overFloor() const; ///< [-] step by floor, over the repetitions
    [[nodiscard]] double flopsPerSecond() const;     ///< [1/s] of the floor
    [[nodiscard]] double floorPerElement() const;    ///< [s]
};

/// Distances of the nodes from where the reference has them, over the displacements: root of the sums of squares.
struct SolverErrors {
    int steps = 0;
    std::array<double, 2> standard = {}; ///< at the default tolerance; hanging, standing
    std::array<double, 2> tight = {};    ///< at the tight one
    std::uint32_t flags = 0;             ///< of all these runs
};

/// A mesh and a time step.
struct SolverCell {
    SolverMesh mesh = {};
    double dt = 0.0; ///< [s]
    std::vector<CrewTimes> crews = {};
    std::vector<double> oracleSteps = {};   ///< [s] cold steps of the assembled solver at 1e-6
    std::vector<double> oracleMedians = {}; ///< [s] per repetition
    std::uint32_t oracleFlags = 0;
    std::vector<double> roundTrips = {}; ///< [s] between two cores, per repetition
    SolverErrors errors = {};

    [[nodiscard]] const CrewTimes* find(Crew crew) const; ///< nullptr where it was not measured
    [[nodiscard]] runtime::Spread overOracle() const;     ///< [-] oracle by one thread's step, over the repetitions
    /// [-] one thread's time by this crew's, both with or both without disturbance, over the repetitions
    [[nodiscard]] runtime::Spread speedUp(Crew crew) const;
    /// The same over those repetitions in which other programs took no more than kQuiet of a core; nothing where there
    /// were none.
    [[nodiscard]] std::optional<runtime::Spread> quietSpeedUp(Crew crew) const;
    /// [s] over the repetitions
    [[nodiscard]] runtime::Spread roundTrip() const { return runtime::spreadOf(roundTrips); }
};

/// A material that is hard to solve for.
struct StiffRun {
    std::string mesh = {};
    double dt = 0.0;           ///< [s]
    double youngModulus = 0.0; ///< [Pa]
    double poissonRatio = 0.0; ///< [-]
    int mostIterations = 0;
    std::uint32_t flags = 0;
};

inline constexpr std::array kSolverSteps{1e-3, 5e-3}; ///< [s]
inline constexpr int kUncounted = 20;                 ///< first steps of a run that no time is taken of
inline constexpr double kTightTolerance = 1e-5;
inline constexpr double kQuiet = 0.1; ///< [-] cores that other programs may take where two threads are judged

/// Times every crew and the oracle, in turn, repetition by repetition.
SolverCell timeSolver(const SolverMesh& mesh, double dt, const SolverEffort& effort);

/// The errors at each of kSolverSteps; runs on all cores.
std::vector<SolverErrors> solverErrors(const SolverMesh& mesh, int steps);

/// E = 1 MPa, nu = 0.49, and both, at each of kSolverSteps; runs on all cores.
std::vector<StiffRun> stiffRuns(const SolverMesh& mesh, int steps);

} // namespace filasofia::app
