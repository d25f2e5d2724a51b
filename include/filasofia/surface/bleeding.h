#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/surface/bleeding_def.h"
#include "filasofia/surface/body_surface.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace filasofia::surface {

/// The blood of one soft body: what wells where it was opened, flows, clots and leaves. A plain value that a copy
/// saves; the same calls give the same bits. It knows no clock and no thread.
class Bleeding {
public:
    using Def = BleedingDef;
    using Command = BloodCommand;
    using Balance = BloodBalance;

    /// `skin` are the triangles of the body before it is cut, by its nodes. Throws an Error that names `object` if the
    /// Def is wrong or there is no triangle.
    Bleeding(const BleedingDef& def, std::vector<geometry::Triangle> skin, const std::string& object);

    /// The surface from now on: blood follows the nodes, new nodes take theirs from those around them, and what cuts
    /// have opened since begins to bleed. If the boundary is older than the last one, the body was put back to its
    /// start, and so is everything here.
    void follow(const frame::Boundary& boundary);
    /// The vessels of these nodes are closed, and stay so when they are cut: true per node of the body.
    void close(std::span<const std::uint8_t> nodes);
    /// Takes effect at once, at the positions [m] of the body's nodes.
    void apply(const BloodCommand& command, std::span<const Vec3> positions);
    /// `dt` [s], >= 0. Error-free; nothing happens as long as nothing bleeds or lies there.
    void step(std::span<const Vec3> positions, Vec3 gravity, double dt);

    [[nodiscard]] BloodBalance balance() const;
    /// [m] per node of the body, negative where there is no surface.
    [[nodiscard]] std::vector<float> thickness() const;
    [[nodiscard]] const BleedingDef& def() const { return def_; }
    /// The number of nodes that the positions must have.
    [[nodiscard]] int nodesNeeded() const { return surface_.nodesNeeded(); }

private:
    void set(std::vector<geometry::Triangle> triangles, std::vector<std::uint8_t> opened);
    void carry(const std::vector<int>& now);
    void spread(const std::vector<int>& fresh);
    void measureWounds();
    void well(double dt);
    double takeAway(Vec3 place, double radius, double most);
    void pour(const Pour& what);
    [[nodiscard]] bool idle() const;

    BleedingDef def_;
    std::vector<geometry::Triangle> skin_; ///< the body's before it is cut
    std::uint64_t revision_ = 0;           ///< that of the boundary it follows
    BodySurface surface_;
    std::vector<std::uint8_t> opened_; ///< per triangle
    std::vector<std::uint8_t> wound_;  ///< per vertex: bleeds where it is opened; kInjured: on all its triangles
    std::vector<double> vessels_;      ///< [-] per vertex: flux of its wound over the Def's; < 0: not known yet
    FilmContent content_;
    BloodBalance balance_;
    double perfusion_ = 1.0;
    double untilLandings_ = 0.0; ///< [s], until it looks again where drops land
    std::optional<Suck> suction_;
    std::optional<Rinse> rinsing_;            ///< with a finite rate
    double poured_ = 0.0;                     ///< [m^3] since the last step
    double sincePour_ = 1.0, pourRate_ = 0.0; ///< [s] since something was poured; [m^3/s] lately
    FilmGeometry geometry_;                   ///< working memory, like those below
    std::vector<double> woundArea_;
    std::vector<Vec3> places_;
    std::vector<int> order_;
};

} // namespace filasofia::surface
