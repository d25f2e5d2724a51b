#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// A thin film of liquid that runs down a moving surface of triangles. Finite volumes around vertices: what leaves one
/// enters another, is counted, or stays, so volume is conserved whatever the step.
namespace filasofia::surface {

/// Who is beside whom; changes only when the surface is cut. Vertices are local: 0, 1, ...
struct FilmTopology {
    std::vector<geometry::Triangle> triangles = {};
    std::vector<int> first = {}; ///< per vertex, where its neighbours begin; one more than vertices
    std::vector<int> next = {};  ///< neighbours, ascending for each vertex
    std::vector<std::array<int, 6>> slots =
        {};                             ///< per triangle and corner k, places in `next` of k -> k+1 and k+1 -> k
    std::vector<std::uint8_t> rim = {}; ///< per triangle, bit k: the edge from corner k to k+1 has no other triangle

    [[nodiscard]] int vertices() const { return static_cast<int>(first.size()) - 1; }
};
FilmTopology filmTopology(int vertices, std::vector<geometry::Triangle> triangles);

/// What lies on each vertex.
struct FilmContent {
    std::vector<double> volume = {}; ///< [m^3], >= 0
    std::vector<double> aged = {};   ///< [m^3 s], volume times its mean age
};

/// The surface as it is now, under gravity.
struct FilmGeometry {
    static constexpr int kPast = -1;      ///< drops fall past everything, as all do while `landing` is empty
    static constexpr int kUnknown = -2;   ///< nothing falls yet
    std::vector<double> area = {};        ///< [m^2] per vertex, a third of its triangles
    std::vector<double> elevation = {};   ///< [m] per vertex, against gravity
    std::vector<double> upward = {};      ///< [-] per vertex, cosine between its normal and up
    std::vector<double> conductance = {}; ///< [-] per neighbour, width of the passage over its length
    std::vector<double> rim = {};         ///< [m] per vertex, width of the rim times its slope, 0 inside
    std::vector<int> landing = {};        ///< per vertex, on which its drops land, or one of these:
    double gravity = 0.0;                 ///< [m/s^2], >= 0
};
/// `positions` [m], one per vertex.
void measure(const FilmTopology& topology, std::span<const Vec3> positions, Vec3 gravity, FilmGeometry& out);

/// Where drops land that fall from overhangs and rims, after measure(): on the part of the surface below them. It looks
/// only where there is liquid; from elsewhere nothing falls until it has looked again.
void findLandings(const FilmTopology& topology, std::span<const Vec3> positions, Vec3 gravity,
                  const FilmContent& content, FilmGeometry& out);

struct FilmLiquid {
    double viscosity = 4e-3;       ///< [Pa s], while it is fresh
    double hardening = 180.0;      ///< [s], age by which its viscosity rises by e
    double density = 1060.0;       ///< [kg/m^3]
    double surfaceTension = 0.056; ///< [N/m]
    double clinging = 3e-5;        ///< [m], thickness that does not flow
};

/// x >= 0 with x + c x^3 = b, for b, c >= 0.
double implicitThickness(double b, double c);

/// Lets the film flow for `dt` [s]; its time grows with it. Returns what dripped off and landed on none of it, [m^3].
/// `order` is working memory.
double flow(const FilmTopology& topology, const FilmGeometry& geometry, const FilmLiquid& liquid, double dt,
            FilmContent& content, std::vector<int>& order);

} // namespace filasofia::surface
