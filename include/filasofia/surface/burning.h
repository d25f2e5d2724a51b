#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/surface/body_surface.h"
#include "filasofia/surface/burning_def.h"

#include <map>
#include <string>

namespace filasofia::surface {

/// The heat in the surface of one soft body, and what it does there. A plain value that a copy saves; the same calls
/// give the same bits. It knows no clock and no thread.
class Burning {
public:
    using Def = BurningDef;
    using Command = Heat;
    using Balance = HeatBalance;

    /// `skin` are the triangles of the body before it is cut, by its nodes. Throws an Error that names `object` if the
    /// Def is wrong or there is no triangle.
    Burning(const BurningDef& def, std::vector<geometry::Triangle> skin, const std::string& object);

    /// The surface from now on: heat and burns follow the nodes, and new nodes are as those around them. If the
    /// boundary is older than the last one, the body was put back to its start, and so is everything here.
    void follow(const frame::Boundary& boundary);
    /// Takes effect at once.
    void apply(const Heat& command, std::span<const Vec3> positions);
    /// `dt` [s], >= 0; `positions` [m] of the body's nodes. Error-free; nothing happens as long as nothing is warm.
    /// Gravity does nothing.
    void step(std::span<const Vec3> positions, Vec3 gravity, double dt);

    [[nodiscard]] HeatBalance balance() const;
    /// Per vertex of the surface.
    [[nodiscard]] double temperature(std::size_t vertex) const { return def_.temperature + warmth_[vertex]; } ///< [K]
    [[nodiscard]] double damage(std::size_t vertex) const { return damage_[vertex]; } ///< [-], omega
    [[nodiscard]] double water(std::size_t vertex) const { return water_[vertex]; }   ///< [-], in [0, 1], left
    /// How burnt it looks, per node of the body: up to 0.35 it blanches with its damage, up to 1 it dries to char;
    /// negative where there is no surface.
    [[nodiscard]] std::vector<float> marks() const;
    /// Per node of the body, 1 where it is damaged: omega >= 1.
    [[nodiscard]] std::vector<std::uint8_t> burnt() const;
    [[nodiscard]] const BurningDef& def() const { return def_; }
    [[nodiscard]] int nodesNeeded() const { return surface_.nodesNeeded(); }

private:
    void set(std::vector<geometry::Triangle> triangles, std::span<const Vec3> rest);
    void measureRest(std::span<const Vec3> positions);
    void takeSources();
    void warm(double dt);
    void hurt(double dt);
    [[nodiscard]] double stored() const;
    [[nodiscard]] bool idle() const;

    BurningDef def_;
    std::vector<geometry::Triangle> skin_; ///< the body's before it is cut
    std::uint64_t revision_ = 0;           ///< that of the boundary it follows
    BodySurface surface_;
    std::vector<double> area_;        ///< [m^2] per vertex, at rest; empty: not measured yet
    std::vector<double> capacity_;    ///< [J/K] per vertex
    std::vector<double> conductance_; ///< [W/K] per neighbour
    std::vector<double> warmth_;      ///< [K] per vertex, above rest
    std::vector<double> water_;       ///< [-] per vertex, in [0, 1], share that has not boiled away
    std::vector<double> damage_;      ///< [-] per vertex, omega
    std::map<int, Heat> sources_;     ///< by their numbers
    HeatBalance balance_;             ///< without what balance() adds
    std::vector<Vec3> places_;        ///< working memory, like those below
    std::vector<double> power_, limit_, before_;
};

} // namespace filasofia::surface
