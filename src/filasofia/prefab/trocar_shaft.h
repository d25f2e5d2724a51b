#pragma once

#include "filasofia/prefab/trocar.h"

/// The quasi-static mechanics of a shaft that a hand holds outside, a wall at the fulcrum, and a load inside.
namespace filasofia::prefab {

/// The forces on a shaft, from tissue.
struct ShaftLoad {
    Vec3 force = {};  ///< [N]
    Vec3 at = {};     ///< [m], the point to which the moment belongs
    Vec3 moment = {}; ///< [N m], about that point
};

struct ShaftState {
    TrocarPose given = {}; ///< where the hand is
    Vec3 shift = {};       ///< [m], by which the wall yields at the fulcrum
    Vec3 pressed = {};     ///< [N], on the wall, smoothed: a held mass would swing if the wall followed every jump
    double seal = 0.0;     ///< [-], in [-1, 1], part of the seal's friction; positive while it is pushed in
};

/// Throws an Error naming `object` and the field if a Def is wrong.
void checkTrocar(const TrocarDef& trocar, const TrocarHandleDef& hand, const TrocarPose& start,
                 std::string_view object);

/// Where the shaft is, and what the hand feels. `length` is that of the TrocarHandleDef.
TrocarReport reportOf(const TrocarDef& trocar, double length, const ShaftState& state, const ShaftLoad& load);

/// Moves the hand to `wanted`, as far as its strength lets it, and lets wall and seal follow.
void step(const TrocarDef& trocar, const TrocarHandleDef& hand, const TrocarPose& wanted, const ShaftLoad& load,
          double dt, ShaftState& state);

} // namespace filasofia::prefab
