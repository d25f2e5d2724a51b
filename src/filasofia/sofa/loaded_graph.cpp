#include "filasofia/sofa/loaded_graph.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/shown_model.h"
#include "filasofia/sofa/sofa_process.h"

#include <sofa/core/ObjectFactory.h>
#include <sofa/core/behavior/BaseMechanicalState.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/helper/system/FileSystem.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/UpdateMappingVisitor.h>

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <filesystem>
#include <set>
#include <sstream>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::behavior::BaseMechanicalState;
using ::sofa::core::topology::BaseMeshTopology;
using ::sofa::simulation::Node;

/// The type in a message that says that SOFA could not make a component; empty in any other.
std::string missingType(const std::string& message)
{
    constexpr std::string_view begin = "Object type ", end = " was not created";
    const std::size_t at = message.find(begin), stop = message.find(end);
    if (at == std::string::npos || stop == std::string::npos || stop < at) return {};
    std::string type = message.substr(at + begin.size(), stop - at - begin.size());
    return type.substr(0, type.find('<'));
}

/// Components that only SOFA's own window needs.
bool isForItsWindow(const std::string& type)
{
    const auto has = [&](const char* part) { return type.find(part) != std::string::npos; };
    return type.starts_with("Ogl") || type.starts_with("Visual") || type.ends_with("Setting") || has("Camera") ||
           has("Light") || has("VisualManagerLoop") || type == "RequiredPlugin";
}

/// Throws an Error if a component that a step needs is missing.
void checkMessages(const std::vector<std::string>& messages, const std::string& file)
{
    for (const std::string& each : messages) {
        const std::string type = missingType(each);
        if (type.empty()) continue;
        if (!isForItsWindow(type)) fail(file, ": SOFA cannot make the component '", type, "': ", each);
        logInfo(file, ": left out '", type, "', which only SOFA's own window needs");
    }
}

std::vector<std::string> split(const std::string& list)
{
    std::vector<std::string> parts;
    std::istringstream in(list);
    for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
    return parts;
}

std::string linkedFolder()
{
    Dl_info info{};
    if (!dladdr(reinterpret_cast<const void*>(&::sofa::simulation::node::initRoot), &info) || !info.dli_fname)
        return {};
    return std::filesystem::path(info.dli_fname).parent_path().string();
}

/// As SOFA's own program does, once per process: what this one links needs no RequiredPlugin.
void loadLinkedParts()
{
    static const bool once = [] {
        for (const std::string& part : split(FILASOFIA_SOFA_PARTS)) {
            if (!part.starts_with("Sofa.Component.")) continue;
            ::sofa::helper::system::PluginManager::getInstance().loadPlugin(part);
            ::sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin(part);
        }
        return true;
    }();
    static_cast<void>(once);
}

std::string nameOf(const ::sofa::core::objectmodel::BaseObject& object)
{
    const std::string path = object.getPathName();
    return path.substr(path.find_first_not_of('/'));
}

template <class Faces> void addTriangles(const Faces& triangles, geometry::TriangleMesh& mesh)
{
    for (const auto& t : triangles)
        mesh.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
}
template <class Faces> void addQuads(const Faces& quads, geometry::TriangleMesh& mesh)
{
    for (const auto& q : quads) {
        mesh.triangles.push_back({static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2])});
        mesh.triangles.push_back({static_cast<int>(q[0]), static_cast<int>(q[2]), static_cast<int>(q[3])});
    }
}

bool isPicture(const ::sofa::core::BaseState& state) { return !dynamic_cast<const BaseMechanicalState*>(&state); }

BaseMeshTopology* meshOf(::sofa::core::BaseState& state)
{
    return state.getContext()->getMeshTopology(::sofa::core::objectmodel::BaseContext::Local);
}

/// The elements of a state as tetrahedra; empty if it has no volumes.
geometry::TetMesh volumeOf(BaseMeshTopology& mesh, const std::vector<Vec3>& nodes)
{
    geometry::TetMesh volume{.nodes = nodes, .tetrahedra = {}};
    const auto add = [&](auto a, auto b, auto c, auto d) {
        geometry::Tetrahedron t{static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d)};
        const auto at = [&](int corner) {
            return nodes[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])];
        };
        if (geometry::signedVolume(at(0), at(1), at(2), at(3)) < 0) std::swap(t[2], t[3]);
        volume.tetrahedra.push_back(t);
    };
    for (const auto& t : mesh.getTetrahedra()) add(t[0], t[1], t[2], t[3]);
    constexpr int six[6][4] = {{0, 5, 1, 6}, {0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}};
    for (const auto& h : mesh.getHexahedra()) // each as six around a diagonal
        for (const auto& t : six)
            add(h[static_cast<std::size_t>(t[0])], h[static_cast<std::size_t>(t[1])], h[static_cast<std::size_t>(t[2])],
                h[static_cast<std::size_t>(t[3])]);
    return volume;
}

std::vector<Vec3> placesOf(const ::sofa::core::State<Vec3Types>& state, double unit)
{
    std::vector<Vec3> places;
    for (const auto& each : state.read(::sofa::core::vec_id::read_access::position)->getValue())
        places.push_back(unit * fromSofa(each));
    return places;
}

/// Whether a triangle has no height that counts, as surfaces of ours must have: 1e-4 of its longest edge.
bool isFlat(const geometry::Triangle& t, const std::vector<Vec3>& at)
{
    const auto vertex = [&](int corner) { return at[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])]; };
    const Vec3 a = vertex(1) - vertex(0), b = vertex(2) - vertex(0);
    const double longest = std::max({length(a), length(b), length(a - b)});
    return !(length(cross(a, b)) > 1.1e-4 * longest * longest);
}

/// Faces of pictures come as they are. A surface has each face once and no other vertices than those of faces.
geometry::TriangleMesh tidied(const geometry::TriangleMesh& faces, std::vector<int>& vertices)
{
    geometry::TriangleMesh mesh;
    std::set<geometry::Triangle> seen;
    std::vector<int> place(faces.vertices.size(), -1);
    for (geometry::Triangle t : faces.triangles) {
        geometry::Triangle key = t;
        std::ranges::sort(key);
        if (isFlat(t, faces.vertices) || !seen.insert(key).second) continue;
        for (int& corner : t) {
            int& at = place[static_cast<std::size_t>(corner)];
            if (at < 0) {
                at = static_cast<int>(vertices.size());
                vertices.push_back(corner);
            }
            corner = at;
        }
        mesh.triangles.push_back(t);
    }
    for (const int each : vertices) mesh.vertices.push_back(faces.vertices[static_cast<std::size_t>(each)]);
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

/// The triangles and quads of a picture, or of the mesh around a state.
void addFaces(::sofa::core::State<Vec3Types>& state, geometry::TriangleMesh& mesh)
{
    using Triangles = ::sofa::Data<BaseMeshTopology::SeqTriangles>;
    using Quads = ::sofa::Data<BaseMeshTopology::SeqQuads>;
    if (auto* around = isPicture(state) ? nullptr : meshOf(state)) {
        addTriangles(around->getTriangles(), mesh);
        addQuads(around->getQuads(), mesh);
    }
    if (!isPicture(state)) return;
    if (const auto* triangles = dynamic_cast<const Triangles*>(state.findData("triangles")))
        addTriangles(triangles->getValue(), mesh);
    if (const auto* quads = dynamic_cast<const Quads*>(state.findData("quads"))) addQuads(quads->getValue(), mesh);
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
    geometry::TriangleMesh faces{.vertices = placesOf(state, unit), .triangles = {}, .uv = {}};
    geometry::TetMesh volume;
    if (auto* mesh = isPicture(state) ? nullptr : meshOf(state)) volume = volumeOf(*mesh, faces.vertices);
    if (!volume.tetrahedra.empty()) {
        def.mesh = std::make_shared<const geometry::TetMesh>(std::move(volume));
        item.def = def;
        return isBody(def);
    }
    addFaces(state, faces);
    if (faces.triangles.empty()) return false; // points, lines, or what no mesh of ours may be
    def.material = physics::ShellMaterial{};
    auto mesh = std::make_shared<geometry::TriangleMesh>(tidied(faces, item.vertices));
    def.mesh = std::shared_ptr<const geometry::TriangleMesh>(mesh);
    if (!isBody(def)) *mesh = apart(geometry::TriangleMesh(*mesh), item.vertices);
    if (!isBody(def)) return false;
    item.def = def;
    return true;
}

physics::RigidBodyDef rigidDef(const ::sofa::core::State<RigidTypes>& state, double unit)
{
    physics::RigidBodyDef def{.name = nameOf(state), .elements = {}};
    for (const auto& x : state.read(::sofa::core::vec_id::read_access::position)->getValue())
        def.elements.push_back({unit * fromSofa(x.getCenter()), fromSofa(x.getOrientation())});
    return def;
}

} // namespace

Node::SPtr loadGraph(const LoadDef& def)
{
    namespace system = ::sofa::helper::system;
    if (!std::filesystem::exists(def.file)) fail(def.file, ": no such file");
    registerShownModel();
    system::PluginRepository.addFirstPath(def.plugins.empty() ? linkedFolder() : def.plugins);
    for (auto folder = def.folders.rbegin(); folder != def.folders.rend(); ++folder) {
        if (!std::filesystem::is_directory(*folder)) fail(def.file, ": folders: no such folder: ", *folder);
        system::DataRepository.addFirstPath(*folder);
    }
    loadLinkedParts();
    const CollectErrors errors;
    Node::SPtr root;
    try {
        root = ::sofa::simulation::node::load(def.file);
        if (root) ::sofa::simulation::node::initRoot(root.get());
    } catch (const std::exception& problem) {
        if (root) ::sofa::simulation::node::unload(root);
        fail(def.file, ": SOFA cannot load it: ", problem.what());
    }
    try {
        checkMessages(errors.messages(), def.file);
        if (!root)
            fail(def.file, ": SOFA cannot load it: ", errors.messages().empty() ? "" : errors.messages().front());
    } catch (const Error&) {
        if (root) ::sofa::simulation::node::unload(root);
        throw;
    }
    root->execute<::sofa::simulation::UpdateMappingVisitor>(::sofa::core::execparams::defaultInstance());
    return root;
}

std::vector<LoadedItem> itemsOf(Node& root, double unit, std::vector<std::string>& left)
{
    std::vector<::sofa::core::BaseState*> states;
    root.getTreeObjects<::sofa::core::BaseState>(&states);
    std::vector<LoadedItem> items;
    for (::sofa::core::BaseState* each : states) {
        LoadedItem item{.name = nameOf(*each)};
        bool found = false;
        if (auto* soft = dynamic_cast<::sofa::core::State<Vec3Types>*>(each)) {
            item.soft = soft;
            item.picture = isPicture(*each);
            found = makeSoft(*soft, unit, item);
        } else if (auto* rigid = dynamic_cast<::sofa::core::State<RigidTypes>*>(each)) {
            item.rigid = rigid;
            found = rigid->getSize() > 0;
            item.def = rigidDef(*rigid, unit);
        }
        if (found)
            items.push_back(std::move(item));
        else
            left.push_back(item.name);
    }
    return items;
}

GraphState stateOfGraph(Node& root)
{
    std::vector<BaseMechanicalState*> states;
    root.getTreeObjects<BaseMechanicalState>(&states);
    GraphState out;
    for (const BaseMechanicalState* each : states) {
        const ::sofa::Size coords = each->getSize() * each->getCoordDimension();
        const ::sofa::Size derivs = each->getSize() * each->getDerivDimension();
        std::vector<double>& numbers = out.emplace_back(coords + derivs);
        each->copyToBuffer(numbers.data(), ::sofa::core::vec_id::read_access::position, coords);
        each->copyToBuffer(numbers.data() + coords, ::sofa::core::vec_id::read_access::velocity, derivs);
    }
    return out;
}

void setGraphState(const GraphState& state, Node& root)
{
    std::vector<BaseMechanicalState*> states;
    root.getTreeObjects<BaseMechanicalState>(&states);
    for (std::size_t i = 0; i < states.size() && i < state.size(); ++i) {
        const ::sofa::Size coords = states[i]->getSize() * states[i]->getCoordDimension();
        if (coords + states[i]->getSize() * states[i]->getDerivDimension() != state[i].size()) continue;
        states[i]->copyFromBuffer(::sofa::core::vec_id::write_access::position, state[i].data(), coords);
        states[i]->copyFromBuffer(::sofa::core::vec_id::write_access::velocity, state[i].data() + coords,
                                  static_cast<unsigned>(state[i].size()) - coords);
    }
}

bool isUsable(const GraphState& state, double unit)
{
    const auto near = [&](double number) { return unit * std::abs(number) < physics::kFarthest; }; // false for NaN too
    return std::ranges::all_of(state, [&](const auto& numbers) { return std::ranges::all_of(numbers, near); });
}

} // namespace filasofia::sofaengine
