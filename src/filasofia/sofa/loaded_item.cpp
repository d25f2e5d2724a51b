#include "filasofia/sofa/loaded_item.h"

#include "filasofia/core/error.h"
#include "filasofia/sofa/shown_model.h"

#include <sofa/core/behavior/BaseMechanicalState.h>

#include <algorithm>
#include <set>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::behavior::BaseMechanicalState;
using ::sofa::core::topology::BaseMeshTopology;

bool isPicture(const ::sofa::core::BaseState& state) { return !dynamic_cast<const BaseMechanicalState*>(&state); }

/// The mesh around a state; for a picture the one that it shows, if it has no faces of its own.
BaseMeshTopology* meshOf(::sofa::core::BaseState& state)
{
    if (auto* shown = dynamic_cast<ShownModel*>(&state)) return shown->mesh();
    if (isPicture(state)) return nullptr;
    return state.getContext()->getMeshTopology(::sofa::core::objectmodel::BaseContext::Local);
}

std::vector<Vec3> valuesOf(const Vec3Types::VecCoord& list, double unit)
{
    std::vector<Vec3> values;
    values.reserve(list.size());
    for (const auto& each : list) values.push_back(unit * fromSofa(each));
    return values;
}

template <class Faces> void addTriangles(const Faces& triangles, std::vector<geometry::Triangle>& out)
{
    for (const auto& t : triangles)
        out.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
}
template <class Faces> void addQuads(const Faces& quads, std::vector<geometry::Triangle>& out)
{
    for (const auto& q : quads) {
        out.push_back({static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2])});
        out.push_back({static_cast<int>(q[0]), static_cast<int>(q[2]), static_cast<int>(q[3])});
    }
}

/// The triangles and quads of a picture.
void addOwnFaces(const ::sofa::core::BaseState& state, std::vector<geometry::Triangle>& out)
{
    using Triangles = ::sofa::Data<BaseMeshTopology::SeqTriangles>;
    using Quads = ::sofa::Data<BaseMeshTopology::SeqQuads>;
    if (const auto* triangles = dynamic_cast<const Triangles*>(state.findData("triangles")))
        addTriangles(triangles->getValue(), out);
    if (const auto* quads = dynamic_cast<const Quads*>(state.findData("quads"))) addQuads(quads->getValue(), out);
}

void addVolumes(BaseMeshTopology& mesh, std::vector<geometry::Tetrahedron>& out)
{
    const auto add = [&](auto a, auto b, auto c, auto d) {
        out.push_back({static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d)});
    };
    for (const auto& t : mesh.getTetrahedra()) add(t[0], t[1], t[2], t[3]);
    constexpr int six[6][4] = {{0, 5, 1, 6}, {0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}};
    for (const auto& h : mesh.getHexahedra()) // each as six around a diagonal
        for (const auto& t : six)
            add(h[static_cast<std::size_t>(t[0])], h[static_cast<std::size_t>(t[1])], h[static_cast<std::size_t>(t[2])],
                h[static_cast<std::size_t>(t[3])]);
}

/// Whether a triangle has no height that counts, as surfaces of ours must have: 1e-4 of its longest edge.
bool isFlat(const geometry::Triangle& t, const std::vector<Vec3>& at)
{
    const auto vertex = [&](int corner) { return at[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])]; };
    const Vec3 a = vertex(1) - vertex(0), b = vertex(2) - vertex(0);
    const double longest = std::max({length(a), length(b), length(a - b)});
    return !(length(cross(a, b)) > 1.1e-4 * longest * longest);
}

/// A surface has no other vertices than those of faces. `vertices`: the node of each.
geometry::TriangleMesh surfaceOf(const std::vector<geometry::Triangle>& faces, const std::vector<Vec3>& nodes,
                                 std::vector<int>& vertices)
{
    geometry::TriangleMesh mesh;
    std::vector<int> place(nodes.size(), -1);
    for (geometry::Triangle t : faces) {
        for (int& corner : t) {
            int& at = place[static_cast<std::size_t>(corner)];
            if (at < 0) {
                at = static_cast<int>(vertices.size());
                vertices.push_back(corner);
                mesh.vertices.push_back(nodes[static_cast<std::size_t>(corner)]);
            }
            corner = at;
        }
        mesh.triangles.push_back(t);
    }
    return mesh;
}

/// What no surface allows, such as three faces at an edge: every face gets vertices of its own.
geometry::TriangleMesh apart(const geometry::TriangleMesh& mesh, std::vector<int>& vertices)
{
    geometry::TriangleMesh faces;
    std::vector<int> from;
    for (const geometry::Triangle& t : mesh.triangles) {
        const int first = static_cast<int>(from.size());
        for (const int corner : t) {
            from.push_back(vertices[static_cast<std::size_t>(corner)]);
            faces.vertices.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
        }
        faces.triangles.push_back({first, first + 1, first + 2});
    }
    vertices = std::move(from);
    return faces;
}

/// Whether the mesh is one that bodies may have.
bool isBody(const physics::SoftBodyDef& def)
{
    try {
        if (isShell(def))
            loadShell(def);
        else
            loadMesh(def);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// A body of triangles or tetrahedra; false if the state has no elements.
bool makeSoft(::sofa::core::State<Vec3Types>& state, double unit, LoadedItem& item)
{
    physics::SoftBodyDef def{.name = item.name};
    const std::vector<Vec3> nodes = placesOf(state, unit);
    ItemElements elements = elementsOf(state, nodes);
    if (!elements.tetrahedra.empty()) {
        def.mesh = std::make_shared<const geometry::TetMesh>(
            geometry::TetMesh{.nodes = nodes, .tetrahedra = std::move(elements.tetrahedra)});
        item.def = def;
        return isBody(def);
    }
    if (elements.triangles.empty()) return false; // points, lines, or what no mesh of ours may be
    def.material = physics::ShellMaterial{};
    auto mesh =
        std::make_shared<geometry::TriangleMesh>(surfaceOf(tidied(elements.triangles, nodes), nodes, item.vertices));
    def.mesh = std::shared_ptr<const geometry::TriangleMesh>(mesh);
    if (!isBody(def)) *mesh = apart(geometry::TriangleMesh(*mesh), item.vertices);
    if (!isBody(def)) return false;
    item.def = def;
    return true;
}

} // namespace

std::vector<Vec3> placesOf(const ::sofa::core::State<Vec3Types>& state, double unit)
{
    return valuesOf(state.read(::sofa::core::vec_id::read_access::position)->getValue(), unit);
}

std::vector<Vec3> restOf(const ::sofa::core::State<Vec3Types>& state, double unit)
{
    const auto* rest = isPicture(state) ? nullptr : state.read(::sofa::core::vec_id::read_access::restPosition);
    if (rest && rest->getValue().size() == state.getSize()) return valuesOf(rest->getValue(), unit);
    return placesOf(state, unit);
}

ItemElements elementsOf(::sofa::core::State<Vec3Types>& state, const std::vector<Vec3>& nodes)
{
    ItemElements elements;
    const auto exist = [&](const auto& element) {
        return std::ranges::all_of(
            element, [&](int each) { return each >= 0 && static_cast<std::size_t>(each) < nodes.size(); });
    };
    auto* mesh = meshOf(state);
    if (mesh && !isPicture(state)) addVolumes(*mesh, elements.tetrahedra);
    std::erase_if(elements.tetrahedra, [&](const auto& each) { return !exist(each); });
    for (geometry::Tetrahedron& t : elements.tetrahedra) {
        const auto at = [&](std::size_t corner) { return nodes[static_cast<std::size_t>(t[corner])]; };
        if (geometry::signedVolume(at(0), at(1), at(2), at(3)) < 0) std::swap(t[2], t[3]);
    }
    if (!elements.tetrahedra.empty()) return elements;
    if (mesh) {
        addTriangles(mesh->getTriangles(), elements.triangles);
        addQuads(mesh->getQuads(), elements.triangles);
    } else if (isPicture(state)) {
        addOwnFaces(state, elements.triangles);
    }
    std::erase_if(elements.triangles, [&](const auto& each) { return !exist(each); });
    return elements;
}

std::vector<geometry::Triangle> tidied(const std::vector<geometry::Triangle>& triangles, const std::vector<Vec3>& at)
{
    std::vector<geometry::Triangle> kept;
    std::set<geometry::Triangle> seen;
    for (const geometry::Triangle& t : triangles) {
        geometry::Triangle key = t;
        std::ranges::sort(key);
        if (!isFlat(t, at) && seen.insert(key).second) kept.push_back(t);
    }
    return kept;
}

bool makeItem(::sofa::core::BaseState& state, double unit, LoadedItem& item)
{
    if (auto* soft = dynamic_cast<::sofa::core::State<Vec3Types>*>(&state)) {
        item.soft = soft;
        item.picture = isPicture(state);
        return makeSoft(*soft, unit, item);
    }
    auto* rigid = dynamic_cast<::sofa::core::State<RigidTypes>*>(&state);
    if (!rigid || rigid->getSize() == 0) return false;
    item.rigid = rigid;
    physics::RigidBodyDef def{.name = item.name, .elements = {}};
    for (const auto& x : rigid->read(::sofa::core::vec_id::read_access::position)->getValue())
        def.elements.push_back({unit * fromSofa(x.getCenter()), fromSofa(x.getOrientation())});
    item.def = def;
    return true;
}

} // namespace filasofia::sofaengine
