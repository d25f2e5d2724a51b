#pragma once

#include <filasofia/filasofia.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A box trainer: a board with twelve pegs, rings on six of them, two instruments and a laparoscope. The board's top is
/// y = 0, the trainee is at +z, lengths are metres.
namespace laparoscopy {

/// Steps in so much time: PhysicsDef's default is 1 kHz.
inline int stepsIn(double seconds) { return static_cast<int>(std::lround(1000.0 * seconds)); }

inline constexpr int kPegs = 6;                ///< on each side, from the back to the front, the outer ones first
inline constexpr double kPegHeight = 18e-3;    ///< [m]
inline constexpr double kRingHeight = 7e-3;    ///< [m]
inline constexpr double kRingRadius = 7.15e-3; ///< [m] to the middle of its wall
enum Side { LeftSide, RightSide };

inline const std::vector<std::string> kDifficulties = {"easy", "normal", "hard"};
/// What a case file may change in every task.
struct Rules {
    bool guided = false;
    double timeLimit = 600; ///< [s]
};
constexpr auto fields(const Rules*)
{
    using namespace filasofia;
    return describe("Rules", field("guided", &Rules::guided, "instructions from the start"),
                    field("timeLimit", &Rules::timeLimit, "s", closed(10, 7200), "for the whole task"));
}
/// What a case file of a task may change: rules, one table by difficulty each.
template <class... Each>
std::vector<filasofia::TrainerSetting> settingsOf(const std::string& name, const Each (&... by)[3])
{
    std::vector<filasofia::TrainerSetting> all;
    for (const auto& more : {filasofia::settingsOf<Each>(by, {name})...})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

/// Plastic: a material without vessels and relief.
filasofia::TissueMaterial plain(filasofia::Color color, double wetness = 0.15);

/// [m], where a peg stands, on the board.
filasofia::Vec3 pegAt(Side side, int peg);

struct PegBox {
    filasofia::BodyId board = {};
    std::vector<filasofia::BodyId> rings = {};
};
/// Adds board, table and `rings` rings on the left pegs, each shifted by chance.
PegBox addBox(filasofia::Simulation& sim, int rings, std::uint64_t seed);

/// The Defs of the instrument of a side, and of the laparoscope. The first haptic device holds the right instrument,
/// the second one the left.
filasofia::LaparoscopicInstrumentDef instrumentOf(Side side, const filasofia::Training& training);
/// Adds the interfaces of the devices that hold the two.
filasofia::TrocarHandsDef handsOf(filasofia::Simulation& sim, const filasofia::LaparoscopicInstrument& left,
                                  const filasofia::LaparoscopicInstrument& right);
filasofia::LaparoscopeDef scopeOf();
/// Gives an instrument the jaws that its kind has, which touch all, in place of those for rings.
void useOwnJaws(filasofia::LaparoscopicInstrumentDef& def);

/// What is recorded of two instruments and a laparoscope; the first one is measured.
std::vector<filasofia::TrackedBody> observedIn(const filasofia::LaparoscopicInstrument& first,
                                               const filasofia::LaparoscopicInstrument& second,
                                               const filasofia::Laparoscope& scope);

/// A step of a task that is done if this says so.
filasofia::TaskStep step(const char* name, const char* instruction, std::function<bool()> done);

/// Has the hands play the planned motion that the training asks for. Returns its number of physics steps; 0: a person
/// plays.
int play(const filasofia::Training& training, filasofia::TrocarHands& hands,
         const std::function<filasofia::TrocarPlan()>& expert, const std::function<filasofia::TrocarPlan()>& clumsy);

/// The peg of a side that a ring lies around; none if it does not.
std::optional<int> pegOf(const filasofia::Pose& ring, Side side);

} // namespace laparoscopy
