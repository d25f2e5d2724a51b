#include "filasofia/engine/soft/fragment_matrix.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/elastic/relaxation.h"

#include <algorithm>
#include <numeric>

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

FragmentMatrix::FragmentMatrix(const SoftModel& model, const BodyPiece& piece, double dt, const SoftState& state)
{
    const ImplicitWeights weights = implicitWeights(dt, {model.rayleigh.mass, model.rayleigh.stiffness},
                                                    relaxationTangent(model.material.relaxation, dt));
    stiffness_ = weights.stiffness;
    for (int node : piece.nodes) masses_.push_back(weights.mass * model.masses[static_cast<std::size_t>(node)]);
    for (int each : piece.elements) {
        const auto e = static_cast<std::size_t>(each);
        if (isShell(model)) {
            addTriangle(model.shell, e, piece, weights, state);
            continue;
        }
        const FemElement& element = model.elements[e];
        Part& part = parts_.emplace_back();
        part.element = &element;
        const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
        part.tangent = stepTangent(model, e, {f, toMat3(rotationOf(state.rotations, e))}, weights);
        part.places = placesOf(element.nodes, piece);
    }
}

void FragmentMatrix::addTriangle(const Shell& shell, std::size_t e, const BodyPiece& piece, ImplicitWeights weights,
                                 const SoftState& state)
{
    const MembraneElement& membrane = shell.membranes[e];
    membranes_.emplace_back(placesOf(membrane.nodes, piece),
                            membraneTangent(membrane, vectorsAt(membrane.nodes, state.x), weights.turning));
    if (shell.bends.empty()) return;
    const BendingElement& bend = shell.bends[e];
    bends_.emplace_back(placesOf(bend.nodes, piece), bendingTangent(bend, vectorsAt(bend.nodes, state.x)));
}

std::vector<double> FragmentMatrix::entries() const
{
    const std::size_t rows = 3 * nodes();
    std::vector<double> matrix(rows * rows);
    for (std::size_t row = 0; row < rows; ++row) matrix[row * rows + row] = masses_[row / 3];
    for (const Part& part : parts_)
        addElement(
            part.places, stiffness_,
            [&](const Corners& corners) { return stiffnessTimes(part.tangent, *part.element, corners); }, rows, matrix);
    const auto addTo = [&](const auto& elements) {
        for (const auto& each : elements)
            addElement(
                each.first, stiffness_, [&](const auto& corners) { return stiffnessTimes(each.second, corners); }, rows,
                matrix);
    };
    addTo(membranes_);
    addTo(bends_);
    return matrix;
}

double FragmentMatrix::mass() const { return std::accumulate(masses_.begin(), masses_.end(), 0.0); }

} // namespace filasofia::engine
