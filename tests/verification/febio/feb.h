#pragma once

#include "filasofia/core/error.h"
#include "filasofia/geometry/tet_mesh.h"

#include <fstream>
#include <map>
#include <sstream>

namespace filasofia::engine {

/// The mesh of a model of FEBio's test suite, of linear tetrahedra.
struct FebMesh {
    geometry::TetMesh mesh = {};
    std::vector<geometry::Triangle> loaded = {};       ///< all triangles of its surfaces
    std::map<std::string, std::vector<int>> sets = {}; ///< nodes by the name of their set
};

inline std::vector<double> numbersOf(std::string list)
{
    for (char& each : list)
        if (each == ',') each = ' ';
    std::istringstream in(list);
    std::vector<double> numbers;
    for (double number = 0.0; in >> number;) numbers.push_back(number);
    return numbers;
}

/// Every entity of such a file has a line of its own. Anything but nodes, elements, triangles and sets is passed over.
inline FebMesh readFeb(const std::string& file)
{
    std::ifstream in(file);
    if (!in) fail(file, ": cannot be read");
    FebMesh out;
    std::string set;
    for (std::string line; std::getline(in, line);) {
        const std::size_t begin = line.find('<'), content = line.find('>');
        if (begin == std::string::npos) {
            if (!set.empty())
                for (const double id : numbersOf(line)) out.sets[set].push_back(static_cast<int>(id) - 1);
            continue;
        }
        const std::string tag = line.substr(begin + 1, line.find_first_of(" >", begin) - begin - 1);
        const std::vector<double> numbers = numbersOf(line.substr(content + 1, line.find('<', content) - content - 1));
        const auto node = [&](std::size_t i) { return static_cast<int>(numbers.at(i)) - 1; };
        if (tag == "node")
            out.mesh.nodes.push_back({numbers.at(0), numbers.at(1), numbers.at(2)});
        else if (tag == "elem" && numbers.size() == 4)
            out.mesh.tetrahedra.push_back({node(0), node(1), node(2), node(3)});
        else if (tag == "tri3")
            out.loaded.push_back({node(0), node(1), node(2)});
        set = tag == "NodeSet" ? line.substr(line.find('"') + 1, line.rfind('"') - line.find('"') - 1) : "";
    }
    return out;
}

} // namespace filasofia::engine
