#include "filasofia/core/error.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/scene/import.h"
#include "filasofia/scene/rigid_tree.h"
#include "filasofia/scene/scn_source.h"

#include <algorithm>
#include <cmath>

namespace filasofia::scene {
namespace {

using geometry::TetMesh;
using geometry::TriangleMesh;

const std::vector<std::string_view> kElastic = {"TetrahedronFEMForceField",
                                                "TetrahedralCorotationalFEMForceField",
                                                "FastTetrahedralCorotationalForceField",
                                                "ParallelTetrahedronFEMForceField",
                                                "HexahedronFEMForceField",
                                                "HexahedronFEMForceFieldAndMass",
                                                "HexahedralFEMForceField",
                                                "ParallelHexahedronFEMForceField"};
const std::vector<std::string_view> kHyperelastic = {"TetrahedronHyperelasticityFEMForceField"};
const std::vector<std::string_view> kSprings = {"MeshSpringForceField", "RegularGridSpringForceField"};
const std::vector<std::string_view> kMasses = {"UniformMass", "DiagonalMass", "MeshMatrixMass"};
const std::vector<std::string_view> kImplicit = {"EulerImplicitSolver", "EulerImplicit", "NewmarkImplicitSolver",
                                                 "VariationalSymplecticSolver"};
const std::vector<std::string_view> kExplicit = {"EulerExplicitSolver", "EulerSolver"};
const std::vector<std::string_view> kFixed = {"FixedProjectiveConstraint", "FixedConstraint",
                                              "FixedLagrangianConstraint"};
const std::vector<std::string_view> kCollision = {"TriangleCollisionModel", "LineCollisionModel", "PointCollisionModel",
                                                  "SphereCollisionModel"};
/// What a scene needs in SOFA and not here, or what is read of the node that holds it.
const std::vector<std::string_view> kSilent = {"RequiredPlugin",
                                               "DefaultAnimationLoop",
                                               "DefaultVisualManagerLoop",
                                               "FreeMotionAnimationLoop",
                                               "VisualStyle",
                                               "CollisionPipeline",
                                               "BruteForceBroadPhase",
                                               "BVHNarrowPhase",
                                               "CollisionResponse",
                                               "MinProximityIntersection",
                                               "LocalMinDistance",
                                               "NewProximityIntersection",
                                               "DiscreteIntersection",
                                               "GenericConstraintSolver",
                                               "BlockGaussSeidelConstraintSolver",
                                               "LCPConstraintSolver",
                                               "NNCGConstraintSolver",
                                               "CGLinearSolver",
                                               "PCGLinearSolver",
                                               "SparseLDLSolver",
                                               "EigenSimplicialLDLT",
                                               "AsyncSparseLDLSolver",
                                               "CholeskySolver",
                                               "BTDLinearSolver",
                                               "MatrixLinearSystem",
                                               "BackgroundSetting",
                                               "LightManager",
                                               "VisualGrid",
                                               "OglSceneFrame",
                                               "LineAxis",
                                               "InteractiveCamera",
                                               "ConstraintAttachButtonSetting",
                                               "AttachBodyButtonSetting",
                                               "MechanicalObject",
                                               "BoxROI",
                                               "BoxConstraint"};

bool isRigid(const Attributes& state)
{
    const auto found = state.find("template");
    return found && found->words.starts_with("Rigid");
}

class ScnLoader {
public:
    ScnLoader(const std::filesystem::path& file, const ImportOptions& options)
        : source_(file, options), reader_(source_.reader)
    {
    }

    Imported load()
    {
        readRoot();
        walk(source_.root());
        if (out_.scene.bodies.empty()) reader_.refuse(source_.root(), "has no body that is read");
        if (!isEmpty(around_)) out_.scene.look.around = around_;
        out_.scene.look.direction = {0.5, 0.4, 1.0};
        out_.scene.files = reader_.files();
        out_.notes = reader_.takeNotes();
        return std::move(out_);
    }

private:
    void readRoot()
    {
        const Attributes root(source_.root());
        const Vec3 gravity = reader_.vector(root, "gravity", {0, -9.81, 0}, closed(-1e6, 1e6));
        if (std::abs(gravity.z) > std::abs(gravity.y) && std::abs(gravity.z) > std::abs(gravity.x)) world_ = kFromZUp;
        out_.scene.physics.gravity = rotate(world_.orientation, gravity);
        out_.scene.physics.rate = 1.0 / reader_.number(root, "dt", 0.01, closed(1e-5, 1));
        collides_ = static_cast<bool>(findEverywhere({"CollisionPipeline", "DefaultPipeline"}));
        if (const Element near =
                findEverywhere({"MinProximityIntersection", "LocalMinDistance", "NewProximityIntersection"}))
            proximity_ = 0.5 * reader_.number(Attributes(near), "contactDistance", 2 * proximity_, closed(0, 1e3));
        if (const Element response = findEverywhere({"CollisionResponse", "DefaultContactManager"}))
            readFriction(Attributes(response).find("responseParams"));
        if (const Element solver = findEverywhere({"LCPConstraintSolver"}))
            friction_ = reader_.number(Attributes(solver), "mu", friction_, closed(0, 100));
    }
    /// "mu=0.3&tol=0"
    void readFriction(const std::optional<Attribute>& params)
    {
        if (!params) return;
        const std::size_t at = params->words.find("mu=");
        if (at == std::string_view::npos) return;
        const std::string_view rest = params->words.substr(at + 3);
        friction_ = reader_.numbers({params->at, params->name, rest.substr(0, rest.find_first_of("&;, "))}, 1, 1,
                                    closed(0, 100))[0];
    }
    [[nodiscard]] Element findEverywhere(const std::vector<std::string_view>& tags) const
    {
        const pugi::xml_node found = source_.root().node.find_node([&](const pugi::xml_node& each) {
            return std::ranges::find(tags, std::string_view(each.name())) != tags.end();
        });
        return found ? Element{found, source_.root().file} : Element{};
    }

    void walk(const Element& node)
    {
        const Attributes says(node);
        if (!reader_.flag(says, "activated", true))
            return reader_.note(node, "activated", "a <Node> that is not activated is left out");
        const Element state = source_.component(node, {"MechanicalObject"});
        if (isMapped(node)) {
            // It is read with the body that it follows.
        } else if (state) {
            isRigid(Attributes(state)) ? addRigid(node, state) : addSoft(node, state);
        } else if (source_.component(node, {"OglModel"})) {
            addPicture(node);
        }
        tellRest(node);
        for (const Element& each : source_.nodesIn(node)) walk(each);
    }
    /// Whether the node's points follow those of a node around it.
    [[nodiscard]] bool isMapped(const Element& node) const
    {
        for (const Element& each : source_.componentsIn(node))
            if (each.tag().ends_with("Mapping") && !each.tag().ends_with("TopologicalMapping")) return true;
        return false;
    }
    void tellRest(const Element& node)
    {
        const auto isOf = [](const std::vector<std::string_view>& tags, std::string_view tag) {
            return std::ranges::find(tags, tag) != tags.end();
        };
        for (const Element& each : source_.componentsIn(node)) {
            const std::string_view tag = each.tag();
            const bool read = isOf(kSilent, tag) || isOf(kElastic, tag) || isOf(kHyperelastic, tag) ||
                              isOf(kSprings, tag) || isOf(kMasses, tag) || isOf(kImplicit, tag) ||
                              isOf(kExplicit, tag) || isOf(kFixed, tag) || isOf(kCollision, tag) ||
                              tag.ends_with("Loader") || tag.ends_with("Topology") ||
                              tag.ends_with("TopologyContainer") || tag.ends_with("TopologyModifier") ||
                              tag.ends_with("GeometryAlgorithms") || tag.ends_with("Mapping") ||
                              tag.ends_with("ConstraintCorrection") || tag == "OglModel" ||
                              tag == "RestShapeSpringsForceField" || tag == "ConstantForceField";
            if (!read) reader_.tellUnread(each);
        }
    }

    [[nodiscard]] std::string nameOf(const Element& node)
    {
        const std::string name = reader_.word(Attributes(node), "name");
        return names_.take(name.empty() ? "body" : name);
    }
    void add(physics::BodyDef def, std::vector<runtime::ShowDef> show, const Element& place)
    {
        SceneBody body{.def = std::move(def), .show = std::move(show)};
        body.places.emplace("", place.place());
        out_.scene.bodies.push_back(std::move(body));
        out_.joints.emplace_back();
    }
    template <class Points> void grow(const Points& points, const Pose& pose)
    {
        for (const Vec3& each : points) around_ = merged(around_, transform(pose, each));
    }

    void addSoft(const Element& node, const Element& state)
    {
        const Element elastic = source_.component(node, kElastic), hyper = source_.component(node, kHyperelastic),
                      springs = source_.component(node, kSprings);
        const Element law = elastic ? elastic : hyper ? hyper : springs;
        if (!law) {
            if (source_.component(node, kMasses))
                reader_.tell(node, "no elasticity",
                             text("<Node> '", Attributes(node).find("name") ? Attributes(node).find("name")->words : "",
                                  "' has a mass and no elasticity that is read"));
            else
                addObstacle(node, state);
            return;
        }
        const ScnMesh mesh = source_.meshIn(node, false);
        const auto* solid = std::get_if<std::shared_ptr<const TetMesh>>(&mesh);
        if (!solid) {
            reader_.tell(node, "no tetrahedra",
                         "a <Node> with elasticity has no tetrahedra or hexahedra that are read");
            return;
        }
        const ScnSource::Placing placing = source_.placingOf(state);
        TetMesh moved = **solid;
        for (Vec3& each : moved.nodes) each = placing(each);
        physics::SoftBodyDef def{.name = nameOf(node), .pose = world_};
        readMaterial(law, elastic, hyper, def);
        readMass(node, moved, def);
        readSolver(node, def);
        pin(node, moved, def);
        readForces(node, moved, def);
        std::vector<runtime::ShowDef> show;
        if (collides_ && source_.component(node, kCollision)) collide(node, nullptr, def.collision);
        // What follows a grid is in the grid's coordinates, and what follows a mesh in those of the state.
        const bool grid = static_cast<bool>(source_.component(node, {"RegularGridTopology"}));
        follow(node, grid ? placing : ScnSource::Placing{}, def.collision, show);
        if (show.empty()) show.emplace_back();
        def.friction = friction_;
        grow(moved.nodes, world_);
        def.mesh = std::make_shared<const TetMesh>(std::move(moved));
        add(std::move(def), std::move(show), node);
    }

    void readMaterial(const Element& law, const Element& elastic, const Element& hyper, physics::SoftBodyDef& def)
    {
        const Attributes says(law);
        if (elastic) {
            physics::FemMaterial material;
            material.law = physics::Corotational{};
            material.youngModulus = firstOf(says, "youngModulus", 5000.0, closed(1e-9, 1e15));
            material.poissonRatio = std::min(firstOf(says, "poissonRatio", 0.45, closedOpen(0, 0.5)), 0.4999);
            if (reader_.word(says, "method") == "small")
                reader_.note(law, "small", "method \"small\" is read as corotational elasticity");
            def.material = material;
        } else if (hyper) {
            const auto parameters = says.find("ParameterSet");
            const std::string name = reader_.word(says, "materialName");
            const bool venant = name == "StVenantKirchhoff", stable = name == "StableNeoHookean";
            if (!parameters || (!venant && !stable && name != "NeoHookean"))
                reader_.refuse(
                    law,
                    "must have the material StVenantKirchhoff, NeoHookean or StableNeoHookean, and its ParameterSet");
            const std::vector<double> values = reader_.numbers(*parameters, 2, 2, positive());
            const double mu = values[0], lambda = name == "NeoHookean" ? values[1] - 2.0 / 3.0 * mu : values[1];
            physics::FemMaterial material;
            if (venant)
                material.law = physics::StVenantKirchhoff{};
            else
                material.law = physics::NeoHookean{};
            material.youngModulus = mu * (3 * lambda + 2 * mu) / (lambda + mu);
            material.poissonRatio = std::clamp(lambda / (2 * (lambda + mu)), 0.0, 0.4999);
            def.material = material;
        } else {
            def.material = physics::MassSpringMaterial{
                .stiffness = firstOf(says, says.has("stiffness") ? "stiffness" : "linesStiffness", 100.0, positive()),
                .damping = firstOf(says, says.has("damping") ? "damping" : "linesDamping", 0.0, nonNegative())};
        }
    }
    /// A number, or the first of a list of one per element.
    [[nodiscard]] double firstOf(const Attributes& from, std::string_view name, double standard, const Range& range)
    {
        const auto found = from.find(name);
        if (!found || found->words.starts_with('@')) return standard;
        const std::vector<double> all = reader_.numbers(*found, 1, 10'000'000, range);
        if (std::ranges::any_of(all, [&](double each) { return each != all.front(); }))
            reader_.tell(found->at, text("list ", name), text("of the list ", name, " only the first number is read"));
        return all.front();
    }

    void readMass(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
    {
        const Element mass = source_.inherited(node, kMasses);
        if (!mass) return reader_.note(node, "no mass", "a body without a mass gets 1000 kg/m^3");
        const Attributes says(mass);
        if (says.has("massDensity"))
            def.mass = physics::Density{firstOf(says, "massDensity", 1.0, positive())};
        else if (says.has("totalMass"))
            def.mass = physics::TotalMass{firstOf(says, "totalMass", 1.0, positive())};
        else
            def.mass =
                physics::TotalMass{firstOf(says, says.has("vertexMass") ? "vertexMass" : "mass", 1.0, positive()) *
                                   static_cast<double>(mesh.nodes.size())};
    }

    void readSolver(const Element& node, physics::SoftBodyDef& def)
    {
        if (const Element implicit = source_.inherited(node, kImplicit)) {
            const Attributes says(implicit);
            def.rayleigh = {.mass = reader_.number(says, "rayleighMass", 0.0, nonNegative()),
                            .stiffness = reader_.number(says, "rayleighStiffness", 0.0, nonNegative())};
        } else if (source_.inherited(node, kExplicit)) {
            def.integrator = physics::ExplicitEuler{};
        } else {
            reader_.note(node, "no solver", "a body without a solver that is read is solved implicitly");
        }
    }

    /// The nodes that the indices of a component name; nothing if they are those of boxes, which go to `boxes`.
    [[nodiscard]] std::vector<int> indicesOf(const Attributes& says, std::initializer_list<std::string_view> names,
                                             std::size_t nodes, std::vector<geometry::Box>& boxes)
    {
        const auto found = says.findAny(names);
        if (!found) return {0};
        if (!found->words.starts_with('@')) {
            std::vector<int> all = reader_.wholes(*found, nonNegative());
            for (const int each : all)
                if (each >= static_cast<int>(nodes)) reader_.refuse(*found, text("must be in [0, ", nodes, ")"));
            return all;
        }
        const Element from = source_.linked(*found);
        if (from && (from.tag() == "BoxROI" || from.tag() == "BoxConstraint")) {
            addBoxes(from, boxes);
            return {};
        }
        reader_.tell(says.element(), text("indices ", says.element().tag()),
                     text("<", says.element().tag(), "> is read with indices that are numbers or those of a BoxROI"));
        return {};
    }
    void addBoxes(const Element& roi, std::vector<geometry::Box>& boxes)
    {
        const auto box = Attributes(roi).find("box");
        if (!box) return reader_.tell(roi, "BoxROI", "<BoxROI> without a box is not read");
        const std::vector<double> v = reader_.numbers(*box, 6, 6000);
        for (std::size_t i = 0; i + 6 <= v.size(); i += 6) {
            geometry::Box made;
            for (const Vec3 corner : {Vec3{v[i], v[i + 1], v[i + 2]}, Vec3{v[i + 3], v[i + 4], v[i + 5]}})
                made = merged(made, transform(world_, corner));
            boxes.push_back(made);
        }
    }
    void attach(const Attributes& says, std::initializer_list<std::string_view> names, std::size_t nodes,
                double stiffness, physics::SoftBodyDef& def)
    {
        std::vector<geometry::Box> boxes;
        const std::vector<int> indices = indicesOf(says, names, nodes, boxes);
        if (!indices.empty()) def.attachments.push_back({.nodes = indices, .stiffness = stiffness});
        for (const geometry::Box& each : boxes) def.attachments.push_back({.box = each, .stiffness = stiffness});
    }
    void pin(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
    {
        for (const Element& each : source_.componentsIn(node)) {
            const Attributes says(each);
            if (std::ranges::find(kFixed, each.tag()) != kFixed.end()) {
                if (reader_.flag(says, "fixAll", false)) {
                    physics::AttachmentDef all;
                    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) all.nodes.push_back(static_cast<int>(i));
                    def.attachments.push_back(all);
                } else {
                    attach(says, {"indices"}, mesh.nodes.size(), physics::kHard, def);
                }
            } else if (each.tag() == "RestShapeSpringsForceField") {
                if (says.has("external_rest_shape"))
                    reader_.tell(each, "external", "<RestShapeSpringsForceField> to another state is not read");
                else
                    attach(says, {"points", "indices"}, mesh.nodes.size(),
                           firstOf(says, "stiffness", 100.0, positive()), def);
            }
        }
    }

    void readForces(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
    {
        for (const Element& each : source_.componentsIn(node)) {
            if (each.tag() != "ConstantForceField") continue;
            const Attributes says(each);
            std::vector<geometry::Box> boxes;
            std::vector<int> nodes =
                says.has("indices") ? indicesOf(says, {"indices"}, mesh.nodes.size(), boxes) : std::vector<int>();
            for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
                if (std::ranges::any_of(
                        boxes,
                        [&](const geometry::Box& box) { return contains(box, transform(world_, mesh.nodes[i])); }) ||
                    !says.has("indices"))
                    nodes.push_back(static_cast<int>(i));
            if (nodes.empty()) continue;
            const bool total = says.has("totalForce");
            const auto given = says.findAny({"totalForce", "force", "forces"});
            if (!given || given->words.starts_with('@')) {
                reader_.tell(each, "ConstantForceField",
                             "<ConstantForceField> is read with totalForce, force or forces");
                continue;
            }
            const std::vector<double> v = reader_.numbers(*given, 3, 3'000'000);
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const std::size_t k = total || given->name == "force" ? 0 : std::min(3 * i, 3 * (v.size() / 3 - 1));
                const Vec3 force =
                    1.0 / (total ? static_cast<double>(nodes.size()) : 1.0) * Vec3{v[k], v[k + 1], v[k + 2]};
                def.forces.push_back({nodes[i], rotate(world_.orientation, force)});
            }
        }
    }

    /// Adds a collision model of a node; `mesh`: null for the body's own surface.
    void collide(const Element& node, std::shared_ptr<const TriangleMesh> mesh, std::vector<physics::CollisionDef>& to)
    {
        physics::CollisionDef def{.proximity = proximity_};
        if (mesh) def.mesh = std::move(mesh);
        for (const Element& each : source_.componentsIn(node))
            if (std::ranges::find(kCollision, each.tag()) != kCollision.end())
                def.self = def.self || reader_.flag(Attributes(each), "selfCollision", false);
        to.push_back(std::move(def));
    }
    /// What follows a body: the nodes in its node that are mapped, with collision models and pictures.
    void follow(const Element& node, const ScnSource::Placing& outer, std::vector<physics::CollisionDef>& collision,
                std::vector<runtime::ShowDef>& show)
    {
        if (const Element picture = source_.component(node, {"OglModel"})) addShow(picture, outer, show);
        for (const Element& each : source_.nodesIn(node)) {
            const Element state = source_.component(each, {"MechanicalObject"});
            if (state && !isMapped(each)) continue; // a body of its own
            if (collides_ && source_.component(each, kCollision)) {
                const auto surface = surfaceOf(source_.meshIn(each, true), {state, outer});
                if (source_.component(each, {"SphereCollisionModel"}) && !surface)
                    reader_.note(each, "spheres", "spheres that collide are read as the body's own surface");
                collide(each, surface, collision);
            }
            follow(each, outer, collision, show);
        }
    }
    /// How a surface lies: by a component that places it, in the coordinates of another.
    struct Lying {
        Element by = {};
        ScnSource::Placing in = {};
    };
    [[nodiscard]] std::shared_ptr<const TriangleMesh> surfaceOf(const ScnMesh& mesh, const Lying& lying) const
    {
        const auto* surface = std::get_if<std::shared_ptr<const TriangleMesh>>(&mesh);
        if (!surface || !*surface) return {};
        const ScnSource::Placing own = lying.by ? source_.placingOf(lying.by) : ScnSource::Placing{};
        TriangleMesh moved = **surface;
        for (Vec3& each : moved.vertices) each = lying.in(own(each));
        return std::make_shared<const TriangleMesh>(std::move(moved));
    }
    void addShow(const Element& picture, const ScnSource::Placing& outer, std::vector<runtime::ShowDef>& show)
    {
        runtime::ShowDef def;
        const Attributes says(picture);
        const char* file = says.has("filename") ? "filename" : "fileMesh";
        const ScnMesh mesh = says.has(file) ? source_.surfaceFile(picture, file) : source_.meshOf(picture, true);
        if (const auto surface = surfaceOf(mesh, {picture, outer})) def.surface = surface;
        if (const auto colour = says.find("color");
            colour && !colour->words.empty() &&
            (std::isdigit(static_cast<unsigned char>(colour->words[0])) || colour->words[0] == '.')) {
            const std::vector<double> rgb = reader_.numbers(*colour, 3, 4, closed(0, 1));
            def.material = plainMaterial({rgb[0], rgb[1], rgb[2]});
        }
        show.push_back(std::move(def));
    }

    /// Triangles that nothing moves.
    void addObstacle(const Element& node, const Element& state)
    {
        const auto surface = surfaceOf(source_.meshIn(node, true), {state});
        const bool touches = collides_ && source_.component(node, kCollision);
        if (!surface || (!touches && !source_.component(node, {"OglModel"}))) return;
        grow(surface->vertices, world_);
        physics::RigidBodyDef def{.name = nameOf(node)};
        def.elements = {world_};
        def.mesh = surface;
        if (touches) collide(node, nullptr, def.collision);
        def.friction = friction_;
        add(std::move(def), {runtime::ShowDef{}}, node);
    }
    void addPicture(const Element& node)
    {
        std::vector<runtime::ShowDef> show;
        addShow(source_.component(node, {"OglModel"}), {}, show);
        const auto* surface = std::get_if<std::shared_ptr<const TriangleMesh>>(&show.front().surface);
        if (!surface || !*surface) return;
        grow((*surface)->vertices, world_);
        physics::RigidBodyDef def{.name = nameOf(node)};
        def.elements = {world_};
        def.mesh = *surface;
        show.front().surface = {};
        add(std::move(def), std::move(show), node);
    }

    void addRigid(const Element& node, const Element& state)
    {
        const Attributes says(state);
        physics::RigidBodyDef def{.name = nameOf(node)};
        const Pose moved = source_.placingOf(state).pose;
        def.elements = {world_ * moved};
        if (const auto at = says.find("position"); at && !at->words.starts_with('@')) {
            const std::vector<double> v = reader_.numbers(*at, 7, 70'000);
            def.elements.clear();
            for (std::size_t i = 0; i + 7 <= v.size(); i += 7)
                def.elements.push_back(
                    world_ * moved *
                    Pose{{v[i], v[i + 1], v[i + 2]}, normalized(Quat{v[i + 6], v[i + 3], v[i + 4], v[i + 5]})});
        }
        const Element mass = source_.component(node, kMasses);
        const Element fixed = source_.component(node, kFixed);
        def.dynamic = mass && !fixed && (source_.inherited(node, kImplicit) || source_.inherited(node, kExplicit));
        std::vector<runtime::ShowDef> show;
        if (collides_ && source_.component(node, kCollision))
            reader_.tell(node, "rigid points", "points of a rigid state that collide are not read");
        follow(node, {}, def.collision, show);
        shape(def, show);
        if (def.dynamic) giveMass(mass, def);
        for (const Pose& each : def.elements) around_ = merged(around_, each.position);
        def.friction = friction_;
        add(std::move(def), std::move(show), node);
    }
    /// The surface of a rigid body is that which collides, or else that which is drawn.
    static void shape(physics::RigidBodyDef& def, std::vector<runtime::ShowDef>& show)
    {
        using Surface = std::shared_ptr<const TriangleMesh>;
        for (physics::CollisionDef& each : def.collision)
            if (const auto* mesh = std::get_if<Surface>(&each.mesh);
                mesh && *mesh && def.mesh == physics::TriangleMeshSource()) {
                def.mesh = *mesh;
                each.mesh = {};
            }
        for (runtime::ShowDef& each : show)
            if (const auto* mesh = std::get_if<Surface>(&each.surface);
                mesh && *mesh && def.mesh == physics::TriangleMeshSource())
                def.mesh = *mesh;
        std::erase_if(def.collision, [&](const physics::CollisionDef& each) {
            return each.mesh == physics::TriangleMeshSource() && def.mesh == physics::TriangleMeshSource();
        });
        std::erase_if(show, [&](const runtime::ShowDef& each) {
            return each.surface == runtime::SurfaceSource() && def.mesh == physics::TriangleMeshSource();
        });
    }
    void giveMass(const Element& mass, physics::RigidBodyDef& def)
    {
        const Attributes says(mass);
        double total = 1.0;
        if (const auto given = says.findAny({"totalMass", "vertexMass"}); given && !given->words.starts_with('@'))
            total = reader_.numbers(*given, 1, 100).front();
        if (says.has("totalMass")) total /= static_cast<double>(def.elements.size());
        if (!(total > 0.0)) reader_.refuse(mass, "must be > 0");
        const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&def.mesh);
        geometry::Box box;
        if (mesh && *mesh)
            for (const Vec3& each : (*mesh)->vertices) box = merged(box, each);
        const Vec3 size = isEmpty(box) ? Vec3{1, 1, 1} : box.high - box.low;
        const auto moment = [&](double a, double b) { return std::max(total / 12.0 * (a * a + b * b), 1e-9 * total); };
        reader_.note(mass, "inertia", "a rigid body's inertia is that of the box around it");
        def.mass =
            physics::GivenInertia{.mass = total,
                                  .centre = isEmpty(box) ? Vec3{} : 0.5 * (box.low + box.high),
                                  .moments = {moment(size.y, size.z), moment(size.z, size.x), moment(size.x, size.y)}};
    }

    ScnSource source_;
    XmlReader& reader_;
    Imported out_;
    Names names_;
    Pose world_; ///< from the scene's axes to ours, which have y up
    geometry::Box around_;
    bool collides_ = false;
    double proximity_ = 0.5e-3; ///< [m]
    double friction_ = 0.0;     ///< [-]
};

} // namespace

Imported loadScn(const std::filesystem::path& file, const ImportOptions& options)
{
    return ScnLoader(file, options).load();
}

} // namespace filasofia::scene
