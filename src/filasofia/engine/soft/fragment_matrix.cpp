#include "filasofia/engine/soft/fragment_matrix.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/elastic/relaxation.h"
#include "filasofia/engine/integration/euler.h"

#include <algorithm>
#include <array>

namespace filasofia::engine {
namespace {

template <std::size_t n> std::array<std::size_t, n> placesOf(const std::array<int, n>& nodes, const BodyPiece& piece)
{
    std::array<std::size_t, n> places;
    for (std::size_t k = 0; k < n; ++k)
        places[k] = static_cast<std::size_t>(std::ranges::lower_bound(piece.nodes, nodes[k]) - piece.nodes.begin());
    return places;
}

/// Adds stiffness K of one element, whose product with its corners' velocities is known, to a matrix of n rows.
template <std::size_t n, class Product> void addElement(const std::array<std::size_t, n>& places, double stiffness,
                                                        const Product& product, std::size_t rows,
                                                        std::vector<double>& matrix)
{
    for (std::size_t column = 0; column < n; ++column)
        for (int axis = 0; axis < 3; ++axis) {
            std::array<Vec3, n> unit{};
            unit[column][axis] = 1.0;
            const std::array<Vec3, n> forces = product(unit);
            const std::size_t at = 3 * places[column] + static_cast<std::size_t>(axis);
            for (std::size_t row = 0; row < n; ++row)
                for (int i = 0; i < 3; ++i)
                    matrix[(3 * places[row] + static_cast<std::size_t>(i)) * rows + at] += stiffness * forces[row][i];
        }
}

} // namespace

FragmentMatrix fragmentMatrix(const SoftModel& model, const BodyPiece& piece, double dt, const SoftState& state)
{
    const ImplicitWeights weights = implicitWeights(dt, {model.rayleigh.mass, model.rayleigh.stiffness},
                                                    relaxationTangent(model.material.relaxation, dt));
    const std::size_t rows = 3 * piece.nodes.size();
    FragmentMatrix out{std::vector<double>(rows * rows)};
    for (std::size_t k = 0; k < piece.nodes.size(); ++k) {
        const double mass = weights.mass * model.masses[static_cast<std::size_t>(piece.nodes[k])];
        out.mass += mass;
        for (std::size_t row = 3 * k; row < 3 * k + 3; ++row) out.entries[row * rows + row] = mass;
    }
    const auto add = [&](const auto& nodes, const auto& product) {
        addElement(placesOf(nodes, piece), weights.stiffness, product, rows, out.entries);
    };
    if (!isShell(model)) {
        for (int each : piece.elements) {
            const auto e = static_cast<std::size_t>(each);
            const FemElement& element = model.elements[e];
            const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
            const TissueTangent tangent = stepTangent(model, e, {f, toMat3(rotationOf(state.rotations, e))}, weights);
            add(element.nodes, [&](const Corners& corners) { return stiffnessTimes(tangent, element, corners); });
        }
        return out;
    }
    for (int each : piece.elements) {
        const MembraneElement& membrane = model.shell.membranes[static_cast<std::size_t>(each)];
        const auto tangent = membraneTangent(membrane, vectorsAt(membrane.nodes, state.x), weights.turning);
        add(membrane.nodes, [&](const auto& corners) { return stiffnessTimes(tangent, corners); });
    }
    for (int each : piece.elements) {
        if (model.shell.bends.empty()) break;
        const BendingElement& bend = model.shell.bends[static_cast<std::size_t>(each)];
        const auto tangent = bendingTangent(bend, vectorsAt(bend.nodes, state.x));
        add(bend.nodes, [&](const auto& corners) { return stiffnessTimes(tangent, corners); });
    }
    return out;
}

} // namespace filasofia::engine
