#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/defs.h"

#include <fstream>

namespace filasofia::engine {

/// A deck of CalculiX with the keywords that regenerate.py writes; any other keyword is an Error.
struct Deck {
    /// The whole body except its solver and damping, and except its material if that is hyperelastic.
    physics::SoftBodyDef def = {};
    Vec3 gravity = {}; ///< [m/s^2]
};

/// Splits a row at its commas.
inline std::vector<std::string> splitRow(const std::string& line)
{
    std::vector<std::string> row;
    std::istringstream in(line);
    for (std::string cell; std::getline(in >> std::ws, cell, ',');) row.push_back(cell);
    return row;
}

inline void addDeckLine(const std::string& keyword, const std::vector<std::string>& row, geometry::TetMesh& mesh,
                        Deck& deck)
{
    const auto number = [&](std::size_t i) { return std::stod(row.at(i)); };
    const auto index = [&](std::size_t i) { return std::stoi(row.at(i)) - 1; };
    const auto vec3 = [&](std::size_t i) { return Vec3{number(i), number(i + 1), number(i + 2)}; };
    if (keyword == "*NODE") {
        mesh.nodes.push_back(vec3(1));
    } else if (keyword == "*ELEMENT") {
        mesh.tetrahedra.push_back({index(1), index(2), index(3), index(4)});
    } else if (keyword == "*ELASTIC") {
        deck.def.material = physics::FemMaterial{.youngModulus = number(0), .poissonRatio = number(1)};
    } else if (keyword == "*DENSITY") {
        deck.def.mass = physics::Density{number(0)};
    } else if (keyword == "*BOUNDARY") {
        deck.def.attachments.at(0).nodes.push_back(index(0));
    } else if (keyword == "*CLOAD") {
        Vec3 force;
        force[index(1)] = number(2);
        deck.def.forces.push_back({index(0), force});
    } else if (keyword == "*DLOAD" && row.at(1) == "GRAV") {
        deck.gravity = number(2) * vec3(3);
    } else if (keyword == "*DLOAD") {
        deck.def.pressure = number(2); // CalculiX loads single faces; the engine's pressure acts on the whole surface
    } else if (keyword != "*HYPERELASTIC" && keyword != "*HEADING" && keyword != "*STATIC" && keyword != "*CONTROLS" &&
               keyword != "*NODE PRINT") {
        fail("deck: no rule for ", keyword);
    }
}

inline Deck readDeck(const std::string& file)
{
    std::ifstream in(file);
    geometry::TetMesh mesh;
    Deck deck{.def = {.rayleigh = {0.0, 0.0}, .gravity = false, .attachments = {{}}}};
    std::string keyword;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with('*'))
            keyword = line.substr(0, line.find(','));
        else
            addDeckLine(keyword, splitRow(line), mesh, deck);
    deck.def.gravity = lengthSquared(deck.gravity) > 0.0;
    deck.def.mesh = std::make_shared<const geometry::TetMesh>(std::move(mesh));
    return deck;
}

/// [m] The displacements in a table of regenerate.py, node by node.
inline std::vector<Vec3> readDisplacements(const std::string& file)
{
    std::ifstream in(file);
    std::vector<Vec3> found;
    std::string line;
    std::getline(in, line); // the names of the columns
    while (std::getline(in, line)) {
        const std::vector<std::string> row = splitRow(line);
        if (row.size() != 4 || std::stoul(row[0]) != found.size() + 1) fail(file, ": not a row of node ", found.size());
        found.push_back({std::stod(row[1]), std::stod(row[2]), std::stod(row[3])});
    }
    return found;
}

} // namespace filasofia::engine
