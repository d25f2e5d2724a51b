#pragma once

#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/runtime/simulation.h"

#include <array>

namespace filasofia::prefab {

/// The needle driver of a tie and its ways.
struct TieDriver {
    ArticulatedInstrument instrument;
    double mouth = 0.0; ///< [m] from its pivot to where its jaws hold
    Pose pose = {};     ///< where it was sent last

    void move(const Pose& to);
    /// Moves it towards a pose, at most so far [m]; returns whether it is there.
    bool go(const Pose& to, double most);
    /// The same along poses; `way` counts those that it has reached.
    template <std::size_t N> bool goAlong(const std::array<Pose, N>& poses, int& way, double most)
    {
        if (way < static_cast<int>(N) && go(poses[static_cast<std::size_t>(way)], most)) ++way;
        return way == static_cast<int>(N);
    }

    [[nodiscard]] Vec3 holdsAt() const;        ///< [m] between its jaws
    [[nodiscard]] Pose back(double by) const;  ///< so far [m] back along its shaft
    [[nodiscard]] bool isWound(Vec3 at) const; ///< whether a strand here is wound around shaft or jaws
    /// The attachment by which it holds a body; none if it does not.
    [[nodiscard]] AttachmentId gripOn(BodyId body, const frame::Frame& now) const;
};

} // namespace filasofia::prefab
