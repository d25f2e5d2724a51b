#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/scene/import.h"
#include "filasofia/scene/rigid_tree.h"
#include "filasofia/scene/scn_attributes.h"
#include "filasofia/scene/scn_tissue.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace filasofia::scene {
namespace {

using geometry::TetMesh;
using geometry::TriangleMesh;

constexpr const char* kInMillimetres = ": the scene seems to be in millimetres, and lengths are read as metres; for "
                                       "organs of their own size, give the unit "
                                       "0.001 (--unit 0.001, in Python unit=0.001)";

class ScnLoader {
public:
    ScnLoader(const std::filesystem::path& file, const ImportOptions& options)
        : source_(file, options), reader_(source_.reader), tissue_(source_, options.unit), unit_(options.unit)
    {
        if (!positive().contains(unit_))
            fail(file.string(), ": unit ", positive().refusal("m", unit_), ", got ", unit_);
    }

    Imported load()
    {
        readRoot();
        walk(source_.root());
        if (out_.scene.bodies.empty()) reader_.refuse(source_.root(), "has no body that is read" + whatWasNot());
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
        const Vec3 gravity = unit_ * reader_.vector(root, "gravity", {0, -9.81, 0}, closed(-1e6 / unit_, 1e6 / unit_));
        if (std::abs(gravity.z) > std::abs(gravity.y) && std::abs(gravity.z) > std::abs(gravity.x)) world_ = kFromZUp;
        out_.scene.physics.gravity = rotate(world_.orientation, gravity);
        constexpr double kHeavy = 1000.0; // [m/s^2]; 9810 is usual
        millimetres_ = length(gravity) > kHeavy;
        if (millimetres_)
            reader_.note(source_.root(), "millimetres", text("gravity is ", length(gravity), kInMillimetres));
        out_.scene.physics.rate = 1.0 / reader_.number(root, "dt", 0.01, closed(1e-5, 1));
        collides_ = static_cast<bool>(findEverywhere({"CollisionPipeline", "DefaultPipeline"}));
        if (const Element near =
                findEverywhere({"MinProximityIntersection", "LocalMinDistance", "NewProximityIntersection"}))
            proximity_ =
                0.5 * unit_ *
                reader_.number(Attributes(near), "contactDistance", 2 * proximity_ / unit_, closed(0, 1e3 / unit_));
        tissue_.turn(world_);
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
        const pugi::xml_node found =
            source_.root().node.find_node([&](const pugi::xml_node& each) { return isOneOf(each.name(), tags); });
        return found ? Element{found, source_.root().file} : Element{};
    }

    /// The first notes, one of which is why there is no body.
    [[nodiscard]] std::string whatWasNot() const
    {
        constexpr std::size_t few = 5;
        std::string all;
        for (std::size_t i = 0; i < std::min(few, reader_.notes().size()); ++i)
            all += text(i == 0 ? ": " : "; ", reader_.notes()[i]);
        return reader_.notes().size() > few ? all + "; ..." : all;
    }

    void walk(const Element& node)
    {
        const Attributes says(node);
        if (!reader_.flag(says, "activated", true))
            return reader_.note(node, "activated", "a <Node> that is not activated is left out");
        const Element state = source_.component(node, {"MechanicalObject"});
        if (isMapped(node)) {
            tellUnused(node, "that is mapped"); // the rest is read with the body that it follows
        } else if (state) {
            addBody(node, state);
        } else {
            tellUnused(node, "without a <MechanicalObject>");
            if (source_.component(node, {"OglModel"})) addPicture(node);
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
        tellUnreadAttributes(node, reader_);
        for (const Element& each : source_.componentsIn(node)) tellUnreadOf(each, reader_);
    }
    /// Tells what deforms, holds or loads tissue, in a node that has none.
    void tellUnused(const Element& node, std::string_view where)
    {
        const bool rigid = isRigid(source_.component(node, {"MechanicalObject"}));
        for (const Element& each : source_.componentsIn(node))
            if (ScnTissue::actsOnTissue(each.tag()) || (!rigid && isOneOf(each.tag(), kFixed)))
                reader_.tell(each, text("<", each.tag(), where),
                             text("<", each.tag(), "> is not read in a <Node> ", where));
    }
    [[nodiscard]] static bool isRigid(const Element& state)
    {
        const auto kind = Attributes(state).find("template");
        return kind && kind->words.starts_with("Rigid");
    }

    [[nodiscard]] std::string nameOf(const Element& node)
    {
        const std::string name = reader_.word(Attributes(node), "name");
        return names_.take(name.empty() ? "body" : name);
    }
    [[nodiscard]] std::string called(const Element& node) const
    {
        return text("<Node> '", shortened(reader_.word(Attributes(node), "name")), "'");
    }
    void add(physics::BodyDef def, std::vector<runtime::ShowDef> show, const Element& place)
    {
        try {
            physics::check(def);
        } catch (const Error& problem) {
            fail(place.place(), ": ", problem.what(), millimetres_ ? kInMillimetres : "");
        }
        SceneBody body{.def = std::move(def), .show = std::move(show)};
        body.places.emplace("", place.place());
        out_.scene.bodies.push_back(std::move(body));
        out_.joints.emplace_back();
    }
    template <class Points> void grow(const Points& points, const Pose& pose)
    {
        for (const Vec3& each : points) around_ = merged(around_, transform(pose, each));
    }

    void addBody(const Element& node, const Element& state)
    {
        const auto kind = Attributes(state).find("template");
        const auto is = [&](const char* name) { return kind && kind->words.starts_with(name); };
        if (is("Rigid2") || is("Vec1") || is("Vec2") || is("Vec6"))
            reader_.tell(state, "template", text("a state of ", kind->words, " is not read"));
        else if (is("Rigid"))
            addRigid(node, state);
        else
            addSoft(node, state);
    }

    void addSoft(const Element& node, const Element& state)
    {
        if (!tissue_.lawOf(node)) {
            if (source_.component(node, kMasses))
                reader_.tell(node, "no elasticity", text(called(node), " has a mass and no elasticity that is read"));
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
        tissue_.read(node, moved, def);
        for (Vec3& each : moved.nodes) each = unit_ * each;
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

    /// Adds a collision model of a node; `mesh`: null for the body's own surface.
    void collide(const Element& node, std::shared_ptr<const TriangleMesh> mesh, std::vector<physics::CollisionDef>& to)
    {
        physics::CollisionDef def{.proximity = proximity_};
        if (mesh) def.mesh = std::move(mesh);
        for (const Element& each : source_.componentsIn(node))
            if (isOneOf(each.tag(), kCollision)) {
                def.self = def.self || reader_.flag(Attributes(each), "selfCollision", false);
                tellGroup(each);
            }
        to.push_back(std::move(def));
    }
    /// In SOFA collision models of a common group do not touch; those of one body do not here, either.
    void tellGroup(const Element& model)
    {
        const std::size_t body = out_.scene.bodies.size(); // the one that is being made
        forEachWord(reader_.word(Attributes(model), "group"), [&](std::string_view group) {
            const auto [first, fresh] = bodyOfGroup_.try_emplace(std::string(group), body);
            if (!fresh && first->second != body)
                reader_.tell(model, "group", text("<", model.tag(), "> group is not read: bodies of a group touch"));
        });
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
        for (Vec3& each : moved.vertices) each = unit_ * lying.in(own(each));
        return std::make_shared<const TriangleMesh>(std::move(moved));
    }
    void addShow(const Element& picture, const ScnSource::Placing& outer, std::vector<runtime::ShowDef>& show)
    {
        runtime::ShowDef def;
        const Attributes says(picture);
        const char* file = says.has("filename") ? "filename" : "fileMesh";
        const ScnMesh mesh = says.has(file) ? source_.surfaceFile(picture, file) : source_.meshOf(picture, true);
        if (const auto surface = surfaceOf(mesh, {picture, outer})) def.surface = surface;
        if (const auto colour = says.find("color"); colour && !colour->words.empty())
            if (const auto rgb = colourOf(*colour)) def.material = plainMaterial(*rgb);
        show.push_back(std::move(def));
    }
    std::optional<Vec3> colourOf(const Attribute& colour)
    {
        if (std::isdigit(static_cast<unsigned char>(colour.words[0])) || colour.words[0] == '.') {
            const std::vector<double> rgb = reader_.numbers(colour, 3, 4, closed(0, 1));
            return Vec3{rgb[0], rgb[1], rgb[2]};
        }
        const auto named = colourNamed(colour.words);
        if (!named)
            reader_.tell(colour.at, text("color ", colour.words),
                         text("<OglModel> color is not read: '", shortened(colour.words),
                              "' is none of SOFA's words, numbers or #rrggbb"));
        return named;
    }

    /// Triangles that nothing moves.
    void addObstacle(const Element& node, const Element& state)
    {
        const auto surface = surfaceOf(source_.meshIn(node, true), {state});
        const bool touches = collides_ && source_.component(node, kCollision);
        if (!surface && touches)
            return reader_.tell(node, "no triangles",
                                text(called(node), " collides, and has no triangles that are read"));
        if (!surface || (!touches && !source_.component(node, {"OglModel"})))
            return reader_.note(node, "left out",
                                text(called(node), " is left out: it has no elasticity that is read, "
                                                   "and no surface that collides or is seen"));
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
        Pose moved = source_.placingOf(state).pose;
        moved.position = unit_ * moved.position;
        def.elements = {world_ * moved};
        if (const auto at = says.find("position"); at && !at->words.starts_with('@')) {
            const std::vector<double> v = reader_.numbers(*at, 7, 70'000);
            def.elements.clear();
            for (std::size_t i = 0; i + 7 <= v.size(); i += 7)
                def.elements.push_back(world_ * moved *
                                       Pose{unit_ * Vec3{v[i], v[i + 1], v[i + 2]},
                                            normalized(Quat{v[i + 6], v[i + 3], v[i + 4], v[i + 5]})});
        }
        const Element mass = source_.component(node, kMasses);
        const Element fixed = source_.component(node, kFixed);
        tellUnused(node, "of a rigid body");
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
        if (const auto given = says.find(says.has("totalMass") ? "totalMass" : "vertexMass");
            given && !given->words.starts_with('@'))
            total =
                reader_.numbers({given->at, given->name, given->words.substr(0, given->words.find(' '))}, 1, 1).front();
        if (says.has("totalMass")) total /= static_cast<double>(def.elements.size());
        if (!(total > 0.0)) reader_.refuse(mass, "must be > 0");
        geometry::Box box;
        for (const physics::CollisionDef& each : def.collision) {
            const auto& source = each.mesh == physics::TriangleMeshSource() ? def.mesh : each.mesh;
            box = merged(box, geometry::boxAround(std::get<std::shared_ptr<const TriangleMesh>>(source)->vertices));
        }
        const double standard = total * unit_ * unit_;
        physics::GivenInertia inertia{.mass = total, .moments = {standard, standard, standard}};
        if (!isEmpty(box)) { // about the frame, which is the centre of mass in SOFA, wherever the mesh is
            const auto mean = [](double low, double high) { return (low * low + low * high + high * high) / 3.0; };
            const double x = mean(box.low.x, box.high.x), y = mean(box.low.y, box.high.y),
                         z = mean(box.low.z, box.high.z);
            const auto moment = [&](double squares) { return total * std::max(squares, 1e-9 * unit_ * unit_); };
            inertia.moments = {moment(y + z), moment(z + x), moment(x + y)};
            reader_.note(mass, "inertia", "a rigid body's inertia is that of the box around its collision models");
        } else {
            reader_.note(mass, "inertia without a mesh",
                         "a rigid body without a collision model has the inertia of SOFA's default: its mass times a "
                         "unit squared");
        }
        def.mass = inertia;
    }

    ScnSource source_;
    XmlReader& reader_;
    ScnTissue tissue_;
    Imported out_;
    Names names_;
    Pose world_; ///< from the scene's axes to ours, which have y up
    geometry::Box around_;
    std::map<std::string, std::size_t> bodyOfGroup_; ///< the first body of a group of collision models
    bool collides_ = false;
    double unit_;               ///< [m] that the scene calls a unit
    bool millimetres_ = false;  ///< as gravity says, and no unit
    double proximity_ = 0.5e-3; ///< [m]
    double friction_ = 0.0;     ///< [-]
};

} // namespace

Imported loadScn(const std::filesystem::path& file, const ImportOptions& options)
{
    return ScnLoader(file, options).load();
}

} // namespace filasofia::scene
