#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/surface/body_surface.h"
#include "filasofia/surface/burning_def.h"
#include "filasofia/surface/heat.h"
#include "filasofia/surface/heated_tissue.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace filasofia::surface {

/// What the tip of an electrode gives to a body within one step.
struct TipHeat {
    int electrode = 0;                  ///< its number
    double energy = 0.0;                ///< [J], > 0, in the whole step
    double limit = 573.15;              ///< [K], what is as hot takes no more
    std::vector<HeatShare> shares = {}; ///< by the body's nodes
};

/// The heat in the surface of one soft body, and what it does there. A plain value that a copy saves; the same calls
/// give the same bits. It knows no clock and no thread.
class Burning {
public:
    using Def = BurningDef;
    using Command = Heat;
    using Balance = HeatBalance;

    /// `skin` are the triangles of the body before it is cut, by its nodes. Throws an Error that names `object` if the
    /// Def is wrong or there is no triangle. `inside` is its mesh before it is cut, at rest in the world, which a Def
    /// with `tissue` needs.
    Burning(const BurningDef& def, std::vector<geometry::Triangle> skin, const std::string& object,
            std::shared_ptr<const geometry::TetMesh> inside = nullptr);

    /// The surface from now on: heat and burns follow the nodes, and new nodes are as those around them. If the
    /// boundary is older than the last one, the body was put back to its start, and so is everything here.
    void follow(const frame::Boundary& boundary);
    /// Takes effect at once.
    void apply(const Heat& command, std::span<const Vec3> positions);
    /// For the next step, beside the sources. Nodes without a surface take none.
    void touch(std::vector<TipHeat> tips) { tips_ = std::move(tips); }
    /// `dt` [s], >= 0; `positions` [m] of the body's nodes. Error-free; nothing happens as long as nothing is warm.
    /// Gravity does nothing.
    void step(std::span<const Vec3> positions, Vec3 gravity, double dt);

    [[nodiscard]] HeatBalance balance() const;
    /// [J], taken from each electrode that has touched it, by their numbers.
    [[nodiscard]] const std::map<int, double>& taken() const { return taken_; }
    /// The triangles of the body before it is cut.
    [[nodiscard]] const std::vector<geometry::Triangle>& skin() const { return skin_; }
    /// Per vertex of the surface.
    [[nodiscard]] double temperature(std::size_t vertex) const { return def_.temperature + warmth_[vertex]; } ///< [K]
    [[nodiscard]] double damage(std::size_t vertex) const { return damage_[vertex]; } ///< [-], omega
    [[nodiscard]] double water(std::size_t vertex) const { return water_[vertex]; }   ///< [-], in [0, 1], left
    /// How far heat has gone, per node of the body: from -1, cold, over 0, where omega is 1, to 9/7, where it boils,
    /// and on to 16/7, where it is dry; below -1 where there is no surface. In between it is linear in the temperature
    /// that would do the same damage in the same time, up to the curvature of Arrhenius' law.
    [[nodiscard]] std::vector<float> levels() const;
    /// What the last step gave off, at most one for each cube of a centimetre.
    [[nodiscard]] std::vector<Fume> takeFumes() { return std::exchange(fumes_, {}); }
    /// [-] Share of a vertex's collagen that is denatured; 0 without `tissue`.
    [[nodiscard]] double denatured(std::size_t vertex) const { return 1.0 - intact_[vertex]; }
    /// The tissue that heat has changed since the last call.
    [[nodiscard]] std::vector<HeatedPart> takeParts() { return std::exchange(parts_, {}); }
    /// Per node of the body, 1 where it is damaged: omega >= 1.
    [[nodiscard]] std::vector<std::uint8_t> burnt() const;
    /// [-], Arrhenius' omega per node of the body, negative where there is no surface.
    [[nodiscard]] std::vector<float> damage() const;
    [[nodiscard]] const BurningDef& def() const { return def_; }
    [[nodiscard]] int nodesNeeded() const { return surface_.nodesNeeded(); }

private:
    void set(std::vector<geometry::Triangle> triangles, std::span<const Vec3> rest);
    void measureRest(std::span<const Vec3> positions);
    void takeSources(double dt);
    void take(std::span<const HeatShare> shares, double power, double limit);
    void countTips(double dt);
    void warm(double dt);
    void hurt(double dt);
    void fume();
    void denature(double dt);
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
    std::vector<double> intact_;      ///< [-] per vertex, share of collagen that is not denatured
    std::optional<HeatedTissue> inside_;
    std::vector<Vec3> rest_;   ///< [m] per vertex, if there is an inside
    double sinceSpread_ = 0.0; ///< [s]
    std::vector<HeatedPart> parts_;
    std::map<int, Heat> sources_; ///< by their numbers
    std::vector<TipHeat> tips_;   ///< for the next step, and by vertices within it
    std::map<int, double> taken_; ///< [J]
    std::vector<Fume> fumes_;     ///< what the last step gave off
    HeatBalance balance_;         ///< without what balance() adds
    std::vector<Vec3> places_;    ///< working memory, like those below
    std::vector<double> power_, limit_, before_, used_, steamed_;
};

} // namespace filasofia::surface
